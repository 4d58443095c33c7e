#include "gi/device/common/memory_budget.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace lucarne::gi {

bool MemoryBudget::take_refusal() {
    return std::exchange(refused_, false);
}

Result<void> MemoryBudget::take(uint64_t bytes, std::string_view what) {
    const bool fits = bytes <= cap_ - std::min(cap_, used_);
    refused_ |= !fits;
    if (!fits)
        return failed(std::string(what),
                      fmt::format("{} MiB in addition to the {} MiB in use exceed the cap of {} MiB",
                                  bytes >> 20, used_ >> 20, cap_ >> 20),
                      "lower the number of points or the picture's size");
    used_ += bytes;
    return {};
}

}  // namespace lucarne::gi
