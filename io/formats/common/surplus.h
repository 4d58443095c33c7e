#pragma once

#include <cstdint>
#include <string>

namespace lucarne::io {

/// Warns that bytes follow the points of a file to which its header gives no meaning. `records` is how many
/// points --salvage may find in them, or 0.
void warn_of_surplus(const std::string& file, uint64_t bytes, uint64_t records = 0);

}  // namespace lucarne::io
