#pragma once

#include <filesystem>

#include "io/formats/scan.h"

namespace lucarne::io::text {

/// For create_scan: writes rows of numbers, separated by commas if the name ends in .csv, otherwise by
/// blanks. A header line names the columns; comments that only Lucarne reads add the types, the unit and the
/// stations. A file ending in .xyz has only the rows.
Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io::text
