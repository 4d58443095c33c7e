#pragma once

#include <vector>

#include "gi/changes.h"
#include "gi/device/gl/device.h"

namespace lucarne::gi::vpl {

/// The indirect irradiance of the last moving frame, to be blended with the next one's where both show the
/// same surface (history.glsl). It holds while lights, materials and settings do.
class History {
 public:
    /// Readies it for a frame whose panes are to be merged by a program with LUCARNE_HISTORY. Errors: no
    /// device memory.
    Result<void> begin(const Frame& frame, const SceneRevisions& scene);
    void bind(const Frame& frame, const Program& merge) const;
    /// The frame was merged: it is the last one now.
    void end(const Frame& frame);

 private:
    struct Side {
        Buffer light;     ///< vec4 a pixel: irradiance, W/m^2; frames in it
        Buffer surfaces;  ///< uvec2 a pixel: depth (0: nothing), normal
    };
    Side last_, next_;
    SceneRevisions last_scene_, scene_;  ///< of last_ and next_
    CameraView camera_{};                ///< of last_; its width is 0 where there is no last frame
};

}  // namespace lucarne::gi::vpl
