#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gi/gl_frame.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/shared/brdf.h"
#include "gi/shared/flat_surfel.h"
#include "gi/surfels/side_light.h"

namespace lucarne::gi {

/// What becomes of the light of lights that surfels reflect by their specular lobes.
enum class Specular : uint8_t {
    even,   ///< it is spread evenly and added to their light
    apart,  ///< it is kept as lobes
};

/// What becomes of surfels without a normal, of which a scan consists while it is being read.
enum class Bare : uint8_t {
    dark,       ///< they send out no light
    of_planes,  ///< they have the normal of the plane about them (plane_normals.h)
};

/// The surfels of a light cut on the host, and the light that they send out before any bounce.
class LitSurfels {
 public:
    /// Takes the surfels of frame.gl.cuts.light. Drops the light. Errors: device memory, a shader that fails.
    Result<void> set_surfels(Frame& frame, Bare bare = Bare::dark);
    /// Computes what the surfels emit, and what they reflect of these views of the lights. Gives up if
    /// the frame is stopped. Errors as above.
    Result<void> set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers,
                           Specular specular = Specular::even);

    /// The same in steps: begin, any number of views, and end. Errors as above.
    Result<void> begin_light(Frame& frame, Specular specular = Specular::even);
    Result<void> add_light(Frame& frame, const LightView& view, LightGBuffers& gbuffers);
    void end_light(const Frame& frame);
    /// Frees what is on the device, for who seldom needs other light: the next begin_light() sends the
    /// surfels again.
    void free_device();

    std::span<const FlatSurfel> surfels() const { return surfels_; }
    /// Of each surfel: its radiance on both sides, W/(sr m^2).
    std::span<const SideLight> own_light() const { return own_; }
    /// Of each surfel: its light by specular lobes (lobe.h), if they are kept apart and anything is glossy.
    const SideLobes& lobes() const { return lobes_; }
    /// Of each surfel: the radiance that it sends out for each unit of irradiance, 1/sr; specular reflection
    /// is spread evenly.
    std::span<const glm::vec3> reflectances() const { return reflectances_; }

 private:
    /// Sets the lobes of a surfel, of which own_ is still the irradiance, and lobes_.directions those to the
    /// lights.
    void set_lobes(size_t surfel, const Reflectance& r);

    std::vector<FlatSurfel> surfels_;
    std::vector<SideLight> own_;
    std::vector<glm::vec3> reflectances_;
    SideLobes lobes_;
    bool apart_ = false;
    Buffer flat_, irradiance_, directions_;
};

}  // namespace lucarne::gi
