#include "octree/normals/normals.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree {
namespace {

using namespace testing;
using Random = lucarne::Random;

constexpr double kPi = std::numbers::pi;

void print(const char* name, const Score& s, double area) {
    std::printf("%-40s angle %.3f deg, oriented %.4f, marked %.4f, area %.4f of the truth\n", name, s.angle,
                s.oriented, s.marked, s.area / area);
}

/// Outliers as photogrammetry leaves them: groups of a few points, far from the body and from each other.
TEST(Normals, CrumbsInTheAirHaveNoDiscAsWideAsTheirDistance) {
    Cloud cloud = sphere(100000);
    const size_t body = cloud.points.size();
    Random random(5);
    const auto crumb = [&](const glm::dvec3& at, size_t count) {
        for (size_t i = 0; i < count; ++i) {
            cloud.points.push_back(at +
                                   0.005 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()));
            cloud.normals.push_back({0, 0, 1});
        }
    };
    crumb({2.0, 0.0, 0.1}, 3);
    crumb({1.8, 0.3, 0.0}, 5);
    crumb({0, 2.5, 0}, 1);
    crumb({0, -1.5, 0}, 2);
    const Estimate found = estimate(cloud);
    for (size_t i = body; i < cloud.points.size(); ++i) EXPECT_LT(found.areas[i], 0.01) << i - body;
}

TEST(Normals, PlaneSphereAndCubeHaveTheirNormalsAndAreas) {
    const struct {
        const char* name;
        Cloud cloud;
        double area, angle;
    } cases[] = {{"plane, 20k points", plane(20000), 1, 0.01},
                 {"sphere, 20k points", sphere(20000), 4 * kPi, 0.6},
                 {"cube, 60k points", cube(60000), 6, 3.0}};
    for (const auto& c : cases) {
        const Score s = score(c.cloud, estimate(c.cloud));
        print(c.name, s, c.area);
        EXPECT_LT(s.angle, c.angle) << c.name;
        EXPECT_LT(s.marked, 0.001) << c.name;
        EXPECT_NEAR(s.area / c.area, 1, 0.04) << c.name;
    }
}

TEST(Normals, NoiseUpToTheSpacingLeavesNormalsAndAreas) {
    constexpr size_t kPoints = 20000;
    const struct {
        double noise, angle, area;  // noise over spacing, degrees, share
    } cases[] = {{0.1, 2.2, 0.06}, {0.3, 2.0, 0.06}, {0.5, 3.0, 0.06}, {1.0, 6.0, 0.15}};
    for (const auto& c : cases) {
        const Cloud cloud = plane(kPoints, c.noise / std::sqrt(double{kPoints}));
        const Score s = score(cloud, estimate(cloud));
        print(fmt::format("plane, noise {} of the spacing", c.noise).c_str(), s, 1);
        EXPECT_LT(s.angle, c.angle) << c.noise;
        EXPECT_LT(s.marked, 0.005) << c.noise;
        EXPECT_NEAR(s.area, 1, c.area) << c.noise;
    }
}

TEST(Normals, BlobsAndLinesAreMarkedInsteadOfInvented) {
    Random random(3);
    Cloud blob, line;
    for (int i = 0; i < 10000; ++i) {
        blob.points.push_back({random.uniform(), random.uniform(), random.uniform()});
        line.points.push_back(glm::dvec3(random.uniform()) * glm::dvec3(3, 2, 1));
    }
    blob.normals = line.normals = std::vector<glm::dvec3>(10000, glm::dvec3(0, 0, 1));
    EXPECT_GT(score(blob, estimate(blob)).marked, 0.7);
    EXPECT_EQ(score(line, estimate(line)).marked, 1);
}

