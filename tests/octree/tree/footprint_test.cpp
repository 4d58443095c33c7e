#include "octree/tree/footprint.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/tree/area_floor.h"
#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree {
namespace {

using namespace testing;
using Random = lucarne::Random;

struct Disc {
    glm::dvec3 centre, normal;
    double radius;
};

/// The share of parallel rays that pass between the discs of a sheet about z = 0, inside a margin of the unit
/// square. `slant` is the tangent of the angle between the rays and the sheet's normal.
double leak_share(const std::vector<Disc>& discs, double slant = 0) {
    constexpr int kRays = 600;
    std::vector<bool> hit(kRays * kRays);
    const glm::dvec3 ray(slant, 0, -1);
    const auto cell = [](double v) {
        return static_cast<int>(std::clamp(v * kRays + 0.5, 0.0, 1.0 * kRays));
    };
    for (const Disc& disc : discs) {
        // The position of the disc's shadow on z = 0. The shadow reaches no farther than that of the sphere
        // around the disc.
        const glm::dvec3 foot = disc.centre + ray * disc.centre.z;
        const double reach = disc.radius * std::sqrt(1 + slant * slant), across = glm::dot(disc.normal, ray);
        for (int y = cell(foot.y - disc.radius); y < cell(foot.y + disc.radius); ++y)
            for (int x = cell(foot.x - reach); x < cell(foot.x + reach); ++x) {
                const glm::dvec3 offset = glm::dvec3((x + 0.5) / kRays, (y + 0.5) / kRays, 0) - disc.centre;
                const glm::dvec3 at = offset - ray * (glm::dot(disc.normal, offset) / across);
                if (glm::dot(at, at) <= disc.radius * disc.radius)
                    hit[static_cast<size_t>(y * kRays + x)] = true;
            }
    }
    constexpr int kMargin = kRays / 10;
    size_t through = 0, rays = 0;
    for (int y = kMargin; y < kRays - kMargin; ++y)
        for (int x = kMargin; x < kRays - kMargin; ++x, ++rays)
            through += !hit[static_cast<size_t>(y * kRays + x)];
    return static_cast<double>(through) / static_cast<double>(rays);
}

Cloud lattice(size_t side, double jitter, double stretch = 1) {
    Random random(5);
    Cloud cloud;
    const auto columns = static_cast<size_t>(static_cast<double>(side) * stretch);
    const auto rows = static_cast<size_t>(static_cast<double>(side) / stretch);
    for (size_t y = 0; y < rows; ++y)
        for (size_t x = 0; x < columns; ++x) {
            const auto move = [&] { return 0.5 + jitter * (random.uniform() - 0.5); };
            const double px = (static_cast<double>(x) + move()) / static_cast<double>(columns);
            const double py = (static_cast<double>(y) + move()) / static_cast<double>(rows);
            cloud.points.push_back({px, py, 0});
        }
    cloud.normals.assign(cloud.points.size(), glm::dvec3(0, 0, 1));
    return cloud;
}

/// Dart throwing until nearly saturated: an even level of detail.
Cloud poisson_disk(size_t count) {
    const double distance = 0.75 / std::sqrt(static_cast<double>(count));
    const auto grid = static_cast<int>(1 / distance);
    std::vector<std::vector<glm::dvec3>> cells(static_cast<size_t>(grid * grid));
    Random random(6);
    Cloud cloud;
    for (size_t dart = 0; dart < 40 * count && cloud.points.size() < count; ++dart) {
        const glm::dvec3 p(random.uniform(), random.uniform(), 0);
        const int cx = std::min(grid - 1, static_cast<int>(p.x * grid)),
                  cy = std::min(grid - 1, static_cast<int>(p.y * grid));
        bool free = true;
        for (int y = std::max(0, cy - 1); y <= std::min(grid - 1, cy + 1); ++y)
            for (int x = std::max(0, cx - 1); x <= std::min(grid - 1, cx + 1); ++x)
                for (const auto& q : cells[static_cast<size_t>(y * grid + x)])
                    free = free && glm::distance(p, q) > distance;
        if (!free) continue;
        cells[static_cast<size_t>(cy * grid + cx)].push_back(p);
        cloud.points.push_back(p);
    }
    cloud.normals.assign(cloud.points.size(), glm::dvec3(0, 0, 1));
    return cloud;
}

/// An order whose prefixes are even: ever finer grids, with one point from each cell.
std::vector<size_t> even_order(const Cloud& cloud) {
    const size_t count = cloud.points.size();
    std::vector<size_t> order;
    std::vector<bool> taken(count);
    for (double side = 2; order.size() < count && side < 1e4; side = std::ceil(side * 1.4)) {
        constexpr size_t kFree = SIZE_MAX, kHeld = SIZE_MAX - 1;
        std::vector<size_t> holder(static_cast<size_t>(side * side), kFree);
        const auto cell = [&](size_t i) {
            const auto& p = cloud.points[i];
            return static_cast<size_t>(std::floor(p.y * side) * side + std::floor(p.x * side));
        };
        const auto from_centre = [&](size_t i) {
            const auto& p = cloud.points[i];
            return std::hypot(glm::fract(p.x * side) - 0.5, glm::fract(p.y * side) - 0.5);
        };
        for (const size_t i : order) holder[cell(i)] = kHeld;
        for (size_t i = 0; i < count; ++i) {
            size_t& held = holder[cell(i)];
            if (held == kFree || (held != kHeld && from_centre(i) < from_centre(held))) held = i;
        }
        std::erase_if(holder, [&](size_t i) { return i >= kHeld; });
        Random random(static_cast<uint64_t>(side));
        for (size_t i = holder.size(); i > 1; --i) std::swap(holder[i - 1], holder[random.next() % i]);
        for (const size_t i : holder) taken[i] = true;
        order.insert(order.end(), holder.begin(), holder.end());
    }
    for (size_t i = 0; i < count; ++i)
        if (!taken[i]) order.push_back(i);
    return order;
}

std::vector<Disc> discs_of(const Cloud& cloud, const Estimate& found,
                           const std::function<double(size_t)>& radius) {
    std::vector<Disc> discs;
    for (size_t i = 0; i < cloud.points.size(); ++i)
        if (found.normals[i] != glm::vec3(0.0f))
            discs.push_back({cloud.points[i], glm::dvec3(found.normals[i]), radius(i)});
    return discs;
}

TEST(Footprint, LeaksAreFewAtTheCoveragesChosen) {
    constexpr size_t kPoints = 10000;
    constexpr double kSpacing = 0.01;
    const struct {
        const char* name;
        Cloud cloud;
        double slant;  // tangent
        bool even;
    } patterns[] = {{"random", plane(kPoints), 0, false},
                    {"random, noise .5 spacings", plane(kPoints, 0.5 * kSpacing), 0, false},
                    {"the same at 75 degrees", plane(kPoints, 0.5 * kSpacing), 3.7, false},
                    {"scan lines 3:1", lattice(100, 0.5, 1.732), 0, false},
                    {"scan lines 9:1", lattice(100, 0.5, 3), 0, false},
                    {"a random point a cell", lattice(100, 1), 0, true},
                    {"lattice jittered by half", lattice(100, 0.5), 0, true},
                    {"Poisson disk", poisson_disk(kPoints), 0, true}};
    constexpr double kCoverages[] = {1.7, 4, 5, 7, 9};
    std::printf("rays that leak, per million: discs of equal size | of each point's own share\n%-27s",
                "coverage");
    for (const double c : kCoverages) std::printf("%16.1f", c);
    std::printf("\n");
    for (const auto& pattern : patterns) {
        const Estimate found = estimate(pattern.cloud);
        const double share = 1.0 / static_cast<double>(pattern.cloud.points.size());
        const auto leak = [&](double coverage, bool own) {
            return leak_share(
                discs_of(pattern.cloud, found,
                         [&](size_t i) {
                             return std::sqrt(coverage * (own ? found.areas[i] : share) / std::numbers::pi);
                         }),
                pattern.slant);
        };
        std::printf("%-27s", pattern.name);
        for (const double c : kCoverages)
            std::printf("%9.0f|%6.0f", 1e6 * leak(c, false), 1e6 * leak(c, true));
        std::printf("\n");
        EXPECT_LT(leak(pattern.even ? kCoverageEven : kCoverageRaw, true), 5e-4) << pattern.name;
        EXPECT_LT(leak(kCoverageUnknown, false), 5e-4) << pattern.name;
    }
}

/// A sheet whose left half is `ratio` times denser (in spacings) than its right half.
Cloud uneven_sheet(double ratio, double jitter, double noise) {
    constexpr double kWide = 0.05;
    Random random(7);
    Cloud cloud;
    const auto fill = [&](double low, double high, double spacing) {
        for (double y = spacing / 2; y < 1; y += spacing)
            for (double x = low + spacing / 2; x < high; x += spacing) {
                const auto move = [&] { return jitter * spacing * (random.uniform() - 0.5); };
                cloud.points.push_back({x + move(), y + move(), noise * kWide / ratio * gaussian(random)});
            }
    };
    fill(0, 0.5, kWide / ratio);
    fill(0.5, 1, kWide);
    cloud.normals.assign(cloud.points.size(), glm::dvec3(0, 0, 1));
    return cloud;
}

std::vector<Disc> raw_discs(const Cloud& cloud, const Estimate& found) {
    return discs_of(cloud, found, [&](size_t i) { return double{surfel_radius(found.areas[i], 0)}; });
}

TEST(Footprint, WhereTheDensityJumpsNoHoleShowsAndAreasAddUp) {
    for (const double ratio : {3.0, 5.0, 10.0})
        for (const double jitter : {0.5, 1.5})
            for (const double noise : {0.0, 0.3}) {
                const Cloud cloud = uneven_sheet(ratio, jitter, noise);
                const Estimate found = estimate(cloud);
                const Score s = score(cloud, found);
                double sparse = 0;
                for (size_t i = 0; i < cloud.points.size(); ++i)
                    if (cloud.points[i].x > 0.5) sparse += found.areas[i];
                const double leak = leak_share(raw_discs(cloud, found));
                std::printf(
                    "%4.0f : 1, jitter %.1f, noise %.1f: area %.3f, sparse half %.3f, marked %.4f, leak "
                    "%.0f\n",
                    ratio, jitter, noise, s.area, 2 * sparse, s.marked, 1e6 * leak);
                EXPECT_NEAR(s.area, 1, 0.05) << ratio << " " << jitter << " " << noise;
                EXPECT_NEAR(sparse, 0.5, 0.04) << ratio << " " << jitter << " " << noise;
                EXPECT_LT(s.marked, 0.001) << ratio << " " << jitter << " " << noise;
                EXPECT_LT(leak, 1e-3) << ratio << " " << jitter << " " << noise;
            }
}

TEST(Footprint, ASheetThatEndsDoesNotBulge) {
    constexpr size_t kPoints = 10000;
    constexpr double kSpacing = 0.01, kHalf = 0.15;  // of a window in the middle: 30 spacings wide
    for (Cloud cloud : {plane(kPoints), lattice(100, 0.5), lattice(100, 0.5, 1.732)}) {
        const auto in_window = [&](const glm::dvec3& p, double margin) {
            return std::abs(p.x - 0.5) < kHalf - margin && std::abs(p.y - 0.5) < kHalf - margin;
        };
        std::erase_if(cloud.points, [&](const auto& p) { return in_window(p, 0); });
        cloud.normals.resize(cloud.points.size());
        const Estimate found = estimate(cloud);
        double area = 0;
        std::vector<double> bulges;
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            area += found.areas[i];
            const glm::dvec3 p = glm::abs(cloud.points[i] - 0.5);
            const double outside = std::max(p.x - kHalf, p.y - kHalf);
            if (outside < kSpacing) bulges.push_back(surfel_radius(found.areas[i], 0) - outside);
        }
        std::sort(bulges.begin(), bulges.end());
        const double truth = 1 - 4 * kHalf * kHalf, most = bulges[bulges.size() * 95 / 100];
        std::printf("area %.4f of the truth, discs reach %.2f spacings into the window, the worst %.2f\n",
                    area / truth, most / kSpacing, bulges.back() / kSpacing);
        EXPECT_NEAR(area / truth, 1, 0.03);
        EXPECT_LT(most, 2.5 * kSpacing);
        EXPECT_LT(bulges.back(), 6 * kSpacing);
    }
}

