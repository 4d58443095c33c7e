#include "gi/gather/gatherer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/shared/lobe.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/surfel_edge.h"
#include "io/core/random.h"
#include "tests/gi/on_device.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi {
namespace {

class GathererTest : public testing::Test {
 protected:
    void SetUp() override {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device_ = std::move(*made);
        auto opened = device_->opencl();
        ASSERT_TRUE(opened) << opened.error().line();
        opencl_ = *opened;
    }
    std::vector<glm::vec4> gather(std::span<const FlatSurfel> surfels, std::span<const SideLight> light,
                                  std::span<const GatherPoint> points, uint32_t side = 24,
                                  const SideLobes& lobes = {}, float typical = 0) {
        const auto tree = std::make_shared<SurfelTree>(build_tree(surfels));
        Gatherer gatherer;
        EXPECT_TRUE(gatherer.set_tree(*opencl_, tree));
        EXPECT_TRUE(gatherer.set_light(*opencl_, shared(pull_light(*tree, light))));
        gatherer.set_typical(typical);
        SideLobes of_slots;
        if (!lobes.light.empty()) {
            of_slots.light = pull_light(*tree, lobes.light);
            of_slots.directions = pull_light(*tree, lobes.directions);
        }
        EXPECT_TRUE(gatherer.set_lobes(*opencl_, of_slots));
        std::vector<glm::vec4> results(points.size());
        const auto done = gatherer.gather(*opencl_, Gathered::light_of_surfels, points, side, 1, results);
        EXPECT_TRUE(done) << done.error().line();
        return results;
    }

