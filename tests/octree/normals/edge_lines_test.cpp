// Lines at creases: where discs at the edges of boxes end.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "octree/tree/footprint.h"
#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree {
namespace {

using testing::Cloud, testing::cube, testing::estimate, testing::Estimate;

constexpr size_t kBoxPoints = 60'000;
constexpr double kBoxSpacing = 0.01;  ///< of the cube's points: 6 m2 / 60000

/// A unit cube seen from above the middle of each face, or from its own middle.
struct Scanned {
    Cloud cloud;
    NormalOptions options;
};
Scanned scanned(double noise, bool inside) {
    Scanned made{cube(kBoxPoints, noise), {}};
    for (int face = 0; face < 6; ++face) {
        glm::dvec3 n(0.0);
        n[face / 2] = face % 2 ? 1 : -1;
        made.options.stations.push_back(glm::dvec3(0.5) + (inside ? 0.0 : 3.0) * n);
    }
    for (const glm::dvec3& n : made.cloud.normals)
        for (int face = 0; face < 6; ++face)
            if (n[face / 2] == (face % 2 ? 1 : -1)) made.cloud.stations.push_back(face);
    return made;
}

/// A point on a face of the cube near one of its edges.
struct NearEdge {
    size_t point = 0;
    glm::dvec3 outward{0.0};  ///< in the face, toward the edge
    double distance = 0;      ///< of the edge, m
    double along = 0;         ///< place along the edge, m
};
/// Returns the points whose discs may reach over an edge, but not those near a corner, which have two.
std::vector<NearEdge> near_edges(const Cloud& cloud) {
    std::vector<NearEdge> found;
    for (size_t i = 0; i < cloud.points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            if (cloud.normals[i][axis] != 0) continue;
            const double at = cloud.points[i][axis], distance = std::min(at, 1 - at);
            int other = 0;
            while (other == axis || cloud.normals[i][other] != 0) ++other;
            const double along = cloud.points[i][other];
            if (distance > 2 * kBoxSpacing || std::min(along, 1 - along) < 6 * kBoxSpacing) continue;
            glm::dvec3 outward(0.0);
            outward[axis] = at < 0.5 ? -1 : 1;
            found.push_back({i, outward, distance, along});
        }
    return found;
}

/// How far a disc reaches over an edge at a place along it, m; -1 where it does not reach the place.
double reach_at(const NearEdge& near, const Cloud& cloud, const Estimate& found, double along) {
    const double area = found.areas[near.point], radius = surfel_radius(static_cast<float>(area), 0);
    const double beside = along - near.along;
    if (std::abs(beside) >= radius) return -1;
    double reach = std::sqrt(radius * radius - beside * beside);
    const auto line = decode_edge(found.normals[near.point], found.edges[near.point].code);
    if (line) {
        // The point (reach, beside) of the face must not be beyond the line.
        glm::dvec3 other(0.0);
        for (int axis = 0; axis < 3; ++axis)
            if (near.outward[axis] == 0 && cloud.normals[near.point][axis] == 0) other[axis] = 1;
        const double across = glm::dot(glm::dvec3(line->toward), near.outward),
                     side = glm::dot(glm::dvec3(line->toward), other) * beside;
        const double distance = line->distance * std::sqrt(area);
        if (across > 0.1) reach = std::min(reach, (distance - side) / across);
    }
    return reach - near.distance;
}

/// The normals of the cube's faces with the directions in them toward their four edges.
std::vector<std::pair<glm::dvec3, glm::dvec3>> faces_at_edges() {
    std::vector<std::pair<glm::dvec3, glm::dvec3>> all;
    const auto along = [](int axis, int side) {
        glm::dvec3 direction(0.0);
        direction[axis] = side ? 1 : -1;
        return direction;
    };
    for (int face = 0; face < 3; ++face)
        for (int axis = 0; axis < 3; ++axis)
            for (int sides = 0; axis != face && sides < 4; ++sides)
                all.emplace_back(along(face, sides % 2), along(axis, sides / 2));
    return all;
}

/// Shares of the outline of a cube: what discs reach to a quarter of a spacing, and what none of them
/// reaches.
struct Outline {
    double right = 0, short_of_it = 0;
};
Outline outline_of(const std::vector<NearEdge>& near, const Cloud& cloud, const Estimate& found) {
    // Each of the 12 edges is seen from both of its faces: the gap of a single disc is a small share of all.
    constexpr int kPlacesAnEdge = 500, kOutlinePlaces = 24 * kPlacesAnEdge;
    int right = 0, short_of_it = 0;
    for (const auto& [normal, outward] : faces_at_edges()) {
        std::vector<NearEdge> one;
        for (const NearEdge& n : near) {
            const bool parallel = glm::dot(cloud.normals[n.point], normal) == 1;
            if (parallel && n.outward == outward) one.push_back(n);
        }
        for (int i = 0; i < kPlacesAnEdge; ++i) {
            const double along = 0.1 + 0.8 * i / kPlacesAnEdge;
            double reach = -1;
            for (const NearEdge& n : one) reach = std::max(reach, reach_at(n, cloud, found, along));
            right += std::abs(reach) < 0.25 * kBoxSpacing;
            short_of_it += reach < -0.1 * kBoxSpacing;
        }
    }
    return {static_cast<double>(right) / kOutlinePlaces, static_cast<double>(short_of_it) / kOutlinePlaces};
}

TEST(EdgeLines, MostOfABoxsOutlineIsRightToAQuarterOfASpacing) {
    // What is missing are discs whose planes lie across the edge, which no line of their neighbours fits.
    // Noise turns the planes, so that some discs end before the edge.
    struct Limits {
        double noise, right, short_of_it;
    };
    constexpr Limits kLimits[] = {{0.0, 0.95, 0.005}, {0.1, 0.72, 0.025}, {0.2, 0.48, 0.04}};
    for (const auto& [noise, least, most_short] : kLimits) {
        const auto [cloud, options] = scanned(noise * kBoxSpacing, false);
        const Estimate found = estimate(cloud, options);
        const auto near = near_edges(cloud);
        const Outline outline = outline_of(near, cloud, found);
        size_t rising = 0, lined = 0;
        for (const NearEdge& n : near)
            if (found.edges[n.point].code != kNoEdge && found.normals[n.point] != glm::vec3(0.0f))
                ++lined, rising += found.edges[n.point].beyond == Beyond::rises;
        std::printf(
            "noise of %.1f spacings: %.1f %% of the outline right, %.2f %% short of the edge; %.1f %% of the "
            "points at edges have lines, %.2f %% of these are taken for corners\n",
            noise, 100.0 * outline.right, 100.0 * outline.short_of_it,
            100.0 * static_cast<double>(lined) / static_cast<double>(near.size()),
            100.0 * static_cast<double>(rising) / static_cast<double>(lined));
        EXPECT_GE(outline.right, least) << noise;
        EXPECT_GE(lined, 9 * near.size() / 10) << noise;
        EXPECT_LE(outline.short_of_it, most_short) << noise;
        EXPECT_LE(rising, 0.01 * static_cast<double>(lined)) << noise;
    }
}

/// The points next to a right-angled edge have a side that turns by 45 degrees from the whole neighbourhood.
TEST(EdgeLines, ScansWithoutStationsHaveThem) {
    for (const bool stated : {false, true}) {
        const Cloud box = cube(kBoxPoints, 0);
        NormalOptions options;
        options.normals = !stated;
        const Estimate found = estimate(box, options);
        const Outline outline = outline_of(near_edges(box), box, found);
        std::printf("%s normals: %.1f %% of the outline right, %.2f %% short of the edge\n",
                    stated ? "stated" : "estimated", 100 * outline.right, 100 * outline.short_of_it);
        EXPECT_GE(outline.right, stated ? 0.95 : 0.93) << stated;
        EXPECT_LE(outline.short_of_it, 0.005) << stated;
    }
}

/// How far the discs at the four upper corners of the cube reach over its faces, m: the mean over their
/// points.
double reach_over_corners(const Cloud& cloud, const Estimate& found) {
    double sum = 0;
    size_t points = 0;
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        const glm::dvec3 to_face = glm::min(cloud.points[i], 1.0 - cloud.points[i]);
        if (std::max({to_face.x, to_face.y, 1 - cloud.points[i].z}) > 2 * kBoxSpacing) continue;
        const double radius = surfel_radius(found.areas[i], 0), unit = std::sqrt(double{found.areas[i]});
        const auto line = decode_edge(found.normals[i], found.edges[i].code);
        const glm::dvec3 n(found.normals[i]), u = glm::normalize(glm::cross(n, glm::dvec3(.31, .52, .8))),
                                              v = glm::cross(n, u);
        double most = 0;
        for (int ring = 1; ring <= 8; ++ring)
            for (int step = 0; step < 32; ++step) {
                const double turn = step * 2 * std::numbers::pi / 32, r = radius * ring / 8;
                const glm::dvec3 offset = r * (std::cos(turn) * u + std::sin(turn) * v);
                if (line && glm::dot(glm::dvec3(line->toward), offset) > line->distance * unit) continue;
                const glm::dvec3 p = cloud.points[i] + offset, over = glm::max(-p, p - 1.0);
                most = std::max({most, over.x, over.y, over.z});
            }
        sum += most;
        ++points;
    }
    return sum / static_cast<double>(points);
}

