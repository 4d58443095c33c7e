#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/core/parallel.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

SyntheticOptions even(const std::string& scene, uint64_t points) {
    SyntheticOptions options;
    options.scene = scene;
    options.points = points;
    options.even = true;
    return options;
}

std::vector<std::byte> read_all(const PointSource& source, size_t batch_points) {
    std::vector<std::byte> all;
    const auto reader = source.open().value();
    for (PointBatch batch; reader->read(batch, batch_points).value() > 0;) {
        EXPECT_LE(batch.count, batch_points);
        EXPECT_EQ(batch.bytes.size(), batch.count * source.schema().stride);
        all.insert(all.end(), batch.bytes.begin(), batch.bytes.end());
    }
    return all;
}

std::vector<dvec3> positions(const SyntheticOptions& options) {
    const auto source = synthetic_source(options).value();
    const auto bytes = read_all(*source, 50'000);
    std::vector<dvec3> points;
    for (size_t at = 0; at < bytes.size(); at += source->schema().stride)
        points.push_back(position_of(source->schema(), bytes.data() + at));
    return points;
}

/// Returns the value that a chi-square variable of many degrees of freedom exceeds with probability .001
/// (Wilson and Hilferty 1931).
double chi_square_limit(double degrees) {
    return degrees * std::pow(1 - 2 / (9 * degrees) + 3.09 * std::sqrt(2 / (9 * degrees)), 3);
}

TEST(SyntheticEven, GivesExactlyTheNumberAskedFor) {
    for (const auto& scene : synthetic_scenes())
        for (const uint64_t points : {1u, 7u, 1000u, 16384u, 65537u})
            EXPECT_EQ(positions(even(scene.name, points)).size(), points) << scene.name;
}

TEST(SyntheticEven, BytesDependNeitherOnThreadsNorOnBatches) {
    auto options = even("cornell", 150'001);
    options.normals = true;
    const auto source = synthetic_source(options).value();
    const auto expected = read_all(*source, 1'000'000);
    for (const unsigned threads : {1u, 2u, 4u}) {
        const ThreadLimit limit(threads);
        for (const size_t batch : {77u, 16384u, 100'000u})
            EXPECT_EQ(read_all(*synthetic_source(options).value(), batch), expected)
                << threads << " " << batch;
    }
    options.seed = 2;
    EXPECT_NE(read_all(*synthetic_source(options).value(), 100'000), expected);
}

TEST(SyntheticEven, PointsAndNormalsAreThoseOfTheSurface) {
    for (const auto& scene : synthetic_scenes()) {
        auto options = even(scene.name, 20'000);
        options.normals = true;
        const auto source = synthetic_source(options).value();
        const auto geometry = SceneGeometry::create(scene.name).value();
        const auto bytes = read_all(*source, 50'000);
        const auto* normal = source->schema().find(names::normal);
        ASSERT_NE(normal, nullptr);
        size_t other_normal = 0;
        for (size_t at = 0; at < bytes.size(); at += source->schema().stride) {
            const dvec3 point = position_of(source->schema(), bytes.data() + at);
            const auto nearest = geometry->closest(point, .1);
            ASSERT_TRUE(nearest) << scene.name;
            // Half a step of 0.1 mm in each axis, plus the rounding of 30 m in float.
            EXPECT_LT(nearest->distance, 1e-4) << scene.name;
            const std::byte* stored = bytes.data() + at + normal->offset;
            const dvec3 n(load<float>(stored), load<float>(stored + 4), load<float>(stored + 8));
            EXPECT_NEAR(glm::length(n), 1, 1e-5);
            other_normal += dot(n, nearest->normal) < .98 ? 1 : 0;
        }
        // Next to an edge the nearest surface may be the neighbouring one.
        EXPECT_LT(other_normal, 200u) << scene.name;
    }
}

/// Returns the points of the furnace's floor, relative to its corner: a square of 2 m.
std::vector<glm::dvec2> floor_of_furnace(uint64_t points) {
    std::vector<glm::dvec2> floor;
    for (const dvec3& p : positions(even("furnace", points)))
        if (p.z == -1.0) floor.emplace_back(p.x + 1, p.y + 1);
    return floor;
}

TEST(SyntheticEven, EqualAreasHoldEqualNumbers) {
    constexpr int kCells = 16;
    std::vector<double> counts(kCells * kCells);
    const auto points = floor_of_furnace(6 * 64 * counts.size());
    for (const auto& p : points) {
        const auto cell = [](double x) {
            return std::clamp(static_cast<int>(x / 2 * kCells), 0, kCells - 1);
        };
        ++counts[static_cast<size_t>(cell(p.y) * kCells + cell(p.x))];
    }
    const double expected = static_cast<double>(points.size()) / static_cast<double>(counts.size());
    double chi_square = 0;
    for (const double count : counts) chi_square += (count - expected) * (count - expected) / expected;
    // Random points would give about 255; even ones give far less.
    EXPECT_LT(chi_square, .3 * static_cast<double>(counts.size()));
}

TEST(SyntheticEven, DensityIsUniformOverEveryScene) {
    // Counts points in slabs of equal width along three axes, and compares with the area of the mesh's quads
    // in them. p = .001 for random points. The axes are oblique: along a wall's edge whole rows of points,
    // which stand at the same height in all walls, would fall on one or the other side of a slab's border.
    const std::array<dvec3, 3> axes = {glm::normalize(dvec3(2, 1, .7)), glm::normalize(dvec3(-1, 1.7, .43)),
                                       glm::normalize(dvec3(-.6, -.5, 2.3))};
    for (const auto& scene : synthetic_scenes()) {
        const auto geometry = SceneGeometry::create(scene.name).value();
        const auto points = positions(even(scene.name, 100'000));
        const auto& mesh = geometry->mesh();
        for (const dvec3& axis : axes) {
            constexpr size_t kSlabs = 24;
            double low = dot(axis, dvec3(mesh.corners[0])), high = low;
            for (const auto& corner : mesh.corners) {
                low = std::min(low, dot(axis, dvec3(corner)));
                high = std::max(high, dot(axis, dvec3(corner)));
            }
            const double width = high - low;
            const auto slab = [&](const dvec3& p) {
                const double at = std::max(0.0, (dot(axis, p) - low) / width * kSlabs);
                return std::min(kSlabs - 1, static_cast<size_t>(at));
            };
            std::vector<double> area(kSlabs), count(kSlabs);
            for (size_t quad = 0; quad < mesh.quads(); ++quad) {
                const std::array<dvec3, 4> c = {mesh.corners[4 * quad], mesh.corners[4 * quad + 1],
                                                mesh.corners[4 * quad + 2], mesh.corners[4 * quad + 3]};
                // Large quads are distributed over the slabs they cross, in pieces much smaller than a slab.
                const auto steps = [&](int a, int b) {
                    return 1 + static_cast<int>(100 * glm::length(c[a] - c[b]) / width);
                };
                const int across = 6 * std::max(steps(0, 1), steps(3, 2)),
                          up = 6 * std::max(steps(0, 3), steps(1, 2));
                for (int i = 0; i < across; ++i)
                    for (int j = 0; j < up; ++j) {
                        const double t = (i + .5) / across, s = (j + .5) / up;
                        const dvec3 dt = (c[1] - c[0]) * (1 - s) + (c[2] - c[3]) * s;
                        const dvec3 ds = (c[3] - c[0]) * (1 - t) + (c[2] - c[1]) * t;
                        area[slab(mesh.position(quad, t, s))] +=
                            glm::length(glm::cross(dt, ds)) / (across * up);
                    }
            }
            for (const dvec3& p : points) ++count[slab(p)];
            double chi_square = 0;
            for (size_t i = 0; i < kSlabs; ++i) {
                const double expected = area[i] / geometry->area() * static_cast<double>(points.size());
                if (expected > 0)
                    chi_square += (count[i] - expected) * (count[i] - expected) / expected;
                else
                    EXPECT_EQ(count[i], 0);
            }
            EXPECT_LT(chi_square, chi_square_limit(kSlabs - 1)) << scene.name << " axis " << axis.x;
        }
    }
}

TEST(SyntheticEven, NeighboursKeepTheirDistance) {
    // Clark and Evans 1954: the mean distance to the nearest neighbour over that of random points, 0.5 /
    // sqrt(density). 1 for random points, 2.149 for a hexagonal lattice.
    for (const uint64_t wanted : {6'000u, 24'000u}) {
        const auto points = floor_of_furnace(wanted);
        double sum = 0, nearest_of_all = 1;
        size_t counted = 0;
        for (const auto& p : points) {
            if (std::min({p.x, p.y, 2 - p.x, 2 - p.y}) < .1) continue;
            double nearest = 1;
            for (const auto& q : points)
                if (&q != &p) nearest = std::min(nearest, glm::length(q - p));
            sum += nearest;
            nearest_of_all = std::min(nearest_of_all, nearest);
            ++counted;
        }
        const double random = .5 / std::sqrt(static_cast<double>(points.size()) / 4);
        EXPECT_GT(sum / static_cast<double>(counted) / random, 1.4);
        EXPECT_GT(nearest_of_all / random, .25);
    }
}

TEST(SyntheticEven, AThousandMillionPointsCostNoMemoryAhead) {
    const auto source = synthetic_source(even("cornell", 1'000'000'000)).value();
    const auto reader = source->open().value();
    PointBatch batch;
    EXPECT_EQ(reader->read(batch, 1000).value(), 1000u);
    EXPECT_EQ(source->info().declared_points, 1'000'000'000u);
}

}  // namespace
}  // namespace lucarne::io
