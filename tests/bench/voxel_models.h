// Meshes and pictures for figures of voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/volume/voxel_set.h"
#include "io/core/random.h"
#include "io/formats/mesh/mesh.h"
#include "io/image/image.h"
#include "io/synthetic/surface_mesh.h"

namespace lucarne::bench {

/// A mesh to divide among voxels.
struct VoxelModel {
    std::string name;
    io::mesh::Mesh mesh;
};

/// Returns the true surface of a virtual scene, as far as `wanted` takes the triangle of these corners.
inline Result<VoxelModel> scene_model(
    const std::string& name, const std::string& scene, double step,
    const std::function<bool(const std::array<glm::dvec3, 3>&)>& wanted = {}) {
    LUCARNE_ASSIGN(const auto geometry, io::SceneGeometry::create(scene));
    const io::SurfaceMesh surface = io::surface_mesh(geometry->mesh(), step);
    VoxelModel model{name, {}};
    for (const auto& vertex : surface.vertices) {
        model.mesh.positions.emplace_back(vertex.position);
        model.mesh.colors.push_back(vertex.albedo);
    }
    for (const auto& [a, b, c] : surface.triangles)
        if (!wanted || wanted({model.mesh.positions[a], model.mesh.positions[b], model.mesh.positions[c]}))
            model.mesh.triangles.push_back({a, b, c});
    model.mesh.finish();
    return model;
}

/// The knot of the statue alone: a smooth closed body of 80 thousand triangles, in size between the thesis'
/// bunny (69451) and Knossos (109168).
inline Result<VoxelModel> knot_model() {
    constexpr double kPlinth = 1.1001;  // m: the height of what it stands on
    return scene_model("knot", "statue", 1, [](const std::array<glm::dvec3, 3>& corners) {
        return std::ranges::all_of(corners, [](const glm::dvec3& p) { return p.z > kPlinth; });
    });
}

/// Returns points spread evenly over a mesh by chance, with the normals of their triangles.
inline std::vector<std::pair<glm::dvec3, glm::vec3>> points_with_normals(const io::mesh::Mesh& mesh,
                                                                         size_t count) {
    Random random(5);
    std::vector<std::pair<glm::dvec3, glm::vec3>> points;
    points.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const double at =
            (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) * mesh.area();
        const auto above = std::ranges::upper_bound(mesh.area_before, at);
        const auto triangle = std::min<size_t>(static_cast<size_t>(above - mesh.area_before.begin()) - 1,
                                               mesh.triangles.size() - 1);
        const auto [a, b, c] = mesh.points(triangle);
        const double u = std::sqrt(random.uniform()), v = random.uniform();
        points.emplace_back(a * (1 - u) + b * (u * (1 - v)) + c * (u * v),
                            glm::vec3(glm::normalize(glm::cross(b - a, c - a))));
    }
    return points;
}
inline std::vector<glm::dvec3> points_on(const io::mesh::Mesh& mesh, size_t count) {
    std::vector<glm::dvec3> points;
    for (const auto& [point, normal] : points_with_normals(mesh, count)) points.push_back(point);
    return points;
}

/// Finds the nearest of many points.
class NearestPoint {
 public:
    NearestPoint(const std::vector<glm::dvec3>& points, double cell) : points_(points), cell_(cell) {
        low_ = glm::dvec3(std::numeric_limits<double>::infinity());
        glm::dvec3 high = -low_;
        for (const glm::dvec3& p : points) {
            low_ = glm::min(low_, p);
            high = glm::max(high, p);
        }
        size_ = glm::ivec3((high - low_) / cell) + 1;
        starts_.assign(
            static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z) + 1,
            0);
        for (const glm::dvec3& p : points) ++starts_[number(place(p)) + 1];
        for (size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
        order_.resize(points.size());
        auto next = starts_;
        for (uint32_t i = 0; i < points.size(); ++i) order_[next[number(place(points[i]))]++] = i;
    }
    double distance(const glm::dvec3& from) const {
        const glm::ivec3 middle = place(from);
        const int farthest = std::max({size_.x, size_.y, size_.z});
        double least = std::numeric_limits<double>::infinity();
        // What lies beyond a shell is at least as far away as the shell's inner side.
        for (int shell = 0; shell <= farthest && least > (shell - 1) * cell_; ++shell)
            for (int z = -shell; z <= shell; ++z)
                for (int y = -shell; y <= shell; ++y) {
                    const bool side = std::abs(z) == shell || std::abs(y) == shell;
                    for (int x = -shell; x <= shell; x += side || shell == 0 ? 1 : 2 * shell)
                        least = std::min(least, in_cell(from, middle + glm::ivec3(x, y, z)));
                }
        return least;
    }