/// A cube without its bottom, which is known to be seen from outside.
TEST(EdgeLines, DiscsAtCornersAreNarrowWithoutStationsToo) {
    const auto [box, options] = scanned(0, false);
    Cloud open;
    for (size_t i = 0; i < box.points.size(); ++i) {
        if (box.normals[i].z < 0) continue;
        open.points.push_back(box.points[i]);
        open.normals.push_back(box.normals[i]);
        open.stations.push_back(box.stations[i]);
    }
    const double with = reach_over_corners(open, estimate(open, options)),
                 without = reach_over_corners(open, estimate(open));
    std::printf("at corners discs reach %.4f m over the faces with stations, %.4f m without\n", with,
                without);
    EXPECT_LT(without, 1.45 * with);
}

TEST(EdgeLines, CornersOfARoomAreToldFromEdges) {
    const auto [cloud, options] = scanned(0.1 * kBoxSpacing, true);
    const Estimate found = estimate(cloud, options);
    size_t lined = 0, outer = 0;
    for (size_t i = 0; i < cloud.points.size(); ++i)
        if (found.edges[i].code != kNoEdge) ++lined, outer += found.edges[i].beyond != Beyond::rises;
    EXPECT_GT(lined, kBoxPoints / 20);
    EXPECT_LE(outer, lined / 50);
}

