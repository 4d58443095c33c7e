#include "viewer/picking/nearest.h"

#include <queue>
#include <tuple>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

double distance2(const octree::Cube& cube, const glm::dvec3& place) {
    const glm::dvec3 off = place - glm::clamp(place, cube.min, cube.min + cube.size);
    return glm::dot(off, off);
}

}  // namespace

Result<std::optional<ExactPoint>> nearest_point(NodeCache& cache, const glm::dvec3& place, double radius) {
    const octree::NodeSource& source = *cache.source();
    const auto nodes = source.nodes();
    using Entry = std::pair<double, uint32_t>;  // ordered by distance, then by the directory's order
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const uint32_t root : source.roots()) queue.emplace(distance2(source.cube(root), place), root);
    double best = radius * radius;
    std::optional<std::tuple<uint32_t, size_t>> found;
    while (!queue.empty() && queue.top().first <= best) {
        const uint32_t node = queue.top().second;
        queue.pop();
        LUCARNE_ASSIGN(const auto data, cache.node(node));
        const octree::SourcePart part = source.part_of(node);
        const io::Schema& schema = part.header.schema;
        for (size_t i = 0; i < data->count; ++i) {
            const glm::dvec3 off =
                io::position_of(schema, &data->records[i * schema.stride]) * part.scale - place;
            const double d2 = glm::dot(off, off);
            if (!(d2 < best || (d2 == best && !found))) continue;
            best = d2;
            found = {node, i};
        }
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[node].child(octant); child != octree::kNoNode)
                queue.emplace(distance2(source.cube(child), place), child);
    }
    if (!found) return std::nullopt;
    const auto [node, index] = *found;
    LUCARNE_ASSIGN(const auto data, cache.node(node));
    const size_t stride = source.part_of(node).header.schema.stride;
    return exact_point(source, node, &data->records[index * stride]);
}

}  // namespace lucarne::viewer
