#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gi/engines/vpl/shading/shading.h"
#include "gi/engines/vpl/shading/sky_map.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/gl_frame.h"
#include "gi/lighting/sky_directions.h"

namespace lucarne::gi::vpl {

/// The direct light of the sky at every pixel: hundreds of directions, each with a coarse shadow map of what
/// the camera sees, shared out among the interleaved tiles as VPLs are.
class SkyLight {
 public:
    /// Takes the frame's environment. What is far brighter than most of it, such as a sun in a picture, is
    /// left to light views: bright().
    void set_environment(const std::shared_ptr<const Environment>& environment);
    /// The directions of what add() leaves out; dark if it leaves out nothing.
    const SkyDirections& bright() const { return bright_; }
    /// Whether there is anything for add().
    bool dark() const { return even_.dark(); }

    /// Adds the light of the sky to the tiles, which join_tiles() has prepared. `casters` has the decoded
    /// casters of frame.gl.cuts.light; `openings` says which directions reach what the camera sees
    /// (SkyDirections::favour()). Errors: no device memory, a shader that fails.
    Result<void> add(Frame& frame, const Buffer& materials, std::span<const float> openings,
                     const ShadowMaps& casters, Tiles& tiles);

 private:
    Result<bool> find_receivers(Frame& frame, Bounds& bounds);
    Result<void> draw(Frame& frame, const ShadowMaps& casters, const std::vector<SkyMap>& maps);
    Result<void> shade(Frame& frame, const Buffer& materials, const std::vector<SkyMap>& maps, Tiles& tiles);

    std::shared_ptr<const Environment> environment_;
    SkyDirections even_, bright_;
    uint32_t side_ = 0;     ///< texels along a side of a map
    float depth_step_ = 1;  ///< m
    Buffer maps_, texels_, bounds_;
};

/// Returns the map of a directional light over the receivers' bounds, `side` texels along a side. Depths
/// begin before the scene. The map's grid is moved by `shift`, a part of a texel along both axes.
SkyMap sky_map(const Light& light, const Bounds& receivers, const Bounds& scene, uint32_t side,
               const glm::vec2& shift);

}  // namespace lucarne::gi::vpl
