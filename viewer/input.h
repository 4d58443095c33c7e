#pragma once

#include <filesystem>
#include <memory>

#include "io/core/error.h"
#include "octree/source.h"

namespace lucarne::viewer {

/// An octree of whatever the user names: a cache as it is, any scan file through a temporary cache in the
/// system's folder for temporary files, which is gone once it is closed (however the program ends).
/// Errors: those of the readers and the builder.
Result<std::shared_ptr<const octree::NodeSource>> open_input(const std::filesystem::path& path);

}  // namespace lucarne::viewer
