#include "gi/device/gl/context_watch.h"

#include <charconv>
#include <cstdlib>
#include <utility>

#include <epoxy/gl.h>

namespace lucarne::gi {

bool ContextWatch::lost() {
    if (!reason_.empty()) return true;
    if (checks_left_ && (*checks_left_ == 0 || --*checks_left_ == 0)) {
        reason_ = "its context was lost, as a test requested";
        return true;
    }
    switch (glGetGraphicsResetStatus()) {
        case GL_NO_ERROR:
            return false;
        case GL_GUILTY_CONTEXT_RESET:
            reason_ = "it was reset, because of what Lucarne drew";
            break;
        case GL_INNOCENT_CONTEXT_RESET:
            reason_ = "it was reset, because of another program";
            break;
        default:
            reason_ = "it was reset";
    }
    return true;
}

void ContextWatch::report_loss(std::string reason) {
    if (reason_.empty()) reason_ = std::move(reason);
}

LossPlan::LossPlan(std::string_view numbers) {
    const char *at = numbers.data(), *const end = at + numbers.size();
    for (uint32_t checks = 0; at != end;) {
        const auto [next, error] = std::from_chars(at, end, checks);
        if (error != std::errc()) return;
        checks_.push_back(checks);
        if (next == end || *next != ',') return;
        at = next + 1;
    }
}

LossPlan LossPlan::from_environment(const char* variable) {
    const char* text = std::getenv(variable);
    return LossPlan(text ? text : "");
}

std::optional<uint32_t> LossPlan::next() {
    if (made_ >= checks_.size()) return std::nullopt;
    return checks_[made_++];
}

}  // namespace lucarne::gi