 private:
    glm::ivec3 place(const glm::dvec3& p) const {
        return glm::clamp(glm::ivec3(glm::floor((p - low_) / cell_)), glm::ivec3(0), size_ - 1);
    }
    size_t number(const glm::ivec3& cell) const {
        return (static_cast<size_t>(cell.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(cell.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(cell.x);
    }
    double in_cell(const glm::dvec3& from, const glm::ivec3& cell) const {
        if (cell != glm::clamp(cell, glm::ivec3(0), size_ - 1))
            return std::numeric_limits<double>::infinity();
        double least = std::numeric_limits<double>::infinity();
        const size_t home = number(cell);
        for (size_t i = starts_[home]; i < starts_[home + 1]; ++i)
            least = std::min(least, glm::distance(from, points_[order_[i]]));
        return least;
    }

    const std::vector<glm::dvec3>& points_;
    double cell_;
    glm::dvec3 low_{0.0};
    glm::ivec3 size_{1};
    std::vector<size_t> starts_;
    std::vector<uint32_t> order_;
};

/// Distances from each of some points to the nearest of others.
struct Distances {
    double mean = 0, largest = 0;
};
inline Distances distances(const std::vector<glm::dvec3>& from, const NearestPoint& to) {
    Distances found;
    for (const glm::dvec3& p : from) {
        const double d = to.distance(p);
        found.mean += d / static_cast<double>(from.size());
        found.largest = std::max(found.largest, d);
    }
    return found;
}

/// A voxel to be drawn, with its colour.
struct DrawnVoxel {
    glm::vec3 middle, normal, colour;
};

/// Draws voxels as cubes' outlines filled by one shade, from a raised place before them. Nearer voxels hide
/// others.
inline io::Image8 voxel_picture(const std::vector<DrawnVoxel>& voxels, float voxel, uint32_t side) {
    const glm::vec3 forward = glm::normalize(glm::vec3(.45f, 1, -.35f));
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 0, 1))),
                    up = glm::cross(right, forward);
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    const auto seen = [&](const glm::vec3& p) {
        return glm::vec3(glm::dot(p, right), glm::dot(p, up), glm::dot(p, forward));
    };
    for (const DrawnVoxel& v : voxels) {
        low = glm::min(low, seen(v.middle));
        high = glm::max(high, seen(v.middle));
    }
    const float scale = .95f * static_cast<float>(side) / std::max(high.x - low.x, high.y - low.y);
    const int reach = std::max(1, static_cast<int>(std::ceil(.65f * voxel * scale)));
    io::Image8 image{side, side, std::vector<uint8_t>(size_t{3} * side * side, 255)};
    std::vector<float> depths(size_t{side} * side, std::numeric_limits<float>::infinity());
    const glm::vec3 sun = glm::normalize(glm::vec3(-.5f, -.7f, .6f));
    for (const DrawnVoxel& v : voxels) {
        const glm::vec3 at = seen(v.middle), middle = .5f * (low + high);
        const int x = static_cast<int>(.5f * static_cast<float>(side) + (at.x - middle.x) * scale);
        const int y = static_cast<int>(.5f * static_cast<float>(side) - (at.y - middle.y) * scale);
        const glm::vec3 colour = v.colour * (.35f + .65f * std::max(0.0f, glm::dot(v.normal, sun)));
        for (int i = std::max(0, y - reach); i <= std::min<int>(y + reach, static_cast<int>(side) - 1); ++i)
            for (int k = std::max(0, x - reach); k <= std::min<int>(x + reach, static_cast<int>(side) - 1);
                 ++k) {
                const size_t pixel = static_cast<size_t>(i) * side + static_cast<size_t>(k);
                if (at.z >= depths[pixel]) continue;
                depths[pixel] = at.z;
                const bool edge = reach > 2 && (std::abs(i - y) == reach || std::abs(k - x) == reach);
                for (int c = 0; c < 3; ++c)
                    image.bytes[3 * pixel + static_cast<size_t>(c)] =
                        static_cast<uint8_t>(std::clamp(255 * colour[c] * (edge ? .8f : 1.0f), 0.0f, 255.0f));
            }
    }
    return image;
}

/// Returns the voxels of a set in one colour.
inline std::vector<DrawnVoxel> drawn(const gi::volume::VoxelSet& set, const glm::vec3& colour) {
    std::vector<DrawnVoxel> voxels;
    for (const auto& voxel : set.voxels)
        voxels.push_back({glm::vec3(set.middle(voxel)), voxel.normal, colour});
    return voxels;
}

}  // namespace lucarne::bench
