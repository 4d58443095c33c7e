#pragma once

#include <filesystem>

#include "io/core/error.h"

namespace lucarne {

/// Asks the kernel to forget what it holds of a file, so that the next reads come from the disk (for
/// measuring cold starts). Writes what is not on disk first. Returns the share of the file that is still
/// held afterwards, 0 to 1: another process may have it mapped, and some file systems do not listen.
Result<double> drop_page_cache(const std::filesystem::path& path);

}  // namespace lucarne
