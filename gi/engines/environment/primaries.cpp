#include "gi/engines/environment/primaries.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"

namespace lucarne::gi::environment {
namespace {

/// A node is curved over this share of thickness to radius; light differs within it, so it counts as larger.
constexpr float kCurved = 0.2f, kCurvedSize = 2;
/// Nodes are discs of about this many of their radii across, from the middle of one to the next.
constexpr float kRadiiApart = 1.6f;
/// Places beside the picture that pixels at its edges interpolate from, in radii.
constexpr float kBeside = 3;
/// How far a visible point may be from the plane of a node that it belongs to, in radii.
constexpr float kOffPlane = 0.25f;
constexpr int kProbes = 5;  ///< along each axis of a node's picture

/// Whether a pixel shows a surface of a node, which is `radius` pixels in size about `at`.
bool shows(const CameraView& camera, std::span<const SurfacePoint> visible, const SidePlace& place,
           const glm::vec2& at, float radius) {
    const float reach = std::min(radius, 64.0f);
    for (int j = 0; j < kProbes; ++j)
        for (int i = 0; i < kProbes; ++i) {
            const glm::vec2 pixel =
                at + reach * (2.0f / (kProbes - 1) * glm::vec2(static_cast<float>(i), static_cast<float>(j)) -
                              1.0f);
            if (!(pixel.x >= 0 && pixel.y >= 0)) continue;
            const auto x = static_cast<uint32_t>(pixel.x), y = static_cast<uint32_t>(pixel.y);
            if (x >= camera.width || y >= camera.height) continue;
            const SurfacePoint& seen = visible[size_t{y} * camera.width + x];
            if (!(seen.radius > 0)) continue;
            const glm::vec3 offset = seen.position - place.position;
            if (glm::dot(offset, offset) < 4 * place.size * place.size &&
                std::abs(glm::dot(offset, place.normal)) < kOffPlane * place.size + seen.radius)
                return true;
        }
    return false;
}

/// Collects the primary places; stops beyond `most`.
std::vector<SidePlace> collect(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                               const CameraView& camera, std::span<const SurfacePoint> visible, float spacing,
                               size_t most) {
    std::vector<SidePlace> found;
    std::vector<uint32_t> waiting;
    if (!tree.empty()) waiting.push_back(0);
    while (!waiting.empty() && found.size() <= most) {
        const uint32_t at = waiting.back();
        waiting.pop_back();
        const WideNode& node = tree.nodes[at];
        for (uint32_t k = 0; k < 8; ++k) {
            if (node.child[k] == kNoChild) continue;
            const glm::vec3 middle = middle_of(node, k), axis = axis_of(node, k);
            const float bound = node.bound[k];
            float depth = 0;
            const glm::vec2 place = view_place(camera, middle, depth);
            const bool behind = !is_parallel(camera) && depth < camera.origin.w + bound;
            if (!is_parallel(camera) && depth < -bound) continue;
            const float pixel = pixel_height(camera, std::max(depth - bound, camera.origin.w));
            const float radius = bound / pixel;
            const float beside = kBeside * radius;
            if (!behind && (place.x < -beside || place.y < -beside ||
                            place.x > static_cast<float>(camera.width) + beside ||
                            place.y > static_cast<float>(camera.height) + beside))
                continue;
            const float size = node.thickness[k] > kCurved * bound ? kCurvedSize * radius : radius;
            const bool leaf = node.child[k] == kLeafChild;
            if (!leaf && (behind || kRadiiApart * size > spacing)) {
                waiting.push_back(static_cast<uint32_t>(node.child[k]));
                continue;
            }
            const uint32_t slot = 8 * at + k;
            const uint32_t back = glm::dot(axis, toward_viewer(camera, middle)) < 0;
            const SidePlace primary = place_of(tree, surfels, 2 * slot + back);
            if (shows(camera, visible, primary, place, radius)) found.push_back(primary);
        }
    }
    return found;
}

}  // namespace

SidePlace place_of(const SurfelTree& tree, std::span<const FlatSurfel> surfels, uint32_t side) {
    size_t slot = side / 2;
    const WideNode& node = tree.nodes[slot / 8];
    const glm::vec3 middle = middle_of(node, slot % 8), axis = axis_of(node, slot % 8);
    const float size = node.bound[slot % 8];
    while (tree.surfels[slot] == kNoSurfel) {
        size_t nearest = slot;
        float least = INFINITY;
        for_each_child(tree, slot, [&](size_t child) {
            const float away = glm::distance(middle_of(tree.nodes[child / 8], child % 8), middle);
            if (away >= least) return;
            least = away;
            nearest = child;
        });
        slot = nearest;
    }
    const FlatSurfel& surfel = surfels[tree.surfels[slot]];
    return {side, {surfel.x, surfel.y, surfel.z}, (side & 1) != 0 ? -axis : axis, surfel.radius, size};
}

std::vector<SidePlace> primary_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                                      const CameraView& camera, std::span<const SurfacePoint> visible,
                                      float spacing, size_t most) {
    for (;;) {
        std::vector<SidePlace> found = collect(tree, surfels, camera, visible, spacing, most);
        if (found.size() <= most) return found;
        spacing *= 1.5f;
    }
}

}  // namespace lucarne::gi::environment