/// Cells at edges end where the planes meet, not half-way to the points beyond.
TEST(EdgeLines, AreasOfPointsAtEdgesAddUpToTheSurface) {
    const auto [cloud, options] = scanned(0.1 * kBoxSpacing, false);
    const Estimate found = estimate(cloud, options);
    double all = 0, rim = 0, corners = 0;
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        all += found.areas[i];
        std::array<double, 3> to_face;
        for (int axis = 0; axis < 3; ++axis)
            to_face[static_cast<size_t>(axis)] =
                cloud.normals[i][axis] != 0 ? 0 : std::min(cloud.points[i][axis], 1 - cloud.points[i][axis]);
        std::sort(to_face.begin(), to_face.end());
        if (to_face[1] >= 2 * kBoxSpacing) continue;
        (to_face[2] < 4 * kBoxSpacing ? corners : rim) += found.areas[i];
    }
    std::printf("shares: %.4f of 6 m2, at edges %.4f, at corners %.4f\n", all, rim, corners);
    EXPECT_NEAR(all, 6, 0.06);
    const double strips = 24 * 2 * kBoxSpacing * (1 - 8 * kBoxSpacing);
    EXPECT_NEAR(rim, strips, 0.08 * strips);
    EXPECT_GT(corners, 0);
}

/// Counts the points with lines, without those within three spacings of a unit square's border.
size_t lined_inside(const Cloud& cloud, double spacing) {
    const Estimate found = estimate(cloud);
    size_t lined = 0;
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        const glm::dvec3 p = glm::abs(cloud.points[i] - 0.5);
        if (std::max(p.x, p.y) < 0.5 - 3 * spacing) lined += found.edges[i].code != kNoEdge;
    }
    return lined;
}

