#pragma once

#include <cstdint>
#include <vector>

#include "gi/engines/vpl/seeding/emitters.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/gl_frame.h"
#include "gi/lighting/light_gbuffers.h"

namespace lucarne::gi::vpl {

/// Returns whether any material has an emission.
bool emits(const Frame& frame);

/// Places VPLs on emissive surfels and on the G-buffers of the light views.
class LightSeeding {
 public:
    /// Places `count` VPLs on the surfaces that the lights see, and on emitters. They are shared out in
    /// proportion to the light that leaves those surfaces. The result is the same for the same `seed`.
    /// `materials` comes from upload_materials(). Errors: no device memory, a shader that fails.
    Result<void> seed(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers,
                      const Buffer& materials, uint32_t count, uint64_t seed, Seeds& target);

 private:
    Buffer importance_;
    Emitters emitters_;
};

}  // namespace lucarne::gi::vpl
