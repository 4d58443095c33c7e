#include "gi/scene/views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::gi {
namespace {

constexpr double kOriginGrid = 256.0;  // m
constexpr double kNearPlane = 0.01;    // m
// Distance of the pinhole for which nodes of an orthographic picture are chosen, in picture heights from its
// plane. Nodes a hundred heights behind the plane are chosen one hundredth too coarse.
constexpr double kPinholeDistance = 1e4;
constexpr double kWidestAngle = 3.0;  // radians: a plane cannot show a field of view of pi

struct Axes {
    glm::dvec3 forward, right, up;
};

/// Returns the axes of a view from `from` to `to`. If `up_hint` is parallel to that direction or useless,
/// chooses another up.
Axes look_at(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& up_hint) {
    const auto unit = [](const glm::dvec3& v, const glm::dvec3& otherwise) {
        const double length = glm::length(v);
        return length > 0 && std::isfinite(length) ? v / length : otherwise;
    };
    const glm::dvec3 forward = unit(to - from, {0, 1, 0});
    const glm::dvec3 spare = std::abs(forward.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    glm::dvec3 right = glm::cross(forward, unit(up_hint, spare));
    if (glm::length(right) < 1e-6) right = glm::cross(forward, spare);
    right = glm::normalize(right);
    return {forward, right, glm::cross(right, forward)};
}

octree::View make_view(const glm::dvec3& position, const Axes& axes, double tan_half_height, double aspect) {
    octree::View view;
    view.position = position;
    view.forward = axes.forward;
    view.right = axes.right;
    view.up = axes.up;
    view.tan_half_height = tan_half_height;
    view.tan_half_width = tan_half_height * aspect;
    return view;
}

}  // namespace

LocalFrame local_frame(const glm::dvec3& position, double metres_per_unit) {
    const double grid = kOriginGrid / metres_per_unit;
    return {glm::round(position / grid) * grid, metres_per_unit};
}

octree::View octree_view(const SceneCamera& camera, ImageSize size) {
    const Axes axes = look_at(camera.position, camera.target, camera.up);
    const double tangent = std::tan(std::clamp(camera.vertical_fov, 1e-3, kWidestAngle) / 2);
    const double aspect = static_cast<double>(size.width) / size.height, height = camera.orthographic_height;
    octree::View view = height > 0 ? make_view(camera.position - axes.forward * (kPinholeDistance * height),
                                               axes, .5 / kPinholeDistance, aspect)
                                   : make_view(camera.position, axes, tangent, aspect);
    view.width = size.width;
    view.height = size.height;
    return view;
}

CameraView camera_view(const SceneCamera& camera, ImageSize size, const LocalFrame& frame) {
    const octree::View view = octree_view(camera, size);
    CameraView result{};
    result.origin = glm::vec4(frame.to_local(camera.position), static_cast<float>(kNearPlane));
    result.forward = glm::vec4(glm::vec3(view.forward), 0.0f);
    // Half the height, or the tangent of half the angle.
    const bool parallel = camera.orthographic_height > 0;
    const double up =
        parallel ? camera.orthographic_height / 2 * frame.metres_per_unit : view.tan_half_height;
    result.right =
        glm::vec4(glm::vec3(view.right * (up * (static_cast<double>(size.width) / size.height))), 0.0f);
    result.up = glm::vec4(glm::vec3(view.up * up), 0.0f);
    result.projection = parallel ? kOrthographic : kPerspective;
    result.width = size.width;
    result.height = size.height;
    return result;
}

void shift_rays(CameraView& view, uint32_t frame) {
    // Multiples of irrational numbers cover a pixel evenly after any number of frames (a Kronecker sequence).
    // Not the plastic number, by which lights are sampled (gi/lighting/light_samples.cpp), nor powers of two,
    // by which interleaved pixels and halves of paths alternate: the average would mix up the two.
    const glm::dvec2 at =
        glm::fract(0.5 + static_cast<double>(frame) * glm::dvec2(std::numbers::sqrt2, std::numbers::sqrt3));
    view.right.w = static_cast<float>(at.x - 0.5);
    view.up.w = static_cast<float>(at.y - 0.5);
}

Light device_light(const SceneLight& from, const LocalFrame& frame) {
    const Axes axes = look_at(from.position, from.target, from.up);
    const auto length = [&](double v) { return static_cast<float>(v * frame.metres_per_unit); };
    Light light{};
    light.kind = static_cast<uint32_t>(from.kind);
    light.position = glm::vec4(frame.to_local(from.position), 0.0f);
    light.direction = glm::vec4(glm::vec3(axes.forward), 0.0f);
    light.strength = glm::vec4(glm::vec3(from.strength), 0.0f);
    switch (from.kind) {
        case LightKind::spot: {
            const double half = std::clamp(from.angle, 1e-3, kWidestAngle) / 2;
            const double inner = half * (1 - std::clamp(from.softness, 0.0, 1.0));
            light.position.w = static_cast<float>(std::cos(half));
            light.direction.w = static_cast<float>(std::cos(inner));
            break;
        }
        case LightKind::directional:
            light.direction.w = static_cast<float>(std::clamp(from.angular_radius, 0.0, M_PI_2));
            break;
        case LightKind::rectangle: {
            const glm::vec3 side(axes.right);
            light.extent = glm::vec4(side * length(from.width / 2), length(from.height / 2));
            break;
        }
        case LightKind::disc:
            light.extent.w = length(from.radius);
            break;
        case LightKind::point:
            break;
    }
    return light;
}

octree::Cut light_view_cut(const octree::NodeSource& source, const SceneLight& light, uint32_t resolution,
                           uint64_t budget) {
    const Axes axes = look_at(light.position, light.target, {0, 0, 1});
    const auto& header = source.header();
    octree::View view;
    switch (light.kind) {
        case LightKind::spot:
            view = make_view(light.position, axes, std::tan(std::clamp(light.angle, 1e-3, kWidestAngle) / 2),
                             1.0);
            break;
        case LightKind::directional: {
            // The view is so far away that its rays are nearly parallel.
            constexpr double kFarAway = 1e4;  // diagonals of the scan
            const double diagonal = std::max(glm::length(header.max - header.min), 1e-3);
            view = make_view((header.min + header.max) / 2.0 - axes.forward * (kFarAway * diagonal), axes,
                             .5 / kFarAway, 1.0);
            break;
        }
        default:  // these shine in all directions
            return octree::light_cut(source, light.position, budget);
    }
    view.width = view.height = resolution;
    return octree::light_view_cut(source, view, budget);
}

Material device_material(const SceneMaterial& material, double albedo) {
    Material result{};
    result.diffuse = glm::vec4(glm::vec3(material.diffuse * albedo), static_cast<float>(material.specular));
    const glm::vec3 emission(material.emits ? material.emission : glm::dvec3(0));
    result.emission = glm::vec4(emission, static_cast<float>(material.shininess));
    return result;
}

std::vector<Material> materials_of(const Scene& scene) {
    std::vector<Material> materials;
    for (const SceneMaterial& material : scene.materials)
        materials.push_back(device_material(material, scene.albedo.scale));
    return materials;
}

}  // namespace lucarne::gi
