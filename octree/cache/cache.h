#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "io/files/file.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// The most memory that the directory of an open cache takes. A cache of four billion points needs as much.
inline constexpr uint64_t kDirectoryMemory = uint64_t{32} << 20;
inline constexpr uint64_t kWholeDirectory = UINT64_MAX;

/// Whether the file starts like a cache; false if it cannot be read.
bool is_cache(const ByteSource& file);

/// Opens a cache. Reads superblock, metadata and directory, and checks everything that can be checked without
/// the points (sizes against the file, keys, counts, offsets, overlaps); in a directory of more than
/// kDirectoryMemory, page by page when they are looked at. Errors: ErrorKind::input_rejected.
Result<std::unique_ptr<NodeSource>> open_cache(std::shared_ptr<const ByteSource> file);
Result<std::unique_ptr<NodeSource>> open_cache(const std::filesystem::path& path);

struct VerifyReport {
    uint64_t nodes = 0, points = 0, bytes = 0;
    uint32_t depth = 0;             ///< the deepest level
    uint64_t bytes_behind_end = 0;  ///< left by an interrupted update; harmless
};

/// Reads the whole cache and checks every checksum and invariant: both superblocks, every point inside its
/// node's cube, the bounds, the counts. Calls `progress` with the bytes of each checked node. A directory
/// that takes more than `directory_memory` bytes is read page by page, if it can be.
Result<VerifyReport> verify_cache(std::shared_ptr<const ByteSource> file,
                                  const std::function<void(uint64_t)>& progress,
                                  uint64_t directory_memory = kDirectoryMemory);
Result<VerifyReport> verify_cache(const std::filesystem::path& path,
                                  const std::function<void(uint64_t)>& progress);

}  // namespace lucarne::octree
