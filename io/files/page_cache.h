#pragma once

#include <filesystem>

#include "io/core/error.h"

namespace lucarne {

/// Drops a file from the kernel's page cache, so that the next reads come from the disk (to measure cold
/// starts). First writes what is not on the disk yet. Returns the share of the file that is still cached
/// afterwards, 0 to 1: another process may have it mapped, and some file systems ignore the request.
Result<double> drop_page_cache(const std::filesystem::path& path);

}  // namespace lucarne
