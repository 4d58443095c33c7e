// PCL's own estimator with its own search and with ours.
#include "tests/octree/normals/pcl_normals.h"

#include <cmath>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "octree/normals/neighbours/leaf_index.h"
#include "octree/normals/surface/plane.h"
#include "tests/octree/normals/virtual_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;
using Random = lucarne::Random;

TEST(PclNormals, AreTheSameOverOurSearch) {
    const float degree = std::cos(std::numbers::pi_v<float> / 180);
    for (const char* scene : {"nave", "statue"}) {
        const Scan scan = scan_of(scene, 100000);
        std::vector<glm::vec3> points;
        for (const auto& p : scan.cloud.points) points.emplace_back(p);
        points.insert(points.end(), points.begin(),
                      points.begin() + 100);  // duplicates are neighbours to PCL
        const auto a = pcl_normals(points, 16, NeighbourSearch::flann),
                   b = pcl_normals(points, 16, NeighbourSearch::leaf);
        ASSERT_EQ(a.size(), points.size());
        ASSERT_EQ(b.size(), points.size());
        size_t same = 0;
        for (size_t i = 0; i < a.size(); ++i) same += std::abs(glm::dot(a[i], b[i])) >= degree;
        std::printf("%s: %.5f of the normals within a degree\n", scene,
                    static_cast<double>(same) / static_cast<double>(a.size()));
        EXPECT_GT(static_cast<double>(same), 0.99 * static_cast<double>(a.size())) << scene;
    }
}

TEST(PclNormals, PlanesAreThePrincipalAxesOfTheirPoints) {
    Random random(9);
    for (const double thickness : {0.0, 1e-3, 0.1, 1.0}) {
        for (int round = 0; round < 200; ++round) {
            const glm::dvec3 n =
                glm::normalize(glm::dvec3(gaussian(random), gaussian(random), gaussian(random)));
            Patch patch;
            patch.make_room(17);
            for (int i = 0; i < 17; ++i) {
                const glm::dvec3 p(gaussian(random), gaussian(random), gaussian(random));
                patch.push_back(glm::vec3(p - (1 - thickness) * glm::dot(p, n) * n), 0);
            }
            patch.pad();
            const Plane plane = plane_of(moments_of(patch));
            glm::dmat3 covariance(0.0);
            glm::dvec3 mean(0.0);
            for (size_t i = 0; i < patch.count; ++i) mean += glm::dvec3(patch.offset(i)) / 17.0;
            for (size_t i = 0; i < patch.count; ++i) {
                const glm::dvec3 d = glm::dvec3(patch.offset(i)) - mean;
                covariance += glm::outerProduct(d, d) / 17.0;
            }
            const auto [least, middle, widest] = plane.variances;
            EXPECT_NEAR(glm::length(plane.normal), 1, 1e-12);
            EXPECT_LT(glm::length(covariance * plane.normal - least * plane.normal), 1e-5 * widest)
                << thickness;
            EXPECT_LE(least, middle);
            EXPECT_LE(middle, widest);
            EXPECT_NEAR(least + middle + widest, covariance[0][0] + covariance[1][1] + covariance[2][2],
                        1e-5 * widest);
            EXPECT_NEAR(least * middle * widest, glm::determinant(covariance),
                        1e-5 * widest * widest * widest);
        }
    }
}

TEST(PclNormals, LeavesFindTheNeighboursThatFlannFinds) {
    Random random(4);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 20000; ++i) {  // a dense cluster, a sheet, a few distant outliers
        const double scale = i % 100 == 0 ? 1e4 : i % 2 ? 1.0 : 1e-3;
        points.push_back(glm::dvec3(gaussian(random), gaussian(random), i % 3 ? 0.0 : gaussian(random)) *
                         scale);
    }
    PointArrays sorted;
    for (const uint32_t i : morton_order(points)) sorted.push_back(points[i]);
    const auto leaf = make_index(NeighbourSearch::leaf, sorted), flann = make_flann_index(sorted);
    for (size_t i = 0; i < sorted.size(); i += 37) {
        std::array<Neighbour, 20> a, b;
        ASSERT_EQ(leaf->merge_nearest(sorted[i], a, 0, 0), a.size());
        ASSERT_EQ(flann->merge_nearest(sorted[i], b, 0, 0), b.size());
        for (size_t k = 0; k < a.size(); ++k) EXPECT_DOUBLE_EQ(a[k].distance2, b[k].distance2);
        const double radius = std::sqrt(a[10].distance2) * (1 + 1e-6);
        Tile tile;
        tile.clear(sorted[i]);
        ASSERT_TRUE(leaf->gather({sorted[i], sorted[i]}, radius, 0, sorted.size(), tile));
        Patch patch;
        patch.take_within(tile, glm::vec3(0.0f), static_cast<float>(radius * radius));
        EXPECT_EQ(patch.count, 11u) << i;
    }
}

}  // namespace
}  // namespace lucarne::octree