TEST(EdgeLines, SmoothAndNoisySurfacesHaveNone) {
    const Estimate round = estimate(testing::sphere(20'000));
    EXPECT_LE(std::ranges::count_if(round.edges, [](const PointEdge& e) { return e.code != kNoEdge; }), 20);
    for (const double noise : {0.1, 0.5, 1.0})
        EXPECT_LE(lined_inside(testing::plane(20'000, noise * 0.007), 0.007), 100) << noise;
}

TEST(EdgeLines, NarrowHolesKeepWholeDiscsAndWideOnesEndAtTheirBorder) {
    for (const double half : {0.02, 0.2}) {  // 6 and 57 spacings wide
        Cloud cloud = testing::plane(20'000);
        std::erase_if(cloud.points, [&](const auto& p) { return std::abs(p.x - 0.5) < half; });
        cloud.normals.resize(cloud.points.size());
        const Estimate found = estimate(cloud);
        size_t beside = 0, lined = 0, wrong = 0;
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            const glm::dvec3& p = cloud.points[i];
            const double away = std::abs(p.x - 0.5) - half;
            if (away > 0.007 || std::abs(p.y - 0.5) > 0.47) continue;
            ++beside;
            const auto line = decode_edge(found.normals[i], found.edges[i].code);
            if (!line) continue;
            ++lined;
            const double reach = line->distance * std::sqrt(double{found.areas[i]}) - away;
            wrong += line->toward.x * (p.x < 0.5 ? 1 : -1) < 0.7 || std::abs(reach) > 0.007;
        }
        if (half > 0.1) {
            EXPECT_GE(lined, beside * 7 / 10) << beside;
            EXPECT_LE(wrong, lined / 10);
        } else {
            EXPECT_LE(lined, beside / 10) << "discs close it as far as they reach";
        }
    }
}

/// The floor crosses the plane of a board that hangs above it, but does not continue the board.
TEST(EdgeLines, BoardsOverAFloorEndAtTheirBorder) {
    constexpr double kSpacing = 0.007, kGap = 6 * kSpacing;
    for (const bool both_sides : {true, false}) {
        Cloud cloud = testing::plane(20'000);  // z = 0
        if (!both_sides) std::erase_if(cloud.points, [](const auto& p) { return p.x > 0.5; });
        const size_t floor = cloud.points.size();
        for (const glm::dvec3& p : testing::plane(20'000).points)
            cloud.points.push_back({0.5, p.y, p.x + kGap});
        cloud.normals.resize(cloud.points.size());
        const Estimate found = estimate(cloud);
        size_t beside = 0, lined = 0, wrong = 0;
        for (size_t i = floor; i < cloud.points.size(); ++i) {
            const glm::dvec3& p = cloud.points[i];
            const double away = p.z - kGap;
            if (away > kSpacing || std::abs(p.y - 0.5) > 0.47) continue;
            ++beside;
            const auto line = decode_edge(found.normals[i], found.edges[i].code);
            if (!line) continue;
            ++lined;
            const double reach = line->distance * std::sqrt(double{found.areas[i]}) - away;
            wrong += line->toward.z > -0.7 || std::abs(reach) > kSpacing;
        }
        EXPECT_GE(lined, beside * 7 / 10) << both_sides << " " << beside;
        EXPECT_LE(wrong, lined / 10);
    }
}

TEST(EdgeLines, OfAWireMeshAndOfStackedPointsAreFinite) {
    Random random(8);
    Cloud wires, stacked;
    for (int i = 0; i < 20'000; ++i) {  // wires of a grid, 1 mm thick, 2 cm apart
        glm::dvec3 p(0.02 * std::floor(50 * random.uniform()), random.uniform(), 0.001 * random.uniform());
        if (i % 2) std::swap(p.x, p.y);
        wires.points.push_back(p + 0.001 * random.uniform());
        stacked.points.push_back(i < 10'000 ? glm::dvec3(1, 2, 3) : p);
    }
    for (Cloud* cloud : {&wires, &stacked}) {
        cloud->normals.resize(cloud->points.size());
        const Estimate found = estimate(*cloud);
        for (size_t i = 0; i < cloud->points.size(); ++i) {
            const auto line = decode_edge(found.normals[i], found.edges[i].code);
            if (line) {
                ASSERT_NEAR(glm::length(line->toward), 1, 1e-4);
            }
        }
    }
}

}  // namespace
}  // namespace lucarne::octree
