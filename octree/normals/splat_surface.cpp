#include "octree/normals/splat_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "octree/normals/normals.h"
#include "octree/tree/footprint.h"

namespace lucarne::octree {

SplatSurface::SplatSurface(const io::Schema& schema) {
    const auto found = [&](std::string_view name, uint32_t components) {
        const auto* a = schema.find(name);
        return a && a->type == io::ScalarType::f32 && a->components == components ? a : nullptr;
    };
    axis_ = found(io::names::splat_axis, 3);
    radius_ = found(io::names::splat_radius, 1);
}

glm::vec3 SplatSurface::normal(const std::byte* record, const glm::vec3& estimated) const {
    if (!axis_) return estimated;
    const auto axis = io::load<glm::vec3>(record + axis_->offset);
    const float length = glm::length(axis);
    if (!(length > 0.5f && length < 2)) return estimated;  // none, or damaged
    const float side = estimated != glm::vec3(0.0f) ? glm::dot(axis, estimated) : axis.z;
    return axis / (side < 0 ? -length : length);
}

float SplatSurface::area(const std::byte* record, float estimated, double face) const {
    if (!radius_) return estimated;
    const double radius = io::load<float>(record + radius_->offset);
    const auto own = static_cast<float>(std::numbers::pi * radius * radius / (kCoverageRaw * face));
    if (!(own > kStrayArea && std::isfinite(own))) return estimated;
    return estimated > 0 ? std::min(estimated, 4 * own) : own;
}

}  // namespace lucarne::octree