    std::unique_ptr<Device> device_;
    ClDevice* opencl_ = nullptr;
};

/// Points on the floor of a room of this size.
std::vector<GatherPoint> floor_points(float size, float lift, size_t count) {
    std::vector<GatherPoint> points;
    Random random(7);
    for (size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(random.uniform()), y = static_cast<float>(random.uniform());
        points.push_back({size * glm::vec3(x, y, 0),
                          lift,
                          {0, 0, 1},
                          static_cast<uint32_t>(i),
                          glm::vec3(0.0f),
                          0,
                          {0, 0, 1},
                          1});
    }
    return points;
}

TEST_F(GathererTest, ClosedRoomIsSeenInEveryDirection) {
    const auto surfels = flat::of(scenes::closed_box(2, 60, glm::vec3(0.5f)));
    const std::vector<SideLight> light(surfels.size(), {glm::vec3(1), glm::vec3(1)});
    double mean = 0, empty = 0;
    const auto results = gather(surfels, light, floor_points(2, surfels[0].radius, 256));
    for (const glm::vec4& r : results) mean += r.x, empty += r.w;
    EXPECT_NEAR(mean / 256, 1, 1e-3);
    EXPECT_NEAR(empty / 256, 0, 1e-3);
}

// Points are drawn in groups. Only which nodes are opened may depend on those beside a point.
TEST_F(GathererTest, PointsSeeInGroupsWhatTheySeeAlone) {
    auto surfels = flat::of(scenes::closed_box(2, 60, glm::vec3(0.5f)));
    std::vector<SideLight> light;
    for (const FlatSurfel& s : surfels) light.push_back({glm::vec3(s.x, s.y, s.z), glm::vec3(0)});
    auto points = floor_points(2, surfels[0].radius, 99);
    for (GatherPoint& point : points) point.seed = 0;  // groups share the first one's turn
    const auto together = gather(surfels, light, points);
    for (size_t i = 0; i < points.size(); i += 9) {
        const glm::vec4 alone = gather(surfels, light, std::vector{points[i]})[0];
        EXPECT_LT(glm::distance(together[i], alone), 0.01f) << i;
    }
}

/// The form factor of a disc of this radius that faces a point at this distance, on its axis.
double form_factor(double radius, double distance) {
    return radius * radius / (radius * radius + distance * distance);
}

// Nodes that are not cut by their boxes shine beyond the rim: 30 % too much from afar. The discs of the
// surfels reach over it as well, which makes 3 %.
TEST_F(GathererTest, DiscShinesByItsFormFactorFromNearAndFar) {
    std::vector<FlatSurfel> disc;
    for (const FlatSurfel& s : flat::square(200, 2.0f))
        if (glm::length(glm::vec2(s.x - 1, s.y - 1)) < 0.5f) disc.push_back(s);
    const std::vector<SideLight> light(disc.size(), {glm::vec3(1), glm::vec3(1)});
    for (const float distance : {0.3f, 1.0f, 3.0f}) {
        std::vector<GatherPoint> points(
            64, {{1, 1, -distance}, 1e-3f, {0, 0, 1}, 0, glm::vec3(0.0f), 0, {0, 0, 1}, 1});
        for (uint32_t i = 0; i < points.size(); ++i) points[i].seed = i;
        double mean = 0;
        for (const glm::vec4& r : gather(disc, light, points)) mean += r.x / 64.0;
        EXPECT_NEAR(mean / form_factor(0.5, distance), 1, 0.1) << distance;
    }
}

/// The form factor of a square of this half width that faces a point at this distance, on its axis (Howell,
/// "A catalog of radiation heat transfer configuration factors", B-3).
double square_form_factor(double half, double distance) {
    const double a = half / distance, root = std::sqrt(1 + a * a);
    return 4 / kPi * (a / root) * std::atan(a / root);
}

/// Has a surfel end at a line, this far away in its own plane.
void end_at(FlatSurfel& surfel, const glm::vec3& toward, float distance, float root) {
    constexpr uint32_t kAreaCode = 100u << 16;
    const float side = root / std::sqrt(surfel_own_area(kAreaCode, 1.0f));
    PackedSurfel packed{0, kAreaCode, surfel.normal, surfel.albedo};
    pack_edge(toward, distance / side, packed);
    ASSERT_NE(packed.d & kSurfelHasEdge, 0u);
    surfel.normal = packed.c;
    surfel.albedo = packed.d & ~kSurfelHasEdge;
    surfel.edge_root = root;
}

// Discs that reach over the end of their surface shine beyond it, and close windows. At the corners there are
// two ends and a disc has one line, so masks of 8 x 8 bits remain there.
TEST_F(GathererTest, SquareEndsAtTheLinesOfItsSurfels) {
    constexpr int kSide = 20;
    const float spacing = 1.0f / kSide;
    std::vector<FlatSurfel> square = flat::square(kSide, 1.0f);
    for (FlatSurfel& s : square) {
        if (s.x < spacing)
            end_at(s, {-1, 0, 0}, s.x, spacing);
        else if (s.x > 1 - spacing)
            end_at(s, {1, 0, 0}, 1 - s.x, spacing);
        else if (s.y < spacing)
            end_at(s, {0, -1, 0}, s.y, spacing);
        else if (s.y > 1 - spacing)
            end_at(s, {0, 1, 0}, 1 - s.y, spacing);
    }
    const std::vector<SideLight> light(square.size(), {glm::vec3(1), glm::vec3(1)});
    for (const float distance : {0.3f, 1.0f, 3.0f}) {
        std::vector<GatherPoint> points(
            2048, {{0.5f, 0.5f, -distance}, 1e-3f, {0, 0, 1}, 0, glm::vec3(0.0f), 0, {0, 0, 1}, 1});
        for (uint32_t i = 0; i < points.size(); ++i) points[i].seed = i;
        double mean = 0;
        for (const glm::vec4& r : gather(square, light, points)) mean += r.x / 2048.0;
        EXPECT_NEAR(mean / square_form_factor(0.5, distance), 1, 0.03) << distance;
    }
}

TEST_F(GathererTest, SheetHidesWhatIsBehindIt) {
    auto surfels = flat::square(100, 2.0f);
    const size_t behind = surfels.size();
    for (FlatSurfel s : flat::square(100, 2.0f)) {
        s.z = 0.5f;
        surfels.push_back(s);
    }
    std::vector<SideLight> light(surfels.size());
    for (size_t i = behind; i < light.size(); ++i) light[i] = {glm::vec3(1), glm::vec3(1)};
    const GatherPoint point{{1, 1, -0.05f}, 1e-3f, {0, 0, 1}, 5, glm::vec3(0.0f), 0, {0, 0, 1}, 1};
    EXPECT_EQ(gather(surfels, light, std::vector{point})[0].x, 0);
}

// A sheet that sends light straight down by a narrow lobe. One ray meets the lobe or none: without wider
// lobes single points had up to 2.6 times the light, others next to none.
TEST_F(GathererTest, NarrowLobesReachEveryPoint) {
    constexpr float kExponent = 1000;
    const auto surfels = flat::square(100, 2.0f);
    SideLobes lobes;
    lobes.light.assign(surfels.size(), {glm::vec3(1), glm::vec3(1)});
    lobes.directions.assign(surfels.size(),
                            {-lobe_mean_cosine(kExponent) * kZ, -lobe_mean_cosine(kExponent) * kZ});
    std::vector<GatherPoint> points(128, {{1, 1, -0.8f}, 1e-3f, kZ, 0, glm::vec3(0.0f), 0, kZ, 1});
    for (uint32_t i = 0; i < points.size(); ++i) points[i].seed = i;
    for (const uint32_t side : {16u, 24u}) {
        double mean = 0, least = 1e9, most = 0;
        for (const glm::vec4& r :
             gather(surfels, std::vector<SideLight>(surfels.size()), points, side, lobes)) {
            const double irradiance = kPi * r.x;
            mean += irradiance / 128;
            least = std::min(least, irradiance), most = std::max(most, irradiance);
        }
        std::printf("side %u: %.3f, %.3f to %.3f\n", side, mean, least, most);
        EXPECT_NEAR(mean, 1, .06) << side << ": there are few sets of rays";
        EXPECT_GT(least, .7) << side;
        EXPECT_LT(most, 1.3) << side;
    }
}

// Nodes over the ridge are pieces of level planes, over which a point near the ridge looks: it saw their
// backs, which the sun lights.
TEST_F(GathererTest, UnderARoofNoBackOfItIsSeen) {
    constexpr float kSteep = 0.9f;
    std::vector<Surfel> roof;
    for (float y = 0.2f; y < 8; y += 1.3f) {
        scenes::add_rectangle(roof, {-1, y, -kSteep}, 1.3f * kY, {1, 0, kSteep}, 40, glm::vec3(0.5f));
        scenes::add_rectangle(roof, {0, y, 0}, 1.3f * kY, {1.3f, 0, -1.3f * kSteep}, 46, glm::vec3(0.5f));
    }
    for (Surfel& s : roof)
        if (s.normal.z > 0) s.normal = -s.normal;
    const auto surfels = flat::of(roof);
    const std::vector<SideLight> light(surfels.size(), {glm::vec3(0), glm::vec3(1)});
    std::vector<GatherPoint> points;
    for (uint32_t i = 0; i < 512; ++i) points.push_back({{0, 0, -0.04f}, 1e-3f, kY, i, kY, 0, kY, 1});
    for (const glm::vec4& r : gather(surfels, light, points)) ASSERT_EQ(r.x, 0);
    // Nor where light is typically a fifth of that of the backs. Backs that are no brighter than usual are
    // not worth a ray each.
    for (const glm::vec4& r : gather(surfels, light, points, 24, {}, 0.2f)) ASSERT_EQ(r.x, 0);
    double seen = 0;
    for (const glm::vec4& r : gather(surfels, light, points, 24, {}, 1)) seen += r.x;
    EXPECT_GT(seen, 0);
}

TEST_F(GathererTest, BuffersThatStayGiveWhatGatheringGives) {
    const auto surfels = flat::noisy_room(3000);
    std::vector<SideLight> light(surfels.size());
    for (size_t i = 0; i < light.size(); ++i)
        light[i] = {glm::vec3(static_cast<float>(i % 7)), glm::vec3(static_cast<float>(i % 5))};
    const auto tree = std::make_shared<SurfelTree>(build_tree(surfels));
    Gatherer gatherer;
    ASSERT_TRUE(gatherer.set_tree(*opencl_, tree));
    ASSERT_TRUE(gatherer.set_light(*opencl_, shared(pull_light(*tree, light))));
    std::vector<GatherPoint> points = floor_points(1, 0.05f, 100);
    for (GatherPoint& point : points) point.position.z = 0.2f;
    std::vector<glm::vec4> gathered(points.size());
    ASSERT_TRUE(gatherer.gather(*opencl_, Gathered::light_of_surfels, points, 16, 1, gathered));
    MicroBuffers buffers;
    ASSERT_TRUE(gatherer.see(*opencl_, points, 16, 1, buffers));
    const auto shaded = gatherer.shade(*opencl_, Gathered::light_of_surfels, buffers);
    ASSERT_TRUE(shaded) << shaded.error().line();
    for (size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(shaded->at(i).on(points[i].normal).y, gathered[i].y, 1e-4f * gathered[i].y);
    // All cells of directions together have the same light, from as far away.
    const auto by_direction = gatherer.shade_by_direction(*opencl_, Gathered::light_of_surfels, buffers);
    ASSERT_TRUE(by_direction) << by_direction.error().line();
    const auto distances = buffers.nearness();
    for (size_t i = 0; i < points.size(); ++i) {
        float sum = 0, rays = 0, nearness = 0;
        for (const LightByDirection::Cell& cell : by_direction->at(i).cells) {
            sum += cell.light.y;
            rays += cell.rays;
            nearness += cell.nearness;
        }
        EXPECT_NEAR(sum / rays, gathered[i].y, 1e-4f * gathered[i].y);
        // Of slots, that is to their middles, and from the surface.
        EXPECT_GT(nearness, .4f * rays * (*distances)[i]);
        EXPECT_LT(nearness, 1.2f * rays * (*distances)[i]);
        for (uint32_t cell = 0; cell < kDirectionCells; ++cell)
            if (direction_of_cell(cell).z < -.3f) {
                EXPECT_EQ(by_direction->at(i).cells[cell].rays, 0);
            }
        LightByDirection more = by_direction->at(i);
        more.add_ray(points[i].normal, glm::vec3(0, 0, 1), glm::vec3(2));
        const uint32_t above = direction_cell(glm::vec3(0, 0, 1));
        EXPECT_NEAR((more.cells[above].light.y - by_direction->at(i).cells[above].light.y) / rays, 2, 1e-4f)
            << "rays of their own bring shares of the mean";
    }
    const auto seen = buffers.seen();
    ASSERT_TRUE(seen);
    for (const uint32_t code : *seen)
        if (code < kSeesSky) {
            ASSERT_NE(tree->nodes[code / 16].child[code / 2 % 8], kNoChild);
        }
    // Buffers of the same points stay as they are, and are drawn again for another tree.
    ASSERT_TRUE(gatherer.see(*opencl_, points, 16, 1, buffers));
    EXPECT_EQ(*buffers.seen(), *seen);
    ASSERT_TRUE(gatherer.set_tree(*opencl_, nullptr));
    ASSERT_TRUE(gatherer.see(*opencl_, points, 16, 1, buffers));
    const auto of_nothing = buffers.seen();
    EXPECT_TRUE(std::ranges::all_of(*of_nothing, [](uint32_t code) { return code >= kSeesSky; }));
    ASSERT_TRUE(gatherer.set_tree(*opencl_, tree));
    ASSERT_TRUE(gatherer.see(*opencl_, points, 16, 1, buffers));
    const auto nearness = buffers.nearness();
    ASSERT_TRUE(nearness);
    for (const float near : *nearness) EXPECT_GT(near, 1 / 1.75f);
}

// A half space of even light gives (1 + cos t) / 2 to a normal that is turned by t, not cos t, because what
// lies behind the turned plane counts as nothing, not as less than nothing.
TEST_F(GathererTest, LightForTurnedNormalsCountsNothingFromBehind) {
    Gatherer gatherer;
    ASSERT_TRUE(gatherer.set_tree(*opencl_, nullptr));
    ASSERT_TRUE(gatherer.set_sky(*opencl_, {.width = 8, .height = 4, .texels{32, glm::vec3(1.0f)}}));
    const std::vector<GatherPoint> points = floor_points(1, 0.01f, 64);
    MicroBuffers buffers;
    ASSERT_TRUE(gatherer.see(*opencl_, points, 24, 1, buffers));
    const auto shaded = gatherer.shade(*opencl_, Gathered::sky, buffers);
    ASSERT_TRUE(shaded) << shaded.error().line();
    for (const double degrees : {0.0, 10.0, 20.0, 30.0}) {
        const double angle = glm::radians(degrees);
        double mean = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            const double around = 0.1 * static_cast<double>(i);
            const glm::dvec3 normal(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
                                    std::cos(angle));
            mean += shaded->at(i).on(glm::vec3(normal)).y / static_cast<double>(points.size());
        }
        EXPECT_NEAR(mean, (1 + std::cos(angle)) / 2, 0.01) << degrees;
    }
}

TEST_F(GathererTest, EmptyTreeSendsNothing) {
    const auto results = gather({}, {}, floor_points(1, 0.01f, 3));
    for (const glm::vec4& r : results) EXPECT_EQ(r, glm::vec4(0, 0, 0, 1));
}

}  // namespace
}  // namespace lucarne::gi
