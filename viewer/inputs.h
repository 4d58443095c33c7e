#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/core/error.h"
#include "octree/source.h"

namespace lucarne::viewer {

/// Handles that several caches share; more are closed and opened again in turn.
inline constexpr size_t kMostOpenCaches = 64;

/// All inputs as one cloud: one as open_input opens it, several joined (octree/stream/joined_source.h), each
/// in its own place, unit and schema. Errors: those of open_input, naming the input.
Result<std::shared_ptr<const octree::NodeSource>> open_inputs(const std::vector<std::string>& paths);

/// For titles and reports: "nave.luc" or "nave.luc and 199 more".
std::string inputs_text(const std::vector<std::string>& paths);

}  // namespace lucarne::viewer
