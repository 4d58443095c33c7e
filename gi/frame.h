#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/options.h"
#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "gi/steps.h"
#include "io/core/progress.h"

namespace lucarne::gi {

struct GlFrame;
class PassTimes;
class Bake;

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
    glm::dvec3 origin{0.0};  ///< of all coordinates, in those of the file: another one makes them others
    bool moving = false;     ///< the camera moves: an engine may use results of the frame before
    /// Changes with what is lit and what lights it; not with the camera, settings and levels of detail.
    uint64_t content = 0;
    /// How much of the light that outlasts a frame a moving frame makes. Unless it is `whole`, an engine
    /// shows the light that it finished last, and makes the new one bit by bit.
    StepBudget light_budget{};
    /// What the engine has computed in advance so far (EngineInfo::precomputes); null: nothing yet.
    const Bake* bake = nullptr;
    /// To be added to coordinates of the bake's surfels to get those of the frame, m.
    glm::vec3 bake_offset{0.0f};
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
