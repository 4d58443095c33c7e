#pragma once

#include <cstdint>
#include <vector>

#include "gi/changes.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/options.h"

namespace lucarne::gi::vpl {

/// Everything from which VPLs and maps are made.
struct Basis {
    SceneRevisions scene;     ///< `settings` is 0: those that matter are below
    EngineSettings settings;  ///< without those that only shading uses
    LightCutRevisions cuts;
    uint64_t index = UINT64_MAX;  ///< of the frame; UINT64_MAX: nothing was made
    CameraView camera{};          ///< for which VPLs were chosen, if they are chosen by the view
    bool operator==(const Basis&) const = default;
    bool whole() const { return index != UINT64_MAX; }
};

/// The VPLs of one bounce and their maps.
struct Bounce {
    Seeds seeds;
    Buffer atlas;
};

/// The light of a scene as VPLs: all that shading needs.
struct Lighting {
    std::vector<Bounce> bounces;
    AtlasLayout layout;  ///< of each bounce's maps
    Basis basis;         ///< not whole() while it is being made
    /// VPLs of all bounces, as many as one bounce has, see unite_bounces(); for moving pictures.
    Bounce united;
    bool is_united = false;

    /// Whether it can light a picture of these settings and this scene, though perhaps as it was a moment
    /// ago.
    bool serves(const Basis& now) const;
};

/// Makes `lighting.united`: of the VPLs of each bounce an even part, in proportion to the light that leaves
/// them, with as much more light and footprint. Shading then takes as long as for one bounce, with more
/// noise. Errors: no device memory.
Result<void> unite_bounces(Device& device, Lighting& lighting);

/// Returns the mean irradiance, W/m^2, in a closed box of the size of the scene whose albedo is .5, by this
/// many bounces of which these are the first one's VPLs (an integrating sphere): an ambient term until there
/// is better light.
float ambient_irradiance(const Seeds& first_bounce, const Bounds& scene, uint32_t bounces);

}  // namespace lucarne::gi::vpl
