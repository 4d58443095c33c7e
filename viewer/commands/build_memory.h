#pragma once

#include <cstdint>
#include <string>

#include "io/core/error.h"

namespace lucarne::viewer {

/// Returns the memory that a build may use, bytes, given a cap on the whole process such as "512M". Errors:
/// the text is not a number of bytes; the cap is less than the program needs.
Result<uint64_t> build_memory(const std::string& cap);

}  // namespace lucarne::viewer