TEST(Footprint, PrefixesAddUpToTheSurfaceAndDoNotLeak) {
    for (const Cloud& cloud : {plane(10000), lattice(100, 0.5)}) {
        const Estimate found = estimate(cloud);
        const auto order = even_order(cloud);
        std::vector<float> own;
        for (const size_t i : order) own.push_back(found.areas[i]);
        const double surface = std::accumulate(own.begin(), own.end(), 0.0);
        const auto floors = area_floors({}, own, surface);
        const float steps[4] = {floors[0], floors[1], floors[2], floors[3]};
        for (const float share : {1.0f, 0.97f, 0.9f, 0.7f, 0.5f, 0.35f, 0.25f, 0.125f, 0.06f}) {
            const float floor = floor_at_prefix(steps, share);
            std::vector<Disc> discs;
            double area = 0;
            for (size_t i = 0; i < static_cast<size_t>(share * static_cast<float>(order.size())); ++i) {
                area += surfel_area(own[i], floor);
                discs.push_back({cloud.points[order[i]], {0, 0, 1}, surfel_radius(own[i], floor)});
            }
            const double leak = leak_share(discs);
            std::printf("prefix %.3f: area %.4f of the surface, %.0f rays in a million leak\n",
                        static_cast<double>(share), area / surface, 1e6 * leak);
            EXPECT_NEAR(area / surface, 1, 0.08) << share;
            EXPECT_LT(leak, 5e-4) << share;
        }
    }
}

