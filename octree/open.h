#pragma once

#include <filesystem>
#include <memory>

#include "io/files/handle_pool.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Whether the file is an octree by itself: a cache or COPC. False for anything else, unreadable files
/// included.
bool is_octree(const std::filesystem::path& path);

/// Opens it. Errors: those of open_cache and open_copc.
Result<std::unique_ptr<NodeSource>> open_octree(const std::filesystem::path& path,
                                                std::shared_ptr<HandlePool> handles = nullptr);

}  // namespace lucarne::octree
