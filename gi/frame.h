#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/options.h"
#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "io/core/progress.h"

namespace lucarne::gi {

struct GlFrame;
class PassTimes;

struct Bounds {
    glm::vec3 min{0.0f}, max{0.0f};
    bool operator==(const Bounds&) const = default;
};

/// One picture to be lit, as every engine sees it. Surfels, G-buffer and radiance are on the OpenGL device:
/// engines that draw there include gl_frame.h, those that compute on the host host_frame.h.
struct Frame {
    CameraView camera;
    std::vector<Light> lights;
    std::vector<Material> materials;
    glm::vec3 background{0.0f};
    EngineSettings settings;
    uint64_t index = 0;  ///< the frame's number since the view changed; averaging engines sample each anew
    std::shared_ptr<const Environment> environment;  ///< lights, and is seen in the place of `background`
    Bounds bounds{};                                 ///< of the whole cloud, m
    bool moving = false;  ///< the camera moves: an engine may use results of the frame before
    /// For moving frames: the time that may be spent on light which outlasts a frame, s. An engine may show
    /// such light as it was some frames ago, and make the new one bit by bit.
    double light_seconds = std::numeric_limits<double>::infinity();
    const std::atomic<bool>* stop = nullptr;  ///< see stopped(); or null
    Progress* progress = nullptr;             ///< for engines that report it; or null
    Unlit unlit{};                            ///< for the engine without light
    GlFrame& gl;
    PassTimes& times;

    /// Whether nobody waits for the picture any more. An engine may then return without having finished it;
    /// it must not use what it has begun.
    bool stopped() const { return stop && stop->load(std::memory_order_relaxed); }
};

}  // namespace lucarne::gi
