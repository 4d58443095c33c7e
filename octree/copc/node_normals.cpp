#include "octree/copc/node_normals.h"

#include <cmath>
#include <numbers>

#include <tbb/enumerable_thread_specific.h>

#include "octree/normals/neighbours/neighbours.h"
#include "octree/normals/neighbours/one_chunk.h"
#include "octree/normals/surface/surface_sample.h"

namespace lucarne::octree {
namespace {

constexpr size_t kNeighbours = 12;  ///< without the point itself
constexpr size_t kFewest = 4;

glm::vec3 upward(const glm::vec3& n) {
    const float side = n.z != 0 ? n.z : n.y != 0 ? n.y : n.x;
    return side < 0 ? -n : n;
}

}  // namespace

Result<std::vector<glm::vec3>> unsigned_normals(std::vector<glm::dvec3> points) {
    std::vector<glm::vec3> normals(points.size(), glm::vec3(0.0f));
    const OneChunk chunk(std::move(points));
    ChunkCache cache(chunk, 0);
    LUCARNE_ASSIGN(auto neighbours, ChunkNeighbours::load(cache, 0, NeighbourSearch::leaf, 0));
    tbb::enumerable_thread_specific<SurfaceFitter> fitters;
    LUCARNE_TRY(neighbours.search(
        kNeighbours + 1, [&](uint32_t site, const Patch& nearest, bool, ChunkNeighbours::Surroundings&) {
            if (nearest.count < kFewest) return 0.0;
            const float reach2 = nearest.distance2[nearest.count - 1];
            const float spacing =
                std::sqrt(std::numbers::pi_v<float> * reach2 / static_cast<float>(nearest.count - 1));
            const SurfaceFit fit = fitters.local().fit(nearest, spacing);
            if (fit.deviation < kPoorDeviation)
                for (const uint32_t point : neighbours.members(site)) normals[point] = upward(fit.normal);
            return 0.0;
        }));
    return normals;
}

}  // namespace lucarne::octree
