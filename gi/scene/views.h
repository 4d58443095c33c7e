#pragma once

#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "io/core/options.h"
#include "octree/stream/cut.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

/// The origin of the device's coordinates: device = (world - origin) * metres_per_unit, in metres.
struct LocalFrame {
    glm::dvec3 origin{0.0};
    double metres_per_unit = 1.0;

    glm::vec3 to_local(const glm::dvec3& world) const {
        return glm::vec3((world - origin) * metres_per_unit);
    }
};

/// Returns a frame whose origin is the position rounded to a grid of 256 m. So floats near the camera step by
/// at most 15 um, and the origin rarely changes along a path.
LocalFrame local_frame(const glm::dvec3& position, double metres_per_unit);

/// Converts a scene's camera for engines.
CameraView camera_view(const SceneCamera& camera, ImageSize size, const LocalFrame& frame);
/// Shifts the rays of a camera's view to where they pass through their pixels in a frame of an average, so
/// that the average is that over the pixels' areas. Frame 0: the middles of the pixels.
void shift_rays(CameraView& view, uint32_t frame);
/// Converts it for choosing nodes, in world units.
octree::View octree_view(const SceneCamera& camera, ImageSize size);

/// Converts a scene's light for engines.
Light device_light(const SceneLight& light, const LocalFrame& frame);
/// Returns a cut of what the light shines on, at most `budget` points: for spots and directional lights by a
/// view of `resolution` texels along a side, for the others in all directions.
octree::Cut light_view_cut(const octree::NodeSource& source, const SceneLight& light, uint32_t resolution,
                           uint64_t budget);

/// Converts a material. `albedo` scales the albedo given by the points' colours.
Material device_material(const SceneMaterial& material, double albedo = 1);
/// Returns those of a scene, with its scale of the albedo.
std::vector<Material> materials_of(const Scene& scene);

}  // namespace lucarne::gi
