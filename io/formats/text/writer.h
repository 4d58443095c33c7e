#pragma once

#include <filesystem>

#include "io/formats/scan.h"

namespace lucarne::io::text {

/// See create_scan: rows of numbers, between commas where the name ends in .csv, else between blanks. What
/// they are is said by a header line and, for ourselves, by comments with the types, the unit and the
/// stations; a name ending in .xyz has nothing but the rows.
Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io::text
