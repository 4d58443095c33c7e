#pragma once

#include <optional>

#include "gi/changes.h"
#include "gi/device/gl/device.h"
#include "gi/engines/vpl/shading/native/merge.h"

namespace lucarne::gi::vpl {

/// The buffers of a History as the host sees them; `view` is valid as long as they are, and the History.
struct MappedHistory {
    MappedBuffer next_light, next_surfaces;
    std::optional<MappedBuffer> last_light, last_surfaces;
    native::MergeHistory view;
};

/// The indirect irradiance of the last moving frame, to be averaged with that of the next frame where both
/// show the same surface (history.glsl). It is valid while lights, materials and settings stay the same.
class History {
 public:
    /// Prepares for a frame that merge_tiles() will write. Errors: no device memory.
    Result<void> begin(const Frame& frame, const SceneRevisions& scene);
    /// Binds both frames for merge.comp with LUCARNE_HISTORY.
    void bind(const Frame& frame, const Program& merge) const;
    /// Maps both frames for native::merge(). Errors: the driver refuses.
    Result<MappedHistory> map() const;
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
