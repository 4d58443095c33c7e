#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::octree {

/// Decides which normal of a point is drawn, shown and written: the input's own (`normal`) where it is finite
/// and not zero, else the estimated one (`normal_oct`). `--normals estimate` stores the input's own under
/// another name (octree/tree/stored_names.h), so that the estimated ones are used.
class PointNormals {
 public:
    explicit PointNormals(const io::Schema& schema);

    /// A unit vector, or zero where the point has no normal.
    glm::vec3 of(const std::byte* record) const;
    /// Returns how many of these records have no normal.
    size_t missing(std::span<const std::byte> records, size_t stride) const;

 private:
    const io::Attribute *own_ = nullptr, *estimated_ = nullptr;  ///< in the schema, which outlives this
};

}  // namespace lucarne::octree
