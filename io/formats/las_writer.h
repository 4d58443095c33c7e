#pragma once

#include <filesystem>

#include "io/formats/scan.h"

namespace lucarne::io::las {

/// See create_scan.
Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options);
/// LAZ, point formats 6 to 8.
Result<std::unique_ptr<PointWriter>> create_compressed(const std::filesystem::path& path,
                                                       const Schema& schema, const ScanInfo& info,
                                                       const WriteOptions& options);

}  // namespace lucarne::io::las
