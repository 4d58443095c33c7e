#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "io/formats/mesh/textures.h"

namespace lucarne::io::mesh {

/// Adds the materials of an MTL text to the mesh: Kd (taken as sRGB, as most writers mean it) and map_Kd with
/// its options -s, -o and -clamp. Ignores everything else. If two materials have the same name, the first
/// counts. Source: Wavefront, "MTL material format (Lightwave, OBJ)", 1995 (Bourke's copy).
void read_materials(std::string_view text, const std::filesystem::path& folder, Companions& companions,
                    Mesh& mesh, std::map<std::string, uint32_t, std::less<>>& by_name);

}  // namespace lucarne::io::mesh
