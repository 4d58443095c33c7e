#pragma once

#include <filesystem>

#include "io/formats/scan.h"

namespace lucarne::io::pcd {

/// For create_scan.
Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io::pcd
