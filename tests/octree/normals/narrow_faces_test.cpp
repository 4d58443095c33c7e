// Faces that are narrower than the window around a point: edges of boards, two faces of a thin board.
#include <cmath>
#include <cstdio>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "octree/tree/footprint.h"
#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree {
namespace {

using namespace testing;

constexpr double kSpacing = 0.015, kThick = 0.04, kNoise = 0.0005;

/// A board that stands upright, as the back of a bench: x from 0 to 1.2 m, y from 0 to kThick, z up to 0.
struct Board {
    Cloud cloud;
    NormalOptions options;
    size_t top = 0;  ///< the first point of its upper edge
};

Board upright_board() {
    Random random(21);
    Board board;
    board.options.stations = {{0.6, -3, 1}, {0.6, 3, 1}};
    const auto add = [&](size_t count, const glm::dvec3& n, int station, const auto& place) {
        for (size_t i = 0; i < count; ++i) {
            board.cloud.points.push_back(place() + n * (kNoise * gaussian(random)));
            board.cloud.normals.push_back(n);
            board.cloud.stations.push_back(station);
        }
    };
    const auto count = static_cast<size_t>(1.2 * 0.4 / (kSpacing * kSpacing));
    for (const int face : {0, 1})
        add(count, {0, face ? 1 : -1, 0}, face,
            [&] { return glm::dvec3(1.2 * random.uniform(), face ? kThick : 0, -0.4 * random.uniform()); });
    board.top = board.cloud.points.size();
    for (const int station : {0, 1})
        add(static_cast<size_t>(1.2 * kThick / (kSpacing * kSpacing) / 2), {0, 0, 1}, station,
            [&] { return glm::dvec3(1.2 * random.uniform(), kThick * random.uniform(), 0); });
    return board;
}

/// Whether a place is far from the ends of the board.
bool is_inside(const glm::dvec3& p) {
    return p.x > 6 * kSpacing && p.x < 1.2 - 6 * kSpacing;
}

/// Without a plane, or with one across the edge, these points were bright dashes along the tops of benches.
/// Those at its rim lie in a face, too, as far as noise tells. If their station is behind that face, they are
/// the edge's: with the face's plane, seen from behind, they were half-moons above it.
TEST(NarrowFaces, TheEdgeOfABoardHasItsNormal) {
    const auto [cloud, options, top] = upright_board();
    const Estimate found = estimate(cloud, options);
    size_t points = 0, right = 0, at_rim = 0, of_face = 0;
    for (size_t i = top; i < cloud.points.size(); ++i) {
        const glm::dvec3& p = cloud.points[i];
        if (!is_inside(p)) continue;
        constexpr double kRim = 8 * kNoise;
        const bool front = p.y<kRim, back = p.y> kThick - kRim;
        if (!front && !back) {
            ++points;
            right += found.normals[i].z > std::cos(10 * M_PI / 180);
        } else if ((cloud.stations[i] == 1) == front) {
            ++at_rim;
            of_face += std::abs(found.normals[i].y) > 0.9f;
        }
    }
    std::printf("%zu of %zu points of the edge have its normal, %zu of %zu at its rim that of a face\n",
                right, points, of_face, at_rim);
    EXPECT_GE(right, points * 7 / 10) << "a quarter without planes through three points";
    EXPECT_GE(at_rim, 10u);
    EXPECT_LE(of_face, at_rim / 4) << "half of them, if stations are not asked";
}

/// The faces beside the edge end where it begins: their discs do not stand over it.
TEST(NarrowFaces, TheFacesOfABoardEndAtItsEdge) {
    const auto [cloud, options, top] = upright_board();
    const Estimate found = estimate(cloud, options);
    size_t discs = 0, over = 0;
    for (size_t i = 0; i < top; ++i) {
        const glm::dvec3& p = cloud.points[i];
        const double area = found.areas[i], radius = surfel_radius(found.areas[i], 0);
        if (!is_inside(p) || found.normals[i] == glm::vec3(0.0f) || p.z + radius < 0) continue;
        double reach = radius;
        if (const auto line = decode_edge(found.normals[i], found.edges[i].code))
            if (line->toward.z > 0.7)
                reach = std::min(reach, line->distance * std::sqrt(area) / line->toward.z);
        ++discs;
        over += p.z + reach * std::sqrt(1 - double{found.normals[i].z} * found.normals[i].z) > kSpacing / 2;
    }
    std::printf("%zu of %zu discs that reach the edge stand over it\n", over, discs);
    EXPECT_GE(discs, 100u);
    EXPECT_LE(over, discs / 10);
}

/// Vertical profiles of a scanner that are farther apart than the board is thick. The nearest points of
/// another profile belong to the other face.
TEST(NarrowFaces, ProfilesFartherApartThanTheBoardIsThickKeepTheirFace) {
    Random random(22);
    Cloud cloud;
    NormalOptions options;
    options.stations = {{-3, 0, 0}, {3, 0, 0}};
    for (int profile = 0; profile < 20; ++profile)
        for (int i = 0; i < 120; ++i)
            cloud.points.emplace_back(kNoise * gaussian(random),
                                      0.065 * profile + 0.018 * (i % 2) + 0.002 * gaussian(random),
                                      0.012 * i + 0.004 * random.uniform());
    const size_t profiles = cloud.points.size();
    cloud.stations.assign(profiles, 0);
    for (int i = 0; i < 6000; ++i)
        cloud.points.emplace_back(0.05 + kNoise * gaussian(random), 1.3 * random.uniform(),
                                  1.44 * random.uniform());
    cloud.stations.resize(cloud.points.size(), 1);
    cloud.normals.resize(cloud.points.size());
    const Estimate found = estimate(cloud, options);
    size_t points = 0, right = 0;
    for (size_t i = 0; i < profiles; ++i) {
        const glm::dvec3& p = cloud.points[i];
        if (p.y < 0.1 || p.y > 1.2 || p.z < 0.1 || p.z > 1.3) continue;
        ++points;
        right += found.normals[i].x < -std::cos(15 * M_PI / 180);
    }
    std::printf("%zu of %zu points of the profiles have the normal of their face\n", right, points);
    EXPECT_GE(right, points * 9 / 10);
}

}  // namespace
}  // namespace lucarne::octree
