#include "gi/engines/environment/primaries.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <glm/geometric.hpp>

#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi::environment {
namespace {

/// A node is curved over this share of thickness to radius; light differs within it, so it counts as larger.
constexpr float kCurved = 0.2f, kCurvedSize = 2;
/// From the middle of a node to that of the next, in radii.
constexpr float kRadiiApart = 1.6f;
/// Places beside the picture that pixels at its edges interpolate from, in pixels between places.
constexpr float kBeside = 2;
/// How far a visible point may be from the plane of a node that it belongs to, in radii.
constexpr float kOffPlane = 0.25f;
constexpr int kProbes = 5;  ///< along each axis of a node's picture
/// A place stands for others that are nearer than this share of the spacing and whose normals agree so well.
constexpr float kTooNear = 1, kSameDirection = 0.85f;

/// Returns the depth at which a slot is seen in full, at least that of the near plane.
float depth_of(const SurfelTree& tree, size_t slot, const CameraView& camera) {
    const WideNode& node = tree.nodes[slot / 8];
    if (is_parallel(camera)) return 1;
    const float distance = glm::distance(middle_of(node, slot % 8), glm::vec3(camera.origin));
    return std::max(distance - node.bound[slot % 8], camera.origin.w);
}

/// Returns the point nearest to the middle of a place that pixels show of its node, which is `radius` pixels
/// in size about `at`; null if they show none.
const SurfacePoint* shown(const CameraView& camera, std::span<const SurfacePoint> visible,
                          const SidePlace& place, const glm::vec2& at, float radius) {
    const float reach = std::min(radius, 64.0f);
    const SurfacePoint* found = nullptr;
    float least = 4 * place.size * place.size;
    for (int j = 0; j < kProbes; ++j)
        for (int i = 0; i < kProbes; ++i) {
            const glm::vec2 offset(static_cast<float>(i), static_cast<float>(j));
            const glm::vec2 pixel = at + reach * (2.0f / (kProbes - 1) * offset - 1.0f);
            if (!(pixel.x >= 0 && pixel.y >= 0)) continue;
            const auto x = static_cast<uint32_t>(pixel.x), y = static_cast<uint32_t>(pixel.y);
            if (x >= camera.width || y >= camera.height) continue;
            const SurfacePoint& seen = visible[size_t{y} * camera.width + x];
            if (!(seen.radius > 0)) continue;
            const glm::vec3 away = seen.position - place.position;
            if (std::abs(glm::dot(away, place.normal)) >= kOffPlane * place.size + seen.radius) continue;
            if (const float distance2 = glm::dot(away, away); distance2 < least) {
                least = distance2;
                found = &seen;
            }
        }
    return found;
}

/// Collects the places that the picture shows; stops beyond `most`.
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
            const uint32_t slot = 8 * at + k;
            const glm::vec3 middle = middle_of(node, k);
            const float bound = node.bound[k];
            float depth = 0;
            const glm::vec2 place = view_place(camera, middle, depth);
            const bool crosses = !is_parallel(camera) && depth < camera.origin.w + bound;
            if (!is_parallel(camera) && depth < -bound) continue;
            const float radius = bound / pixel_height(camera, depth_of(tree, slot, camera));
            const float beside = radius + kBeside * spacing;
            if (!crosses && (place.x < -beside || place.y < -beside ||
                             place.x > static_cast<float>(camera.width) + beside ||
                             place.y > static_cast<float>(camera.height) + beside))
                continue;
            const float size = node.thickness[k] > kCurved * bound ? kCurvedSize : 1.0f;
            if (node.child[k] != kLeafChild && (crosses || !is_fine(tree, slot, camera, spacing / size))) {
                waiting.push_back(static_cast<uint32_t>(node.child[k]));
                continue;
            }
            if (!is_parallel(camera) && depth <= 0) continue;
            const uint32_t back = glm::dot(axis_of(node, k), toward_viewer(camera, middle)) < 0;
            SidePlace primary = place_of(tree, surfels, 2 * slot + back);
            const SurfacePoint* seen = shown(camera, visible, primary, place, radius);
            if (!seen) continue;
            // Pixels have smoother normals than surfels, which would see parts of their own surface.
            primary.position = seen->position;
            primary.normal = seen->normal;
            primary.viewer = seen->viewer;
            primary.radius = seen->radius;
            primary.size = std::max(primary.size, spacing / kRadiiApart * pixel_height(camera, depth));
            found.push_back(primary);
        }
    }
    return found;
}

