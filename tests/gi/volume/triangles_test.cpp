// Triangles in voxels: exact areas against geometry, and drawn voxels against each other and against exact
// ones.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/volume/surfel_voxels.h"
#include "gi/volume/triangles/areas.h"
#include "gi/volume/triangles/raster_voxels.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "tests/gi/on_device.h"
#include "tests/gi/volume/meshes.h"

namespace lucarne::gi::volume {
namespace {

using io::mesh::Mesh, meshes::box, meshes::finished, meshes::sphere;

MeshTriangles in_grid(const Mesh& mesh, uint32_t voxels) {
    auto triangles = MeshTriangles::create(mesh, 1, voxels);
    EXPECT_TRUE(triangles) << triangles.error().line();
    return std::move(*triangles);
}

TEST(MeshTriangles, TheGridIsTightAndHoldsEveryCorner) {
    const Mesh mesh = finished(box({1e6, -2, 5}, {1e6 + 4, 0, 6}));
    const auto triangles = MeshTriangles::create(mesh, .5, 64);
    ASSERT_TRUE(triangles);
    EXPECT_EQ(triangles->grid().size, glm::ivec3(64, 32, 16));
    EXPECT_EQ(triangles->grid().voxel, 2.0f / 64);
    EXPECT_EQ(triangles->origin(), glm::dvec3(5e5, -1, 2.5));
    EXPECT_NEAR(triangles->area(), .25 * 2 * (8 + 4 + 2), 1e-9);
    for (size_t i = 0; i < triangles->count(); ++i)
        for (const glm::dvec3& corner : (*triangles)[i].corners)
            EXPECT_TRUE(triangles->grid().holds(glm::ivec3(glm::floor(corner))));
}

TEST(MeshTriangles, MeshesWithoutTrianglesAndImpossibleGridsAreErrors) {
    const Mesh mesh = finished(box(glm::dvec3(0), glm::dvec3(1)));
    for (const uint32_t voxels : {0u, kMostMeshVoxels + 1, 1'000'000u}) {
        const auto wrong = MeshTriangles::create(mesh, 1, voxels);
        ASSERT_FALSE(wrong);
        EXPECT_EQ(wrong.error().kind, ErrorKind::arguments);
    }
    EXPECT_TRUE(MeshTriangles::create(mesh, 1, 1));
    EXPECT_FALSE(MeshTriangles::create(Mesh{}, 1, 64));
    Mesh flat = box(glm::dvec3(0), glm::dvec3(0));  // eight corners in one place
    EXPECT_FALSE(MeshTriangles::create(finished(std::move(flat)), 1, 64));
    Mesh unknown = box(glm::dvec3(0), glm::dvec3(1));
    for (glm::dvec3& p : unknown.positions) p.x = NAN;
    EXPECT_FALSE(MeshTriangles::create(finished(std::move(unknown)), 1, 64));
    for (const double size : {1e-20, 1e16, 1e30})
        EXPECT_FALSE(MeshTriangles::create(finished(box(glm::dvec3(0), glm::dvec3(size))), 1, 64)) << size;
    const Mesh vast = finished(box(glm::dvec3(0), glm::dvec3(9e14)));
    const auto large = MeshTriangles::create(vast, 1, 64);
    ASSERT_TRUE(large);
    EXPECT_TRUE(std::isfinite(areas_of_triangles(*large).area()));
}

TEST(AreasOfTriangles, OfABoxAreItsSides) {
    // Eight voxels a side; the box ends at the borders of the grid.
    const VoxelSet set = areas_of_triangles(in_grid(finished(box(glm::dvec3(1), glm::dvec3(3))), 8));
    EXPECT_EQ(set.voxels.size(), 8u * 8 * 8 - 6 * 6 * 6);
    for (const OccupiedVoxel& voxel : set.voxels) {
        const glm::ivec3 cell = set.grid.cell(voxel.cell);
        int sides = 0;
        for (int axis = 0; axis < 3; ++axis) sides += cell[axis] == 0 || cell[axis] == 7;
        EXPECT_NEAR(voxel.area, sides / 16.0f, 1e-6f);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(voxel.normal[axis],
                        cell[axis] == 0   ? -1 / std::sqrt(sides)
                        : cell[axis] == 7 ? 1 / std::sqrt(sides)
                                          : 0,
                        1e-5);
    }
}

TEST(AreasOfTriangles, AddUpToTheMeshWhateverTheGrid) {
    const Mesh ball = finished(sphere({3, 4, -5}, 2, 24)), soup = finished(meshes::soup(300, 7));
    for (const Mesh* mesh : {&ball, &soup})
        for (const uint32_t voxels : {1u, 3u, 32u, 100u}) {
            const MeshTriangles triangles = in_grid(*mesh, voxels);
            EXPECT_NEAR(areas_of_triangles(triangles).area() / triangles.area(), 1, 1e-6) << voxels;
        }
}

TEST(AreasOfTriangles, OfASphereLieWithinAVoxelOfIt) {
    const glm::dvec3 middle(3, 4, -5);
    const VoxelSet set = areas_of_triangles(in_grid(finished(sphere(middle, 2, 64)), 32));
    for (const OccupiedVoxel& voxel : set.voxels) {
        const glm::dvec3 out = set.middle(voxel) - middle;
        EXPECT_NEAR(glm::length(out), 2, .87 * static_cast<double>(set.grid.voxel) + .01);
        if (voxel.area > .5f * set.grid.voxel * set.grid.voxel) {
            EXPECT_GT(glm::dot(glm::normalize(out), glm::dvec3(voxel.normal)), .99);
        }
    }
    // Of cubes that a smooth closed surface of area A meets there are 1.5 A / h^2 in the mean over
    // directions.
    EXPECT_NEAR(static_cast<double>(set.voxels.size()) * std::pow(static_cast<double>(set.grid.voxel), 2) /
                    (16 * M_PI),
                1.5, .05);
}

TEST(AreasOfTriangles, KeepTheMeanOfColours) {
    Mesh mesh = box(glm::dvec3(0), glm::dvec3(1));
    for (const glm::dvec3& p : mesh.positions)
        mesh.colors.push_back(p.z > .5 ? io::mesh::Color8{255, 255, 255} : io::mesh::Color8{0, 0, 0});
    const VoxelSet set = areas_of_triangles(in_grid(finished(std::move(mesh)), 10));
    for (const OccupiedVoxel& voxel : set.voxels) {
        const glm::ivec3 cell = set.grid.cell(voxel.cell);
        if (cell.z == 0 || cell.z == 9) continue;
        EXPECT_NEAR(voxel.albedo.x, (static_cast<float>(cell.z) + .5f) / 10, 1e-4f);
    }
}

TEST(AreasOfTriangles, AreTheSameForAnyNumberOfThreads) {
    const Mesh mesh = finished(meshes::soup(2000, 3));
    const VoxelSet all = areas_of_triangles(in_grid(mesh, 40));
    const ThreadLimit limit(1);
    const VoxelSet one = areas_of_triangles(in_grid(mesh, 40));
    EXPECT_TRUE(std::ranges::equal(all.voxels, one.voxels, [](const auto& a, const auto& b) {
        return a.cell == b.cell && a.area == b.area && a.normal == b.normal && a.albedo == b.albedo;
    }));
}

/// The discs of points that lie evenly on a sphere fill all voxels that its triangles meet, and further ones
/// by their rims.
TEST(SurfelVoxels, HoldTheAreaAndTheVoxelsOfTheSurfaceTheyLieOn) {
    const glm::dvec3 middle(3, 4, -5);
    const Mesh mesh = finished(sphere(middle, 2, 64));
    const MeshTriangles triangles = in_grid(mesh, 32);
    constexpr uint32_t kPoints = 20'000;
    const auto area = static_cast<float>(16 * M_PI / kPoints);
    std::vector<Surfel> surfels;
    for (uint32_t i = 0; i < kPoints; ++i) {
        const double z = 1 - (2 * i + 1.0) / kPoints, across = std::sqrt(1 - z * z),
                     angle = 2.39996322972865 * i;
        const glm::dvec3 out(across * std::cos(angle), across * std::sin(angle), z);
        surfels.push_back({glm::vec3(middle + 2.0 * out - triangles.origin()), glm::vec3(out),
                           glm::vec3(.25f), 1.3f * std::sqrt(area), area, 0});
    }
    const auto set = voxels_of_surfels(surfels, triangles.grid(), triangles.origin());
    ASSERT_TRUE(set) << set.error().line();
    EXPECT_NEAR(set->area() / (16 * M_PI), 1, .01) << "some discs stick out of the grid about the mesh";
    const VoxelSet exact = areas_of_triangles(triangles);
    EXPECT_LE(difference(*set, exact).only_second, exact.voxels.size() / 100);
    EXPECT_LE(set->voxels.size(), exact.voxels.size() * 11 / 10);
    for (const OccupiedVoxel& voxel : set->voxels) {
        EXPECT_GT(glm::dot(glm::normalize(set->middle(voxel) - middle), glm::dvec3(voxel.normal)), .97);
        EXPECT_NEAR(voxel.albedo.x, .25f, 1e-4f);
    }
    for (Surfel& surfel : surfels) surfel.normal = glm::vec3(0);
    EXPECT_FALSE(voxels_of_surfels(surfels, 32, glm::dvec3(0)));
}

using RasterVoxels = OnDevice;

VoxelSet drawn(Device& device, const Mesh& mesh, uint32_t voxels, const RasterVoxelOptions& options) {
    auto set = rasterize_triangles(device, in_grid(mesh, voxels), options);
    EXPECT_TRUE(set) << set.error().line();
    return set ? std::move(*set) : VoxelSet{};
}

/// Returns the voxels that a grid's rays along each axis meet in triangles whose largest area they see: the
/// definition of what is drawn, on the host.
std::set<uint32_t> swept(const MeshTriangles& triangles) {
    const glm::ivec3 size = triangles.grid().size;
    std::set<uint32_t> cells;
    for (size_t i = 0; i < triangles.count(); ++i) {
        const GridTriangle t = triangles[i];
        const glm::dvec3 normal = t.cross();
        const int axis = dominant_axis(normal), u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::ivec3 cell;
        for (cell[u] = 0; cell[u] < size[u]; ++cell[u])
            for (cell[v] = 0; cell[v] < size[v]; ++cell[v]) {
                glm::dvec3 at(0.0);
                at[u] = cell[u] + .5, at[v] = cell[v] + .5;
                at[axis] = t.corners[0][axis] -
                           ((at[u] - t.corners[0][u]) * normal[u] + (at[v] - t.corners[0][v]) * normal[v]) /
                               normal[axis];
                bool inside = true;
                for (size_t k = 0; k < 3; ++k)
                    inside &= glm::dot(glm::cross(t.corners[(k + 1) % 3] - t.corners[k], at - t.corners[k]),
                                       normal) > 0;
                cell[axis] = std::clamp(static_cast<int>(std::floor(at[axis])), 0, size[axis] - 1);
                if (inside) cells.insert(triangles.grid().number(cell));
            }
    }
    return cells;
}

size_t unequal(const VoxelSet& set, const std::set<uint32_t>& cells) {
    std::set<uint32_t> drawn_cells;
    for (const OccupiedVoxel& voxel : set.voxels) drawn_cells.insert(voxel.cell);
    std::vector<uint32_t> odd;
    std::ranges::set_symmetric_difference(drawn_cells, cells, std::back_inserter(odd));
    return odd.size();
}

TEST_F(RasterVoxels, AreThoseThatTheSweepsMeetHoweverTrianglesAreSliced) {
    const Mesh ball = finished(sphere({3, 4, -5}, 2, 24)), soup = finished(meshes::soup(100, 5));
    for (const Mesh* mesh : {&ball, &soup}) {
        const auto truth = swept(in_grid(*mesh, 40));
        const VoxelSet cut = drawn(*device, *mesh, 40, {.slicing = Slicing::cut});
        const VoxelSet discard = drawn(*device, *mesh, 40, {.slicing = Slicing::discard});
        EXPECT_GT(truth.size(), 3000u);
        EXPECT_LE(unequal(cut, truth), truth.size() / 500);
        EXPECT_LE(unequal(discard, truth), truth.size() / 500);
        EXPECT_LE(difference(cut, discard).all(), truth.size() / 500) << "the aim: .2 % of the voxels";
    }
}

TEST_F(RasterVoxels, LieAmongThoseThatTrianglesMeetAndHaveTheirArea) {
    const Mesh mesh = finished(sphere({0, 0, 0}, 1, 32));
    const MeshTriangles triangles = in_grid(mesh, 32);
    const VoxelSet exact = areas_of_triangles(triangles);
    for (const Slicing slicing : {Slicing::cut, Slicing::discard}) {
        const VoxelSet set = drawn(*device, mesh, 32, {.slicing = slicing});
        EXPECT_LE(difference(set, exact).only_first, set.voxels.size() / 500);
        EXPECT_NEAR(set.area() / triangles.area(), 1, .02);
        for (const OccupiedVoxel& voxel : set.voxels) {
            const glm::dvec3 out = glm::normalize(set.middle(voxel));
            EXPECT_GT(glm::dot(out, glm::dvec3(voxel.normal)), .97);
            EXPECT_NEAR(voxel.albedo.x, .5f, .005f);
        }
    }
}

TEST_F(RasterVoxels, ABoxInTheBordersOfTheGridIsWhole) {
    for (const Slicing slicing : {Slicing::cut, Slicing::discard})
        for (const int voxels : {1, 2, 8}) {
            const VoxelSet set = drawn(*device, finished(box(glm::dvec3(1), glm::dvec3(3))),
                                       static_cast<uint32_t>(voxels), {.slicing = slicing});
            const int inner = std::max(0, voxels - 2);
            EXPECT_EQ(set.voxels.size(),
                      static_cast<size_t>(voxels * voxels * voxels - inner * inner * inner));
            EXPECT_NEAR(set.area(), 24, 1e-4);
        }
}

TEST_F(RasterVoxels, ALimitOnVerticesLeavesHolesAndNoLimitNone) {
    const Mesh mesh = finished(meshes::soup(40, 9));  // large triangles that span many slices
    for (const Slicing slicing : {Slicing::cut, Slicing::discard}) {
        const VoxelSet whole = drawn(*device, mesh, 64, {.slicing = slicing});
        size_t before = 0;
        for (const uint32_t vertices : {3u, 15u, 63u}) {
            const VoxelSet limited = drawn(*device, mesh, 64, {.slicing = slicing, .vertices = vertices});
            EXPECT_GT(limited.voxels.size(), before);
            EXPECT_LE(difference(limited, whole).only_first, whole.voxels.size() / 1000);
            before = limited.voxels.size();
        }
        EXPECT_LT(before, whole.voxels.size());
        EXPECT_LT(before, whole.voxels.size() * 99 / 100);
    }
}

TEST_F(RasterVoxels, HalfFloatsAndFewerAttributesGiveTheSameVoxels) {
    const Mesh mesh = finished(sphere({0, 0, 0}, 1, 32));
    const VoxelSet whole = drawn(*device, mesh, 32, {});
    for (const uint32_t bits : {16u, 32u})
        for (int kept = 0; kept < 4; ++kept) {
            const VoxelSet set = drawn(*device, mesh, 32,
                                       {.bits = bits, .albedo = (kept & 1) != 0, .normals = (kept & 2) != 0});
            ASSERT_EQ(difference(set, whole).all(), 0u);
            for (size_t i = 0; i < set.voxels.size(); ++i) {
                const OccupiedVoxel &a = set.voxels[i], &b = whole.voxels[i];
                EXPECT_NEAR(a.area, b.area, .005f * b.area);
                EXPECT_NEAR(glm::distance(a.albedo, kept & 1 ? b.albedo : glm::vec3(0)), 0, .005f);
                EXPECT_NEAR(glm::distance(a.normal, kept & 2 ? b.normal : glm::vec3(0)), 0, .02f);
            }
        }
}

TEST_F(RasterVoxels, TakeNoMoreMemoryThanTheyMay) {
    device->set_memory_cap(uint64_t{8} << 20);
    const Mesh mesh = finished(sphere({0, 0, 0}, 1, 8));
    const auto set = rasterize_triangles(*device, in_grid(mesh, 200));
    ASSERT_FALSE(set);
    EXPECT_EQ(set.error().what, "voxels");
}

}  // namespace
}  // namespace lucarne::gi::volume
