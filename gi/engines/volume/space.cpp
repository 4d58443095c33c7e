#include "gi/engines/volume/space.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kSmoothedAtOnce = 1024;
/// Faces belong to the same surface if their normals are within 37 degrees, and each is no farther from the
/// other's plane than this, in voxels.
constexpr float kLeastCosine = 0.8f, kFarthest = 0.7f;

bool same_surface(const Face& a, const Face& b, float voxel) {
    const glm::vec3 way = b.position - a.position;
    return glm::dot(a.normal, b.normal) > kLeastCosine &&
           std::abs(glm::dot(way, a.normal)) < kFarthest * voxel &&
           std::abs(glm::dot(way, b.normal)) < kFarthest * voxel;
}

}  // namespace

std::vector<glm::vec3> smoothed(const Space& space, std::span<const glm::vec3> values) {
    const auto faces = space.faces.all();
    std::vector<glm::vec3> means(faces.size());
    parallel_ranges(faces.size(), kSmoothedAtOnce, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const Face& face = faces[i];
            const glm::ivec3 cell = space.grid().cell(space.voxels.occupied()[face.voxel]);
            const glm::ivec3 up = step_of(face.side);
            const glm::ivec3 u = step_of(2 * ((axis_of(face.side) + 1) % 3));
            const glm::ivec3 v = step_of(2 * ((axis_of(face.side) + 2) % 3));
            glm::vec3 sum(0.0f);
            float count = 0;
            // The cells before all of these are air and touch each other, so there is no wall between them.
            for (int k = 0; k < 27; ++k) {
                const uint32_t voxel =
                    space.voxels.at(cell + (k % 3 - 1) * u + (k / 3 % 3 - 1) * v + (k / 9 - 1) * up);
                if (voxel == Voxels::kAir) continue;
                const uint32_t other = space.faces.at(voxel, face.side);
                if (other == Faces::kNone || !same_surface(face, faces[other], space.grid().voxel)) continue;
                sum += values[other];
                count += 1;
            }
            means[i] = count > 0 ? sum / count : values[i];
        }
    });
    return means;
}

}  // namespace lucarne::gi::volume