TEST(Normals, BothFacesOfAThinWallKeepTheirArea) {
    constexpr size_t kPoints = 20000;
    for (const double gap : {1.0, 3.0, 5.0}) {  // in spacings
        Cloud wall = plane(kPoints, 0, 1);
        append(wall, plane(kPoints, 0, 2), {0, 0, gap / std::sqrt(double{kPoints})});
        const Score s = score(wall, estimate(wall));
        print(fmt::format("two planes {} spacings apart", gap).c_str(), s, 2);
        EXPECT_NEAR(s.area, 2, gap < 3 ? 0.25 : 0.08) << gap;
        EXPECT_LT(s.angle, 2) << gap;
    }
}

TEST(Normals, DuplicatesShareTheirAreaAndKeepTheirPlane) {
    Cloud cloud = plane(3000);
    const double area = score(cloud, estimate(cloud)).area;
    const size_t distinct = cloud.points.size();
    for (size_t i = 0; i < distinct; i += 100)  // 30 places with 1000 points each
        for (int copy = 1; copy < 1000; ++copy) {
            cloud.points.push_back(cloud.points[i]);
            cloud.normals.push_back(cloud.normals[i]);
        }
    const Estimate result = estimate(cloud, {}, 3);
    const Score s = score(cloud, result);
    EXPECT_NEAR(s.area, area, 1e-4);
    EXPECT_EQ(s.marked, 0);
    EXPECT_LT(result.areas[0], 2 * result.areas[1] / 100);

    Cloud one;
    one.points.assign(5000, glm::dvec3(1e6, 2e6, 3));
    one.normals.assign(5000, glm::dvec3(0, 0, 1));
    const Score single = score(one, estimate(one));
    EXPECT_EQ(single.marked, 1);
    EXPECT_EQ(single.area, 0);
}

TEST(Normals, TinyCloudsGiveWhatTheyCan) {
    for (size_t count = 0; count < 20; ++count) {
        const Cloud cloud = plane(count);
        const Score s = score(cloud, estimate(cloud));
        if (count < 4) {
            EXPECT_EQ(s.marked, 1) << count;
        }
        if (count >= 8) {
            EXPECT_LT(s.marked, 0.5) << count;
        }
        EXPECT_TRUE(std::isfinite(s.area));
    }
}

TEST(Normals, AnIsolatedPointIsMarkedAndDoesNotLoadTheWorld) {
    Cloud cloud = plane(20000);
    cloud.points.push_back({0.5, 0.5, 3.0});  // an outlier above the roof
    cloud.points.push_back({100e3, 0, 0});
    cloud.normals.resize(cloud.points.size(), glm::dvec3(0, 0, 1));
    for (const uint32_t parts : {1u, 4u}) {
        const Estimate result = estimate(cloud, {}, parts);
        for (const size_t lone : {20000u, 20001u}) {
            EXPECT_EQ(result.normals[lone], glm::vec3(0.0f));
            // The neighbours' area, not that of the empty space around it.
            EXPECT_LT(result.areas[lone], 0.01);
        }
        EXPECT_NEAR(score(cloud, result).area, 1, 0.04);
    }
}

TEST(Normals, CloudsOfAnyExtentHaveTheSameNormals) {
    const Cloud cloud = sphere(5000, 0.005);
    const Estimate usual = estimate(cloud, {}, 2);
    for (const double size : {1e-290, 1e-154, 1e-30, 1e-19, 1e19, 1e20, 1e30, 1e38, 1e150, 1e300}) {
        Cloud scaled = cloud;
        for (auto& p : scaled.points) p *= size;
        for (const auto search : {NeighbourSearch::leaf, NeighbourSearch::flann}) {
            NormalOptions options;
            options.search = search;
            options.area_unit = size;
            const Estimate found = estimate(scaled, options, 2);
            double worst = 1;
            size_t marked = 0;
            for (size_t i = 0; i < cloud.points.size(); ++i) {
                marked += found.normals[i] == glm::vec3(0.0f) && usual.normals[i] != glm::vec3(0.0f);
                if (found.normals[i] != glm::vec3(0.0f) && usual.normals[i] != glm::vec3(0.0f))
                    worst = std::min(worst, double{glm::dot(found.normals[i], usual.normals[i])});
            }
            EXPECT_GT(worst, 0.999) << size;
            EXPECT_LT(marked, 5u) << size;
            EXPECT_NEAR(score(scaled, found).area, 4 * kPi, 0.5) << size;
        }
    }
}

