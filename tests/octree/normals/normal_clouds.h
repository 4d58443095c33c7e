// Clouds with known normals for the tests of octree/normals, in memory behind ChunkAccess.
#pragma once

#include <cmath>
#include <mutex>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/normals/normals.h"

namespace lucarne::octree::testing {

struct Cloud {
    std::vector<glm::dvec3> points;
    std::vector<glm::dvec3> normals;  ///< the true normals, on the side that is seen
    std::vector<int32_t> stations;    ///< empty: unknown
};

/// A cloud divided into `parts`^3 equal cells.
class MemoryChunks final : public ChunkAccess {
 public:
    MemoryChunks(const Cloud& cloud, uint32_t parts) : members_(size_t{parts} * parts * parts) {
        glm::dvec3 low(INFINITY), high(-INFINITY);
        for (const auto& p : cloud.points) low = glm::min(low, p), high = glm::max(high, p);
        const glm::dvec3 size =
            glm::max((high - low) * 1.0001, glm::dvec3(1e-300)) / static_cast<double>(parts);
        for (uint32_t z = 0; z < parts; ++z)
            for (uint32_t y = 0; y < parts; ++y)
                for (uint32_t x = 0; x < parts; ++x)
                    boxes_.push_back(
                        {low + size * glm::dvec3(x, y, z), low + size * glm::dvec3(x + 1, y + 1, z + 1)});
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            const auto cell = glm::min(glm::dvec3(parts - 1), glm::floor((cloud.points[i] - low) / size));
            members_[static_cast<size_t>(cell.x + parts * (cell.y + parts * cell.z))].push_back(i);
        }
        cloud_ = &cloud;
    }
    size_t chunk_count() const override { return members_.size(); }
    Box bounds(size_t chunk) const override { return boxes_[chunk]; }
    uint64_t point_count(size_t chunk) const override { return members_[chunk].size(); }
    Result<std::vector<glm::dvec3>> positions(size_t chunk) const override {
        std::vector<glm::dvec3> found;
        for (const size_t i : members_[chunk]) found.push_back(cloud_->points[i]);
        ++loads_;
        loaded_points_ += found.size();
        return found;
    }
    Result<std::vector<int32_t>> stations(size_t chunk) const override {
        std::vector<int32_t> found;
        for (const size_t i : members_[chunk])
            found.push_back(cloud_->stations.empty() ? -1 : cloud_->stations[i]);
        return found;
    }
    const std::vector<size_t>& members(size_t chunk) const { return members_[chunk]; }
    size_t loads() const { return loads_; }
    size_t loaded_points() const { return loaded_points_; }

 private:
    const Cloud* cloud_;
    std::vector<Box> boxes_;
    std::vector<std::vector<size_t>> members_;
    mutable std::atomic<size_t> loads_{0}, loaded_points_{0};
};

/// Estimates oriented normals and areas, in the order of the cloud's points.
struct Estimate {
    std::vector<glm::vec3> normals;
    std::vector<float> areas;
    std::vector<PointEdge> edges;
};

