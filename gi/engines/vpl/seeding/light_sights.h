#pragma once

#include <cstdint>
#include <vector>

#include "gi/engines/vpl/seeding/emitters.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi::vpl {

/// Whether any material shines by itself.
bool emits(const Frame& frame);

/// What seeds VPLs: surfels that shine by themselves, and G-buffers of the lights' views. As many are held as
/// a fixed share of memory takes; of many lights, the others are drawn again whenever they are looked at.
class LightSights {
 public:
    /// The views of a new frame, `sky` of its environment. What was drawn holds where a view and its cut are
    /// as they were.
    void begin(const Frame& frame, const SkyDirections& sky);

    const std::vector<LightView>& views() const { return views_; }
    /// What view `index` sees; drawn where it is not held. Errors: no device memory, a shader that fails.
    Result<const GBuffer*> look(Frame& frame, size_t index);

    /// Places `count` VPLs on what the lights see, shared out among their views by the light that surfaces
    /// there give back. The same for the same `seed`. `materials` is what upload_materials made. Errors as
    /// above.
    Result<void> seed(Frame& frame, const Buffer& materials, uint32_t count, uint64_t seed, Seeds& target);

 private:
    /// A view drawn, without the scratch of rasterize().
    struct Held {
        CameraView view{};
        uint64_t cut = 0;
        bool whole = false;
        GBuffer gbuffer;
    };
    Result<Sight> sight(Frame& frame, size_t index);

    std::vector<LightView> views_;
    std::vector<Held> held_;
    GBuffer scratch_;
    Buffer importance_;
    Emitters emitters_;
};

}  // namespace lucarne::gi::vpl
