#include "octree/tree/point_normals.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "octree/tree/attributes.h"

namespace lucarne::octree {

PointNormals::PointNormals(const io::Schema& schema) {
    if (const auto* own = schema.find(io::names::normal); own && own->components == 3) own_ = own;
    const auto* estimated = schema.find(io::names::normal_oct);
    if (estimated && estimated->components == 3 && estimated->type == io::ScalarType::u8)
        estimated_ = estimated;
}

glm::vec3 PointNormals::of(const std::byte* record) const {
    if (own_) {
        const std::byte* at = record + own_->offset;
        const size_t step = io::scalar_bytes(own_->type);
        const glm::dvec3 n(io::scalar_at(own_->type, at), io::scalar_at(own_->type, at + step),
                           io::scalar_at(own_->type, at + 2 * step));
        const double length = glm::length(n);
        if (length > 0 && std::isfinite(length)) return glm::vec3(n / length);
    }
    if (!estimated_) return glm::vec3(0.0f);
    return decode_normal(io::load<NormalCode>(record + estimated_->offset)).value_or(glm::vec3(0.0f));
}

size_t PointNormals::missing(std::span<const std::byte> records, size_t stride) const {
    if (!own_ && !estimated_) return records.size() / stride;
    size_t missing = 0;
    for (size_t at = 0; at < records.size(); at += stride) missing += of(&records[at]) == glm::vec3(0.0f);
    return missing;
}

}  // namespace lucarne::octree