TEST(Normals, AStrayAtAnyDistanceLeavesTheOthersTheirNormals) {
    for (const double distance : {1e15, 1e20, 1e30}) {
        Cloud cloud = sphere(5000);
        cloud.points.push_back(glm::dvec3(distance));
        cloud.normals.push_back({0, 0, 1});
        const Estimate found = estimate(cloud);
        EXPECT_EQ(found.normals.back(), glm::vec3(0.0f)) << distance;
        const Score s = score(cloud, found);
        EXPECT_LT(s.marked, 0.01) << distance;
        EXPECT_LT(s.angle, 3) << distance;
    }
}

TEST(Normals, PlacesTooNearToEachOtherForTheExtentEndWithoutNormals) {
    for (const uint32_t parts : {1u, 4u}) {
        Cloud cloud;  // a cluster of 10^-40 of the extent
        for (const glm::dvec3& p : plane(3000).points) cloud.points.push_back(1e-40 * p);
        cloud.points.push_back(glm::dvec3(1.0));
        cloud.normals.resize(cloud.points.size(), glm::dvec3(0, 0, 1));
        const Estimate found = estimate(cloud, {}, parts);
        for (const float area : found.areas) EXPECT_TRUE(area >= 0 && std::isfinite(area));
    }
}

TEST(Normals, CoordinatesThatAreNoNumbersAreRefused) {
    for (const double bad : {static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
        Cloud cloud = plane(100);
        const MemoryChunks chunks(cloud, 1);
        cloud.points[50].y = bad;
        const auto found =
            estimate_normals(chunks, {}, [](size_t, ChunkNormals&&) { return Result<void>(); });
        ASSERT_FALSE(found);
        EXPECT_NE(found.error().line().find("not a finite number"), std::string::npos);
    }
}

/// The share of points whose result differs from that of the undivided cloud.
double changed(const Estimate& a, const Estimate& b) {
    size_t different = 0;
    for (size_t i = 0; i < a.normals.size(); ++i)
        different += a.normals[i] != b.normals[i] || a.areas[i] != b.areas[i];
    return static_cast<double>(different) / static_cast<double>(a.normals.size());
}

/// The same, with a tolerance for rounding: offsets are rounded to floats relative to each chunk's leaves.
double changed_visibly(const Estimate& a, const Estimate& b) {
    size_t different = 0;
    for (size_t i = 0; i < a.normals.size(); ++i)
        different += glm::length(a.normals[i] - b.normals[i]) > 1e-3f ||
                     std::abs(a.areas[i] - b.areas[i]) > 1e-3f * std::max(a.areas[i], b.areas[i]);
    return static_cast<double>(different) / static_cast<double>(a.normals.size());
}

TEST(Normals, ChunkBordersDoNotShow) {
    const double noise = 0.3 * std::sqrt(4 * kPi / 30000);
    Cloud cloud = sphere(30000, noise);
    append(cloud, cube(3000), {3, 0, 0}, 0.3);
    const Estimate whole = estimate(cloud, {}, 1);
    for (const uint32_t parts : {2u, 3u, 4u, 7u}) {
        NormalOptions options;
        options.memory = 20 << 20;  // several waves, and a cache too small for all chunks
        const double share = changed_visibly(whole, estimate(cloud, options, parts));
        std::printf("%u chunks: %.5f of the points differ from one chunk\n", parts * parts * parts, share);
        EXPECT_LT(share, 1e-3) << parts;
    }
}

TEST(Normals, PclOverFlannGivesTheSame) {
    const double noise = 0.3 * std::sqrt(4 * kPi / 30000);
    Cloud cloud = sphere(30000, noise);
    append(cloud, cube(9000), {3, 0, 0}, 0.3);
    const Estimate leaf = estimate(cloud);
    NormalOptions options;
    options.search = NeighbourSearch::flann;
    for (const uint32_t parts : {1u, 3u}) {
        const double share = changed_visibly(leaf, estimate(cloud, options, parts));
        std::printf("%u chunks: %.5f of the points differ from those by FLANN\n", parts * parts * parts,
                    share);
        EXPECT_LT(share, 1e-3);
    }
}

TEST(Normals, ProjectedCoordinatesLoseNothing) {
    const Cloud near = sphere(20000);
    Cloud far = near;
    for (auto& p : far.points) p += glm::dvec3(4512345.0, 5412345.0, 300.0);
    const Estimate a = estimate(near), b = estimate(far);
    double worst = 0;
    for (size_t i = 0; i < near.points.size(); ++i)
        worst = std::max(worst,
                         std::acos(std::min(1.0, static_cast<double>(glm::dot(a.normals[i], b.normals[i])))));
    EXPECT_LT(worst, 0.002);
}

TEST(Normals, ThreadsAndMemoryDoNotChangeTheResult) {
    Cloud cloud = sphere(20000, 0.01);
    append(cloud, plane(20000, 0.001), {-0.5, -0.5, 2});
    NormalOptions options;
    options.threads = 1;
    const Estimate one = estimate(cloud, options, 3);
    for (const unsigned threads : {2u, 4u})
        for (const uint64_t memory : {uint64_t{1} << 20, uint64_t{1} << 30}) {
            options.threads = threads;
            options.memory = memory;
            EXPECT_EQ(changed(one, estimate(cloud, options, 3)), 0) << threads << " " << memory;
        }
}

TEST(Normals, AreasAloneNeedNoOrientation) {
    const Cloud cloud = plane(5000);
    NormalOptions options;
    options.normals = false;
    const Score s = score(cloud, estimate(cloud, options, 2));
    EXPECT_LT(s.angle, 1) << "for lines at edges; whichever side they face";
    EXPECT_NEAR(s.area, 1, 0.06);
}

TEST(Normals, ReportsBadArgumentsCoordinatesAndReadErrors) {
    const auto ignore = [](size_t, ChunkNormals&&) -> Result<void> { return {}; };
    Cloud cloud = plane(100);
    NormalOptions options;
    options.neighbours = 2;
    EXPECT_EQ(estimate_normals(MemoryChunks(cloud, 1), options, ignore).error().kind, ErrorKind::arguments);
    const MemoryChunks chunks(cloud, 1);
    cloud.points[7].x = NAN;
    EXPECT_EQ(estimate_normals(chunks, {}, ignore).error().kind, ErrorKind::input_rejected);
    cloud.points[7].x = 0;
    const auto full = [](size_t, ChunkNormals&&) -> Result<void> { return failed("x.luc", "disk full"); };
    EXPECT_EQ(estimate_normals(MemoryChunks(cloud, 1), {}, full).error().why, "disk full");

    class Unreadable final : public ChunkAccess {
     public:
        explicit Unreadable(const Cloud& c) : chunks_(c, 2) {}
        size_t chunk_count() const override { return 8; }
        Box bounds(size_t chunk) const override { return chunks_.bounds(chunk); }
        uint64_t point_count(size_t chunk) const override { return chunks_.point_count(chunk); }
        Result<std::vector<glm::dvec3>> positions(size_t chunk) const override {
            if (chunk == 1) return failed("scratch", "truncated");
            return chunks_.positions(chunk);
        }
        Result<std::vector<int32_t>> stations(size_t chunk) const override { return chunks_.stations(chunk); }

     private:
        MemoryChunks chunks_;
    };
    EXPECT_EQ(estimate_normals(Unreadable(cloud), {}, ignore).error().why, "truncated");
}

}  // namespace
}  // namespace lucarne::octree