TEST(Footprint, RadiusIsThatOfADiscOfCoverageTimesArea) {
    const auto coverage = [](float own, float floor) {
        const double r = surfel_radius(own, floor);
        return std::numbers::pi * r * r / surfel_area(own, floor);
    };
    EXPECT_NEAR(coverage(2, 0), kCoverageRaw, 1e-5);
    EXPECT_NEAR(coverage(2, 1), kCoverageRaw, 1e-5);
    EXPECT_NEAR(coverage(1, 2), (kCoverageRaw + kCoverageEven) / 2, 1e-5);
    EXPECT_NEAR(coverage(1e-6f, 2), kCoverageEven, 1e-4);
    EXPECT_NEAR(coverage(0, 2), kCoverageUnknown, 1e-5);
    EXPECT_EQ(surfel_radius(0, 0), 0);
    float last = 0;  // a shorter prefix has a larger floor: discs never shrink
    for (float floor = 0; floor < 10; floor += 0.01f) {
        const float radius = surfel_radius(1, floor);
        EXPECT_GE(radius, last * 0.999f) << floor;
        last = radius;
    }
}

TEST(Footprint, FloorsBetweenPrefixStepsAreContinuous) {
    const float steps[4] = {0, 1, 3, 7}, positive[4] = {1, 2, 4, 8};
    for (const auto& floors : {steps, positive}) {
        float values[4];
        std::copy(floors, floors + 4, values);
        EXPECT_EQ(floor_at_prefix(values, 1), floors[0]);
        EXPECT_FLOAT_EQ(floor_at_prefix(values, 0.5f), floors[1]);
        EXPECT_FLOAT_EQ(floor_at_prefix(values, 0.125f), floors[3]);
        EXPECT_FLOAT_EQ(floor_at_prefix(values, 0.0625f), 2 * floors[3]);
        for (float share = 1; share > 0.01f; share *= 0.9999f) {
            const float before = floor_at_prefix(values, share),
                        after = floor_at_prefix(values, share * 0.9999f);
            EXPECT_LE(before, after * 1.0001f) << share;
            EXPECT_NEAR(before, after, 0.01f * after + 0.01f) << share;
        }
    }
    EXPECT_TRUE(std::isfinite(floor_at_prefix(positive, 0)));
}

}  // namespace
}  // namespace lucarne::octree
