#pragma once

#include <vector>

#include "gi/changes.h"
#include "gi/device/gl/device.h"

namespace lucarne::gi::vpl {

/// The indirect irradiance of the last moving frame, to be averaged with that of the next frame where both
/// show the same surface (history.glsl). It is valid while lights, materials and settings stay the same.
class History {
 public:
    /// Prepares for a frame that merge.comp with LUCARNE_HISTORY will write. Errors: no device memory.
    Result<void> begin(const Frame& frame, const SceneRevisions& scene);
    void bind(const Frame& frame, const Program& merge) const;
    /// Makes the frame, which has been merged, the last one.
    void end(const Frame& frame);

 private:
    struct Side {
        Buffer light;     ///< vec4 per pixel: irradiance, W/m^2; w: number of frames
        Buffer surfaces;  ///< uvec2 per pixel: depth (0: no surface), normal
    };
    Side last_, next_;
    SceneRevisions last_scene_,
        scene_;            ///< of last_ and next_; light may be reused only while they are equal
    CameraView camera_{};  ///< of last_; width 0: there is no last frame
};

}  // namespace lucarne::gi::vpl
