#pragma once

#include <cstdint>
#include <string_view>

#include "io/core/error.h"

namespace lucarne::gi {

/// Counts the memory of all buffers, of OpenGL and OpenCL together, against one cap.
class MemoryBudget {
 public:
    void set_cap(uint64_t bytes) { cap_ = bytes; }
    uint64_t cap() const { return cap_; }
    uint64_t used() const { return used_; }
    /// Returns whether take() has refused anything since the last call.
    bool take_refusal();

    /// Counts `bytes` for a buffer; `what` names it in errors. Errors: over the cap.
    Result<void> take(uint64_t bytes, std::string_view what);
    void give_back(uint64_t bytes) { used_ -= bytes; }

 private:
    uint64_t cap_ = UINT64_MAX, used_ = 0;
    bool refused_ = false;
};

}  // namespace lucarne::gi
