#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/engines/vpl/redistribution/redistribution.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/frame.h"
#include "gi/gl_frame.h"

namespace lucarne::gi::vpl {

/// Returns how many VPLs are drawn, of which `vpls` are kept: as many as take little time to measure.
constexpr uint32_t candidates_for(uint32_t vpls) {
    return vpls * std::clamp(32768u / vpls, 8u, 128u);
}

/// Chooses those of many candidates for VPLs whose light reaches the picture. Sun and sky light roofs and
/// outer walls; of the VPLs there a camera in a room sees nothing. So many more VPLs are drawn than needed,
/// and each is kept with a probability in proportion to what it adds to a few points that the camera sees, by
/// one bounce and by two (Georgiev & Slusallek 2010, "Simple and robust iterative importance sampling of
/// virtual point lights"). The sum stays unbiased.
///
/// The same points tell from where the sky reaches them, so that a room is not lit by the few directions of
/// the whole sky that happen to pass its windows.
class ViewImportance {
 public:
    /// Places importons for the camera of the frame and draws their shadow maps. `maps` has decoded casters
    /// and lends its scratch buffers. Errors: no device memory, a shader that fails.
    Result<void> look(Frame& frame, const Buffer& materials, uint64_t seed, ShadowMaps& maps);
    /// Then places importons where the importance of the first falls. `maps` must not have been used since.
    Result<void> look_further(Frame& frame, const Buffer& materials, uint64_t seed, ShadowMaps& maps);
    /// Returns how much light from each cell of the sky's grid (gi/lighting/sky_grid.h) adds to the picture,
    /// by at most one bounce. Errors as above.
    Result<std::vector<float>> openings(Device& device);
    /// Measures the importance of `count` candidates. Errors as above.
    Result<void> measure(Device& device, const Seeds& candidates, uint32_t count);
    /// The importance of each candidate.
    const std::vector<float>& importance() const { return importance_; }
    /// How near each candidate is to importons that it faces, whether or not it sees them (add_nearness()).
    const std::vector<float>& nearness() const { return nearness_; }
    /// Returns whether a moving camera still sees about what it saw when the importance was measured.
    bool serves(const CameraView& camera) const;

 private:
    /// Importons and their shadow maps.
    struct Importons {
        Seeds seeds;
        Buffer atlas;
    };
    Result<void> draw(Frame& frame, Importons& importons, bool sources, ShadowMaps& maps);

    Importons first_, second_;  ///< on what the camera sees, and where their importance falls
    Redistribution redistribution_;
    Buffer sums_, openings_;
    std::vector<float> importance_, nearness_;
    CameraView camera_{};
    float distance_ = 0;  ///< from the camera to what it sees, m
};

/// Adds to `sums` how near each candidate is to importons that it faces, 1/m^2; `apart` is the distance
/// between importons, m, below which nearness hardly grows.
void add_nearness(std::span<const VplLight> candidates, std::span<const VplLight> importons, float apart,
                  std::span<float> sums);

/// Draws `count` of the candidates with probabilities in proportion to their light times their importance,
/// and scales flux and footprint to match. Two in ten are drawn by their light times their nearness: a niche
/// that no importon sees may lie beside what the camera sees, and few VPLs there would each hold so much
/// light that they show as bright ledges. One in ten is drawn by its light alone, so that no light is
/// lost. The order of the candidates is kept. `seed` chooses the offset.
std::vector<VplLight> draw_candidates(std::span<const VplLight> candidates, std::span<const float> importance,
                                      std::span<const float> nearness, uint32_t count, uint64_t seed);

}  // namespace lucarne::gi::vpl
