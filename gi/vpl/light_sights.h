#pragma once

#include <cstdint>
#include <vector>

#include "gi/engine.h"
#include "gi/gbuffer/light_view.h"
#include "gi/vpl/emitters.h"
#include "gi/vpl/seeding.h"

namespace lucarne::gi::vpl {

/// Whether any material shines by itself.
bool emits(const Frame& frame);

/// What seeds VPLs: surfels that shine by themselves, and G-buffers of the lights' views. A few are held; of
/// many lights, the others are drawn again whenever they are looked at, so that the memory does not grow with
/// their number.
class LightSights {
 public:
    /// The views of a new frame. What was drawn of them holds if neither lights nor their cuts have changed.
    void begin(const Frame& frame);

    const std::vector<LightView>& views() const { return views_; }
    /// What view `index` sees; drawn where it is not held. Errors: no device memory, a shader that fails.
    Result<const GBuffer*> look(Frame& frame, size_t index);

    /// Places `count` VPLs on what the lights see, shared out among their views by the light that surfaces
    /// there give back. The same for the same `seed`. `materials` is what upload_materials made. Errors as
    /// above.
    Result<void> seed(Frame& frame, const Buffer& materials, uint32_t count, uint64_t seed, Seeds& target);

 private:
    struct Held {
        size_t view;
        GBuffer gbuffer;
    };
    Result<Sight> sight(Frame& frame, size_t index);

    /// What the G-buffers were drawn from.
    struct Basis {
        std::vector<Light> lights;
        std::vector<uint64_t> cuts;
        Bounds bounds;
        uint32_t resolution = 0;
        bool operator==(const Basis&) const = default;
    };
    Basis basis_;
    std::vector<LightView> views_;
    std::vector<Held> held_;
    Buffer importance_;
    Emitters emitters_;
};

}  // namespace lucarne::gi::vpl
