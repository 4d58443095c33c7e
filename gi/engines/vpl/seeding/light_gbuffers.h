#pragma once

#include <cstdint>
#include <vector>

#include "gi/engines/vpl/seeding/emitters.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi::vpl {

/// Returns whether any material has an emission.
bool emits(const Frame& frame);

/// Places VPLs on emissive surfels and on the G-buffers of the light views.
/// As many G-buffers are held as fit a quarter of the device's memory; with more lights, the others are drawn
/// again whenever they are needed.
class LightGBuffers {
 public:
    /// Starts a new frame: computes its light views, `sky` being that of its environment. Held G-buffers
    /// stay valid if the view and its cut are unchanged.
    void begin(const Frame& frame, const SkyDirections& sky);

    const std::vector<LightView>& views() const { return views_; }
    /// Returns the G-buffer of light view `index`, and draws it if it is not held. Errors: no device memory,
    /// a shader that fails.
    Result<const GBuffer*> look(Frame& frame, size_t index);

    /// Places `count` VPLs on the surfaces that the lights see, and on emitters. They are shared out in
    /// proportion to the light that leaves those surfaces. The result is the same for the same `seed`.
    /// `materials` comes from upload_materials(). Errors as above.
    Result<void> seed(Frame& frame, const Buffer& materials, uint32_t count, uint64_t seed, Seeds& target);

 private:
    /// A drawn light view, without the scratch buffers of rasterize().
    struct Held {
        CameraView view{};
        uint64_t cut = 0;
        bool whole = false;
        GBuffer gbuffer;
    };
    Result<LightGBuffer> gbuffer(Frame& frame, size_t index);

    std::vector<LightView> views_;
    std::vector<Held> held_;
    GBuffer scratch_;
    Buffer importance_;
    Emitters emitters_;
};

}  // namespace lucarne::gi::vpl