inline Estimate estimate(const Cloud& cloud, const NormalOptions& options = {}, uint32_t parts = 1,
                         size_t* loaded_points = nullptr) {
    const MemoryChunks chunks(cloud, parts);
    std::vector<ChunkNormals> results(chunks.chunk_count());
    std::vector<int> calls(chunks.chunk_count());
    const auto signs =
        estimate_normals(chunks, options, [&](size_t chunk, ChunkNormals&& normals) -> Result<void> {
            results[chunk] = std::move(normals);
            ++calls[chunk];
            return {};
        });
    EXPECT_TRUE(signs.has_value()) << (signs ? "" : signs.error().line());
    Estimate whole{std::vector<glm::vec3>(cloud.points.size()), std::vector<float>(cloud.points.size()),
                   std::vector<PointEdge>(cloud.points.size())};
    if (!signs) return whole;
    for (size_t chunk = 0; chunk < results.size(); ++chunk) {
        EXPECT_EQ(calls[chunk], 1);
        const auto& members = chunks.members(chunk);
        EXPECT_EQ(results[chunk].normals.size(), members.size());
        for (size_t i = 0; i < members.size(); ++i) {
            const float sign = (*signs)[chunk].at(results[chunk].components[i]) < 0 ? -1.0f : 1.0f;
            whole.normals[members[i]] = sign * results[chunk].normals[i];
            whole.areas[members[i]] = results[chunk].areas[i];
            whole.edges[members[i]] = results[chunk].edges[i];
            PointEdge& edge = whole.edges[members[i]];
            if (sign < 0) edge.beyond = turned(edge.beyond);
            const EdgeBase own{whole.normals[members[i]], whole.areas[members[i]]};
            whole.areas[members[i]] *= edge.kept();
            if (edge.kept() < 1)
                edge.code = rebased_edge(edge.code, own, {own.normal, whole.areas[members[i]]});
        }
    }
    if (loaded_points) *loaded_points = chunks.loaded_points();
    return whole;
}

/// Compares an estimate with the truth.
struct Score {
    double angle = 0;     ///< mean angle in degrees, regardless of sign
    double oriented = 0;  ///< share of the estimated normals on the true side
    double marked = 0;    ///< share of points without a normal
    double area = 0;      ///< sum of the areas
};
inline Score score(const Cloud& cloud, const Estimate& estimate) {
    Score s;
    size_t known = 0, right = 0;
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        s.area += estimate.areas[i];
        if (estimate.normals[i] == glm::vec3(0.0f)) continue;
        ++known;
        const double cosine = glm::dot(glm::dvec3(estimate.normals[i]), cloud.normals[i]);
        right += cosine > 0;
        s.angle += std::acos(std::min(1.0, std::abs(cosine))) * 180 / std::numbers::pi;
    }
    s.angle /= static_cast<double>(std::max<size_t>(1, known));
    s.oriented = static_cast<double>(right) / static_cast<double>(std::max<size_t>(1, known));
    s.marked =
        cloud.points.empty() ? 1 : 1 - static_cast<double>(known) / static_cast<double>(cloud.points.size());
    return s;
}

inline double gaussian(Random& random) {
    const double u = 1 - random.uniform(), v = random.uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

/// A unit square at z = 0, seen from above, with `noise` along z.
inline Cloud plane(size_t count, double noise = 0, uint64_t seed = 1) {
    Random random(seed);
    Cloud cloud;
    for (size_t i = 0; i < count; ++i) {
        const double x = random.uniform(), y = random.uniform();
        cloud.points.push_back({x, y, noise * gaussian(random)});
        cloud.normals.push_back({0, 0, 1});
    }
    return cloud;
}

/// A unit sphere, seen from outside.
inline Cloud sphere(size_t count, double noise = 0, uint64_t seed = 1) {
    Random random(seed);
    Cloud cloud;
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 n = glm::normalize(glm::dvec3(gaussian(random), gaussian(random), gaussian(random)));
        cloud.points.push_back(n * (1 + noise * gaussian(random)));
        cloud.normals.push_back(n);
    }
    return cloud;
}

/// The surface of a unit cube, seen from outside.
inline Cloud cube(size_t count, double noise = 0, uint64_t seed = 1) {
    Random random(seed);
    Cloud cloud;
    for (size_t i = 0; i < count; ++i) {
        const auto face = static_cast<int>(random.uniform() * 6);
        glm::dvec3 p(random.uniform(), random.uniform(), random.uniform()), n(0.0);
        n[face / 2] = face % 2 ? 1 : -1;
        p[face / 2] = face % 2 ? 1 : 0;
        cloud.points.push_back(p + n * (noise * gaussian(random)));
        cloud.normals.push_back(n);
    }
    return cloud;
}

inline void append(Cloud& cloud, const Cloud& other, const glm::dvec3& shift, double scale = 1) {
    for (const auto& p : other.points) cloud.points.push_back(p * scale + shift);
    cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
}

}  // namespace lucarne::octree::testing
