#pragma once

#include <string>
#include <string_view>

#include "octree/tree/source.h"

namespace lucarne::octree {

inline constexpr size_t kMostLayouts = 255;
inline constexpr size_t kMostStationColours = 1024;

/// Writes a cache's metadata as JSON (octree/FORMAT.md). Doubles are written so that they read back bit by
/// bit.
std::string metadata_text(const SourceHeader& header);
/// Parses metadata and checks all of it: types, ranges, nesting, the schema's layout. `file` names the cache
/// in errors.
Result<SourceHeader> parse_metadata(const std::string& file, std::string_view text);

}  // namespace lucarne::octree
