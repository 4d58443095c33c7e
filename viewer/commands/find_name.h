#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "io/core/error.h"
#include "io/core/options.h"

namespace lucarne::viewer {

/// Returns the index of `name`, the value of `option`, in `names`. Errors (ErrorKind::arguments): `name` is
/// not among them; the message lists `names`.
inline Result<size_t> find_name(std::string_view option, const std::string& name,
                                std::span<const std::string_view> names) {
    for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return i;
    std::string kind(option.substr(option.find_first_not_of('-')));
    std::ranges::replace(kind, '-', ' ');
    return bad_arguments(std::string(option), fmt::format("unknown {} '{}'", kind, name),
                         advice(name, names));
}

}  // namespace lucarne::viewer
