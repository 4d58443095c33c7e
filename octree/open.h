#pragma once

#include <filesystem>
#include <memory>

#include "io/files/byte_source.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Kinds of file that are octrees by themselves.
enum class OctreeKind { none, cache, copc };
/// Decides by the file's first bytes; `none` where they cannot be read.
OctreeKind octree_kind(const ByteSource& file);
/// Whether the file is an octree; false for anything else, unreadable files included.
bool is_octree(const std::filesystem::path& path);

/// Opens an octree file of either kind. Errors: those of open_cache and open_copc.
Result<std::unique_ptr<NodeSource>> open_octree(std::shared_ptr<const ByteSource> file);
Result<std::unique_ptr<NodeSource>> open_octree(const std::filesystem::path& path);

}  // namespace lucarne::octree