/// Returns those places for which no other stands.
std::vector<SidePlace> thinned(std::vector<SidePlace> places, const CameraView& camera, float spacing) {
    std::ranges::stable_sort(places, std::greater<>(), &SidePlace::size);
    // By the cells of the picture; a place looks at the cells about its own.
    const auto cell = static_cast<float>(std::max(spacing * kTooNear * kRadiiApart, 1.0f));
    const auto columns = static_cast<int>(static_cast<float>(camera.width) / cell) + 3;
    const auto rows = static_cast<int>(static_cast<float>(camera.height) / cell) + 3;
    std::vector<std::vector<uint32_t>> cells(static_cast<size_t>(columns) * static_cast<size_t>(rows));
    std::vector<SidePlace> kept;
    for (const SidePlace& place : places) {
        float depth = 0;
        const glm::vec2 at = view_place(camera, place.position, depth) / cell + 1.0f;
        const int x = static_cast<int>(std::clamp(at.x, 0.0f, static_cast<float>(columns - 1)));
        const int y = static_cast<int>(std::clamp(at.y, 0.0f, static_cast<float>(rows - 1)));
        const auto stands = [&](uint32_t other) {
            const SidePlace& o = kept[other];
            const float reach = kTooNear * kRadiiApart * place.size;
            return glm::distance(o.position, place.position) < reach &&
                   glm::dot(o.normal, place.normal) > kSameDirection &&
                   std::abs(glm::dot(o.position - place.position, o.normal)) < kOffPlane * place.size;
        };
        bool needed = true;
        for (int j = std::max(y - 1, 0); needed && j <= std::min(y + 1, rows - 1); ++j)
            for (int i = std::max(x - 1, 0); needed && i <= std::min(x + 1, columns - 1); ++i)
                needed = std::ranges::none_of(cells[static_cast<size_t>(j * columns + i)], stands);
        if (!needed) continue;
        cells[static_cast<size_t>(y * columns + x)].push_back(static_cast<uint32_t>(kept.size()));
        kept.push_back(place);
    }
    return kept;
}

}  // namespace

SidePlace place_of(const SurfelTree& tree, std::span<const FlatSurfel> surfels, uint32_t side) {
    size_t slot = side / 2;
    const WideNode& node = tree.nodes[slot / 8];
    const glm::vec3 middle = middle_of(node, slot % 8);
    glm::vec3 normal = axis_of(node, slot % 8);
    const float size = node.bound[slot % 8];
    const bool curved = node.thickness[slot % 8] > kCurved * size;
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
    if (curved) {
        const glm::vec3 own = decode_octahedral(surfel.normal);
        normal = glm::dot(own, normal) < 0 ? -own : own;
    }
    if ((side & 1) != 0) normal = -normal;
    return {.side = side,
            .position = {surfel.x, surfel.y, surfel.z},
            .normal = normal,
            .viewer = glm::vec3(0.0f),
            .radius = surfel.radius,
            .size = size};
}

bool is_fine(const SurfelTree& tree, size_t slot, const CameraView& camera, float spacing, float least) {
    const float pixel = pixel_height(camera, depth_of(tree, slot, camera));
    return kRadiiApart * std::max(tree.nodes[slot / 8].bound[slot % 8], least) <= spacing * pixel;
}

std::vector<SidePlace> primary_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                                      const CameraView& camera, std::span<const SurfacePoint> visible,
                                      float spacing, size_t most) {
    constexpr size_t kMostCandidates = size_t{1} << 20;
    constexpr int kRounds = 16;  // the last spacing is 400 times the first
    for (int round = 0;; ++round, spacing *= 1.5f) {
        std::vector<SidePlace> found = collect(tree, surfels, camera, visible, spacing, kMostCandidates);
        const bool all = found.size() <= kMostCandidates;
        if (!all && round < kRounds) continue;
        found = thinned(std::move(found), camera, spacing);
        if (all && found.size() <= most) return found;
        if (round < kRounds) continue;
        // More surfels than that are about the camera itself.
        found.resize(std::min(found.size(), most));
        return found;
    }
}

}  // namespace lucarne::gi::environment
