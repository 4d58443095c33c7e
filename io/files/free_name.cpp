#include "io/files/free_name.h"

#include <algorithm>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace lucarne {

std::filesystem::path free_name(const std::filesystem::path& folder, std::string_view stem,
                                std::initializer_list<std::string_view> extensions) {
    constexpr int kMostNames = 10000;
    for (int number = 1; number < kMostNames; ++number) {
        auto name = folder / fmt::format("{}-{:04}", stem, number);
        const bool taken = std::ranges::any_of(extensions, [&](const auto extension) {
            std::error_code ignored;
            return std::filesystem::exists(name.string() + std::string(extension), ignored);
        });
        if (!taken) return name;
    }
    return folder / std::string(stem);
}

}  // namespace lucarne
