#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lucarne::io {

/// Warns that bytes follow the points of a file to which its header gives no meaning. `more` is what else can
/// be said of them; may be empty.
void warn_of_surplus(const std::string& file, uint64_t bytes, std::string_view more = {});

}  // namespace lucarne::io
