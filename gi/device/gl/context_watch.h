#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucarne::gi {

/// Watches whether the current OpenGL context still works. When a driver is reset, updated or removed, all
/// contexts and everything made in them are lost (ARB_robustness) and have to be made again.
class ContextWatch {
 public:
    /// Asks the driver. Once it has returned true it keeps returning true.
    bool lost();
    /// lost() returns true from now on, for this reason. The first reason stays.
    void report_loss(std::string reason);
    /// Why the context was lost, as far as the driver tells; empty while it works.
    const std::string& reason() const { return reason_; }
    /// For tests: lost() returns true from its `checks`th call on, whatever the driver says.
    void lose_after(uint32_t checks) { checks_left_ = checks; }

 private:
    std::optional<uint32_t> checks_left_;
    std::string reason_;
};

/// For tests of the whole program: after how many checks the first, the second, ... context is lost.
/// Contexts beyond the end of the list are never lost. Not thread-safe.
class LossPlan {
 public:
    /// "30,5": numbers separated by commas. The list ends at the first text that is not a number.
    explicit LossPlan(std::string_view numbers);
    /// Reads the plan from an environment variable: LUCARNE_TEST_LOSE_CONTEXT or LUCARNE_TEST_LOSE_WINDOW
    /// (gi/device/gl/README.md).
    static LossPlan from_environment(const char* variable);
    /// Returns the number of checks for the next context that is made; none if it shall not be lost.
    std::optional<uint32_t> next();

 private:
    std::vector<uint32_t> checks_;
    size_t made_ = 0;
};

}  // namespace lucarne::gi
