#include "octree/holes/planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

namespace lucarne::octree {
namespace {

constexpr float kFlat = 0.95f;         ///< length of a voxel's mean normal on one smooth surface
constexpr float kSameSide = 0.966f;    ///< cosine of 15 degrees: a voxel's normal and its patch's
constexpr float kSamePlane = 0.9976f;  ///< cosine of 4 degrees: two patches of one plane
constexpr float kStep = 0.35f;         ///< slope from one voxel of a patch to the next
constexpr float kApart = 1.0f;         ///< distance of two patches of one plane, in voxels
constexpr float kInPlane = 0.5f;       ///< distance of a single voxel from its plane, in voxels
constexpr float kSparse = 32;          ///< such voxels are at most so far outside the plane's box, in voxels
constexpr size_t kLeastVoxels = 24;    ///< of a patch
constexpr size_t kMostPatches = 512;   ///< that are compared with each other

/// The mean normal of a voxel and its neighbours that agree with it.
glm::vec3 normal_around(const Voxels& voxels, uint32_t voxel) {
    const glm::vec3 own = voxels.all()[voxel].normal;
    glm::vec3 sum = own;
    for (int i = 0; i < 27; ++i) {
        const uint32_t other = voxels.neighbour(voxel, {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
        if (other != kNoVoxel && glm::dot(voxels.all()[other].normal, own) > 0.9f * glm::dot(own, own))
            sum += voxels.all()[other].normal;
    }
    return glm::normalize(sum);
}

struct HolePatch {
    std::vector<uint32_t> members;
    glm::vec3 normal{0.0f}, centre{0.0f};
};

void fit(HolePatch& patch, std::span<const Voxel> voxels) {
    glm::dvec3 normal(0.0), centre(0.0);
    for (const uint32_t member : patch.members) {
        normal += glm::dvec3(voxels[member].normal);
        centre += glm::dvec3(voxels[member].position);
    }
    patch.normal = glm::vec3(glm::normalize(normal));
    patch.centre = glm::vec3(centre / static_cast<double>(patch.members.size()));
}

/// Grows a patch from a voxel; marks its members with `mark`.
HolePatch grown(Voxels& voxels, uint32_t seed, uint32_t mark) {
    const auto all = voxels.all();
    const glm::vec3 normal = normal_around(voxels, seed);
    HolePatch patch;
    patch.members.push_back(seed);
    all[seed].plane = mark;
    for (size_t next = 0; next < patch.members.size(); ++next) {
        const uint32_t from = patch.members[next];
        for (int i = 0; i < 27; ++i) {
            const uint32_t to = voxels.neighbour(from, {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
            if (to == kNoVoxel || all[to].plane != UINT32_MAX) continue;
            const glm::vec3 n = all[to].normal;
            if (glm::dot(n, normal) < kSameSide * glm::length(n) || glm::length(n) < kFlat) continue;
            const float step = glm::dot(all[to].position - all[from].position, normal);
            if (std::abs(step) > kStep * voxels.size()) continue;
            all[to].plane = mark;
            patch.members.push_back(to);
        }
    }
    fit(patch, all);
    return patch;
}

/// Returns the patches, the larger ones first.
std::vector<HolePatch> find_patches(Voxels& voxels) {
    std::vector<HolePatch> patches;
    const auto all = voxels.all();
    for (uint32_t seed = 0; seed < all.size(); ++seed) {
        if (all[seed].plane != UINT32_MAX || glm::length(all[seed].normal) < kFlat) continue;
        HolePatch patch = grown(voxels, seed, 0);
        if (patch.members.size() >= kLeastVoxels) patches.push_back(std::move(patch));
    }
    for (Voxel& voxel : all) voxel.plane = UINT32_MAX;
    std::ranges::stable_sort(patches, std::greater<>(),
                             [](const HolePatch& patch) { return patch.members.size(); });
    return patches;
}

bool in_one_plane(const HolePatch& a, const HolePatch& b, float voxel) {
    if (glm::dot(a.normal, b.normal) < kSamePlane) return false;
    const glm::vec3 between = b.centre - a.centre;
    return std::abs(glm::dot(between, a.normal)) < kApart * voxel &&
           std::abs(glm::dot(between, b.normal)) < kApart * voxel;
}

void measure(HolePlane& plane, const HolePatch& patch, std::span<const Voxel> voxels) {
    plane.normal = patch.normal;
    plane.centre = patch.centre;
    plane.voxels = patch.members.size();
    // One axis is horizontal, so that the grids of walls have few cells.
    const glm::vec3 up = std::abs(plane.normal.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    plane.u = glm::normalize(glm::cross(up, plane.normal));
    plane.v = glm::cross(plane.normal, plane.u);
    plane.least = glm::vec2(std::numeric_limits<float>::max());
    plane.most = -plane.least;
    plane.low = glm::vec3(std::numeric_limits<float>::max());
    plane.high = -plane.low;
    for (const uint32_t member : patch.members) {
        const glm::vec3 p = voxels[member].position;
        plane.low = glm::min(plane.low, p);
        plane.high = glm::max(plane.high, p);
        plane.least = glm::min(plane.least, plane.flat(p));
        plane.most = glm::max(plane.most, plane.flat(p));
    }
}

/// Adds voxels that no patch reached to the planes that they lie in: where points are sparse, as far from a
/// station, their voxels do not touch.
void add_sparse(Voxels& voxels, std::vector<HolePatch>& patches, std::vector<HolePlane>& planes) {
    const auto all = voxels.all();
    const float margin = kSparse * voxels.size();
    for (uint32_t i = 0; i < all.size(); ++i) {
        if (all[i].plane != UINT32_MAX) continue;
        const glm::vec3 p = all[i].position, n = all[i].normal;
        for (uint32_t j = 0; j < planes.size(); ++j) {
            const HolePlane& plane = planes[j];
            if (glm::any(glm::lessThan(p, plane.low - margin)) ||
                glm::any(glm::greaterThan(p, plane.high + margin)) ||
                std::abs(plane.height(p)) > kInPlane * voxels.size() || glm::dot(n, plane.normal) < kSameSide)
                continue;
            all[i].plane = j;
            patches[j].members.push_back(i);
            break;
        }
    }
    for (size_t j = 0; j < planes.size(); ++j) measure(planes[j], patches[j], all);
}

}  // namespace

std::vector<HolePlane> find_planes(Voxels& voxels, size_t most) {
    std::vector<HolePatch> patches = find_patches(voxels);
    if (patches.size() > kMostPatches) patches.resize(kMostPatches);
    std::vector<HolePatch> joined;
    for (HolePatch& patch : patches) {
        const auto same = std::ranges::find_if(
            joined, [&](const HolePatch& other) { return in_one_plane(other, patch, voxels.size()); });
        if (same == joined.end()) {
            joined.push_back(std::move(patch));
        } else {
            same->members.insert(same->members.end(), patch.members.begin(), patch.members.end());
            fit(*same, voxels.all());
        }
    }
    std::ranges::stable_sort(joined, std::greater<>(),
                             [](const HolePatch& patch) { return patch.members.size(); });
    if (joined.size() > most) joined.resize(most);
    std::vector<HolePlane> planes(joined.size());
    for (uint32_t i = 0; i < joined.size(); ++i) {
        for (const uint32_t member : joined[i].members) voxels.all()[member].plane = i;
        measure(planes[i], joined[i], voxels.all());
    }
    add_sparse(voxels, joined, planes);
    return planes;
}

}  // namespace lucarne::octree
