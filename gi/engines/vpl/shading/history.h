#pragma once

#include <vector>

#include "gi/engine.h"

namespace lucarne::gi::vpl {

/// The indirect irradiance of the last moving frame, to be averaged with that of the next frame where both
/// show the same surface (history.glsl). It is valid while lights, materials and settings stay the same.
class History {
 public:
    /// Prepares for a frame that merge.comp with LUCARNE_HISTORY will write. Errors: no device memory.
    Result<void> begin(const Frame& frame);
    void bind(const Frame& frame, const Program& merge) const;
    /// Makes the frame, which has been merged, the last one.
    void end(const Frame& frame);

 private:
    struct Side {
        Buffer light;     ///< vec4 per pixel: irradiance, W/m^2; w: number of frames
        Buffer surfaces;  ///< uvec2 per pixel: depth (0: no surface), normal
    };
    /// Light may be reused only while these are equal.
    struct Basis {
        EngineSettings settings;
        std::vector<Light> lights;
        std::vector<Material> materials;
        Bounds bounds;
        const Environment* environment = nullptr;
        bool operator==(const Basis&) const = default;
    };
    static Basis basis_of(const Frame& frame);

    Side last_, next_;
    Basis basis_;
    CameraView camera_{};  ///< of last_; width 0: there is no last frame
};

}  // namespace lucarne::gi::vpl
