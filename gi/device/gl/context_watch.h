#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucarne::gi {

/// Whether the OpenGL context that is current still works: a driver that was reset, updated or taken away
/// loses all contexts and what was made in them (ARB_robustness), and they have to be made again.
class ContextWatch {
 public:
    /// Asks the driver; once true it stays so.
    bool lost();
    /// Why, as far as the driver tells; empty while it works.
    const std::string& reason() const { return reason_; }
    /// For tests: lost() says so from its `checks`th call on, whatever the driver says.
    void lose_after(uint32_t checks) { checks_left_ = checks; }

 private:
    std::optional<uint32_t> checks_left_;
    std::string reason_;
};

/// After how many checks the first context, the second ... are to be lost, for tests of the whole program;
/// those beyond the list never are. One reader.
class LossPlan {
 public:
    /// "30,5": numbers with commas between; what is no number ends the list.
    explicit LossPlan(std::string_view numbers);
    /// Of an environment variable; LUCARNE_TEST_LOSE_CONTEXT and LUCARNE_TEST_LOSE_WINDOW
    /// (gi/device/gl/README.md).
    static LossPlan from_environment(const char* variable);
    /// For the next context that is made; none: it is left alone.
    std::optional<uint32_t> next();

 private:
    std::vector<uint32_t> checks_;
    size_t made_ = 0;
};

}  // namespace lucarne::gi
