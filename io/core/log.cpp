#include "io/core/log.h"

#include <mutex>
#include <set>
#include <string>

#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "io/core/error.h"

namespace lucarne::log {
namespace {

/// Says no warning twice: a file is opened more than once, and each time the same is found in it. Of very
/// many warnings it forgets the older ones.
class WarnOnceSink final : public spdlog::sinks::dist_sink<std::mutex> {
 protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        constexpr size_t kMostKept = 1000;
        if (message.level == spdlog::level::warn) {
            if (said_.size() >= kMostKept) said_.clear();
            if (!said_.emplace(message.payload.data(), message.payload.size()).second) return;
        }
        dist_sink::sink_it_(message);
    }

 private:
    std::set<std::string> said_;
};

spdlog::logger& logger() {
    static const auto instance = [] {
        auto once = std::make_shared<WarnOnceSink>();
        once->add_sink(std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        auto made = std::make_shared<spdlog::logger>("lucarne", std::move(once));
        made->set_pattern("lucarne: %^%v%$");
        return made;
    }();
    return *instance;
}

/// As an error's line: names of files may hold control characters.
std::string one_line(std::string_view text) {
    return Error{ErrorKind::failed, std::string(text), "", ""}.line();
}

}  // namespace

void info(std::string_view text) {
    logger().info("{}", one_line(text));
}
void warn(std::string_view text) {
    logger().warn("{}", one_line(text));
}
void set_quiet(bool quiet) {
    logger().set_level(quiet ? spdlog::level::warn : spdlog::level::info);
}

}  // namespace lucarne::log
