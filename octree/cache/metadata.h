#pragma once

#include <string>
#include <string_view>

#include "octree/tree/source.h"

namespace lucarne::octree {

inline constexpr size_t kMostLayouts = 255;

/// The cache's metadata as JSON (octree/FORMAT.md) and back. Doubles survive bit by bit.
std::string metadata_text(const SourceHeader& header);
/// Everything is checked: types, ranges, nesting, the schema's layout. `file` names the cache in errors.
Result<SourceHeader> parse_metadata(const std::string& file, std::string_view text);

}  // namespace lucarne::octree
