#include "io/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "io/core/error.h"

namespace lucarne::log {
namespace {

spdlog::logger& logger() {
    static const auto instance = [] {
        auto made = std::make_shared<spdlog::logger>("lucarne",
                                                     std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
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
