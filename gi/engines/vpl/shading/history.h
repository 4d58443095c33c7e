#pragma once

#include <vector>

#include "gi/engine.h"

namespace lucarne::gi::vpl {

/// The indirect irradiance of the last moving frame, to be blended with the next one's where both show the
/// same surface (history.glsl). It holds while lights, materials and settings do.
class History {
 public:
    /// Readies it for a frame whose panes are to be merged by a program with LUCARNE_HISTORY. Errors: no
    /// device memory.
    Result<void> begin(const Frame& frame);
    void bind(const Frame& frame, const Program& merge) const;
    /// The frame was merged: it is the last one now.
    void end(const Frame& frame);

 private:
    struct Side {
        Buffer light;     ///< vec4 a pixel: irradiance, W/m^2; frames in it
        Buffer surfaces;  ///< uvec2 a pixel: depth (0: nothing), normal
    };
    /// What must be the same for light to be the same.
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
    CameraView camera_{};  ///< of last_; no width: there is none
};

}  // namespace lucarne::gi::vpl
