#pragma once

#include <filesystem>
#include <memory>

#include "io/files/byte_source.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// What a file is that is an octree by itself.
enum class OctreeKind { none, cache, copc };
/// By its first bytes; none where they cannot be read.
OctreeKind octree_kind(const ByteSource& file);
/// Whether the file is an octree; false for anything else, unreadable files included.
bool is_octree(const std::filesystem::path& path);

/// Opens it. Errors: those of open_cache and open_copc.
Result<std::unique_ptr<NodeSource>> open_octree(std::shared_ptr<const ByteSource> file);
Result<std::unique_ptr<NodeSource>> open_octree(const std::filesystem::path& path);

}  // namespace lucarne::octree
