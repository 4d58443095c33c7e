#pragma once

#include <fmt/format.h>
#include <string_view>

namespace lucarne::log {

/// Messages for people, on stderr, one line each; results belong on stdout or into `--json`.
void info(std::string_view text);
void warn(std::string_view text);
void set_quiet(bool quiet);  ///< drops `info`, keeps `warn`

template <class... Args>
    requires(sizeof...(Args) > 0)
void info(fmt::format_string<Args...> text, Args&&... args) {
    info(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}
template <class... Args>
    requires(sizeof...(Args) > 0)
void warn(fmt::format_string<Args...> text, Args&&... args) {
    warn(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}

}  // namespace lucarne::log
