#pragma once

#include <cstdint>
#include <string>

#include "io/core/error.h"

namespace lucarne::viewer {

/// What a build may hold under a cap on the memory of the whole process, "512M". Errors: no number of bytes;
/// less than the program can work with.
Result<uint64_t> build_memory(const std::string& cap);

}  // namespace lucarne::viewer
