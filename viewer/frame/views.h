#pragma once

#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "io/core/options.h"
#include "octree/stream/cut.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Where the devices' coordinates begin: device = (world - origin) * metres_per_unit, in metres.
struct LocalFrame {
    glm::dvec3 origin{0.0};
    double metres_per_unit = 1.0;

    glm::vec3 to_local(const glm::dvec3& world) const {
        return glm::vec3((world - origin) * metres_per_unit);
    }
};

/// The origin is the position rounded to a grid of 256 m, so that floats near the camera step by 15 um at
/// most and the origin rarely changes along a path.
LocalFrame local_frame(const glm::dvec3& position, double metres_per_unit);

/// A scene's camera as engines take it.
gi::CameraView camera_view(const gi::SceneCamera& camera, ImageSize size, const LocalFrame& frame);
/// The same for choosing nodes, in world units.
octree::View octree_view(const gi::SceneCamera& camera, ImageSize size);

/// A scene's light as engines take it.
gi::Light device_light(const gi::SceneLight& light, const LocalFrame& frame);
/// What it shines on, in at most `budget` points: by a view of `resolution` texels along a side for spots and
/// directional lights, all around the others.
octree::Cut light_view_cut(const octree::NodeSource& source, const gi::SceneLight& light, uint32_t resolution,
                           uint64_t budget);

/// `albedo`: scales what the points' colours give.
gi::Material device_material(const gi::SceneMaterial& material, double albedo = 1);

}  // namespace lucarne::viewer
