#include "gi/engines/paths/gathering_points.h"

#include <cmath>

#include "io/core/parallel.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

constexpr Spacing kSpacing{.03f, .2f};
constexpr float kTurn = .123257f;  // root of 1 - cos 10 degrees

PointChooser::State all_points(const Surfaces& surfaces) {
    PointChooser chooser(surfaces, kSpacing, 64, 1);
    while (chooser.advance()) {
    }
    return chooser.state();
}

class GatheringPoints : public testing::Test {
 protected:
    const Surfaces surfaces_ = surfaces_of(scenes::closed_box(1, 60, glm::vec3(.5f)));
};

TEST_F(GatheringPoints, ReachEverySideAndNoneCoversAnother) {
    const auto state = all_points(surfaces_);
    for (Side side = 0; side < 2 * surfaces_.tracer().surfels().size(); ++side) {
        double least = 1e9;
        for (const GatheringPoint& point : state.points)
            if (!point.is_hidden(surfaces_.tracer().surfels()[side / 2].position))
                least = std::min<double>(least, error_of(point, point.reach, kTurn,
                                                         surfaces_.tracer().surfels()[side / 2].position,
                                                         normal_of(surfaces_.tracer().surfels(), side)));
        // None is in the very corner, under the rims of the discs of two walls.
        ASSERT_LT(least, kPixelReach) << side;
    }
    for (size_t i = 0; i < state.points.size(); ++i)
        for (size_t earlier = 0; earlier < i; ++earlier) {
            const GatheringPoint& point = state.points[earlier];
            if (point.is_hidden(state.points[i].position)) continue;
            ASSERT_GE(error_of(point, point.reach, kTurn, state.points[i].position, state.points[i].normal),
                      1);
        }
}

TEST_F(GatheringPoints, AreDenserInCornersAndSparseOutside) {
    const auto state = all_points(surfaces_);
    size_t inside = 0, outside = 0;
    for (const GatheringPoint& point : state.points) {
        EXPECT_GE(point.reach, kSpacing.least);
        EXPECT_LE(point.reach, kSpacing.most);
        (point.side % 2 == 0 ? inside : outside) += 1;
        const glm::vec3 to_middle = glm::abs(point.position - .5f);
        const float corner = std::max({std::min(to_middle.x, to_middle.y), std::min(to_middle.x, to_middle.z),
                                       std::min(to_middle.y, to_middle.z)});
        if (point.side % 2) {
            EXPECT_EQ(point.reach, kSpacing.most) << "its rays hit nothing";
        } else if (corner > .48f) {
            EXPECT_LT(point.reach, .08f);
        }
    }
    EXPECT_GT(inside, 2 * outside);
}

TEST(GatheringPointsInGaps, AreNotThere) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-1, -1, 0}, 2.0f * kX, 2.0f * kY, 80, glm::vec3(.5f));
    const float radius = surfels[0].radius;
    scenes::add_rectangle(surfels, {-.3f, -.3f, 1.5f * radius}, .6f * kX, .6f * kY, 24, glm::vec3(.5f));
    const Surfaces surfaces = surfaces_of(surfels);
    size_t on_top = 0;
    for (const GatheringPoint& point : all_points(surfaces).points) {
        if (std::max(std::abs(point.position.x), std::abs(point.position.y)) > .25f) continue;
        EXPECT_TRUE(point.position.z > 0 ? point.normal.z > 0 : point.normal.z < 0) << point.position.x;
        on_top += point.position.z > 0 && point.normal.z > 0;
    }
    EXPECT_GT(on_top, 1u);
}

TEST(GatheringPointsAboutAWall, ServeTheirOwnSideOfItOnly) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-1, 0, 0}, 2.0f * kX, kY, 60, glm::vec3(.5f));
    scenes::add_rectangle(surfels, {0, -.5f, -.5f}, 2.0f * kY, 2.0f * kZ, 60, glm::vec3(.5f));
    const Surfaces surfaces = surfaces_of(surfels);
    const auto state = all_points(surfaces);
    int before = 0, behind = 0;
    for (const GatheringPoint& point : state.points) {
        if (std::abs(point.normal.z) < .9f || point.position.y < .2f || point.position.y > .8f) continue;
        const float x = point.position.x;
        if (kPixelReach * point.reach < std::abs(x) + .01f) continue;  // it ends before the wall
        for (const float along : {-.3f, -.05f, .05f, .3f}) {
            const glm::vec3 place(x > 0 ? -.01f : .01f, point.position.y + along * std::abs(x), 0);
            EXPECT_TRUE(point.is_hidden(place)) << x << " " << along;
            EXPECT_FALSE(point.is_hidden(place * glm::vec3(-1, 1, 1))) << x << " " << along;
        }
        ++(x > 0 ? before : behind);
    }
    EXPECT_GT(before, 5);
    EXPECT_GT(behind, 5);
}

TEST_F(GatheringPoints, AreTheSameWhereverTheyWereInterruptedAndWithOneThread) {
    const auto whole = all_points(surfaces_);
    const ThreadLimit one(1);
    PointChooser first(surfaces_, kSpacing, 64, 1);
    for (int i = 0; i < 5; ++i) first.advance();
    PointChooser second(surfaces_, kSpacing, 64, 1);
    ASSERT_TRUE(second.restore(first.state()));
    while (second.advance()) {
    }
    EXPECT_EQ(second.state().points, whole.points);
    ASSERT_EQ(second.state().hits.size(), whole.hits.size());
    for (size_t i = 0; i < whole.hits.size(); ++i) ASSERT_EQ(second.state().hits[i].side, whole.hits[i].side);
}

TEST_F(GatheringPoints, DamagedOnesAreNotContinued) {
    const auto state = all_points(surfaces_);
    const auto refuses = [&](const auto& damage) {
        auto wrong = state;
        damage(wrong);
        return !PointChooser(surfaces_, kSpacing, 64, 1).restore(wrong);
    };
    EXPECT_FALSE(refuses([](auto&) {}));
    EXPECT_TRUE(refuses([](auto& s) { s.points[3].side = 1'000'000; }));
    EXPECT_TRUE(refuses([](auto& s) { s.points[3].reach = std::nanf(""); }));
    EXPECT_TRUE(refuses([](auto& s) { s.points[3].walls.planes[5].y = std::nanf(""); }));
    EXPECT_TRUE(refuses([](auto& s) { s.hits[3].side = 1'000'000; }));
    EXPECT_TRUE(refuses([](auto& s) { s.hits.pop_back(); }));
    EXPECT_TRUE(refuses([](auto& s) { s.next = 1'000'000; }));
    EXPECT_TRUE(refuses([](auto& s) { s.spacing.least = 0; }));
}

}  // namespace
}  // namespace lucarne::gi::paths
