#include "octree/stream/cut.h"

#include <cmath>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "tests/octree/plane_source.h"

namespace lucarne::octree {
namespace {

using test::PlaneSource;

/// A camera over the square, looking along `forward` with a field of view of 60 degrees.
View camera(const glm::dvec3& position, const glm::dvec3& forward, uint32_t pixels = 512) {
    View view;
    view.position = position;
    view.forward = glm::normalize(forward);
    view.right = glm::normalize(glm::cross(view.forward, glm::dvec3(0.3, 1.0, 0.01)));
    view.up = glm::cross(view.right, view.forward);
    view.tan_half_width = view.tan_half_height = std::tan(0.5);
    view.width = view.height = pixels;
    return view;
}
const glm::dvec3 kDown(0.0, 0.0, -1.0);

std::map<uint32_t, uint32_t> prefixes(const Cut& cut) {
    std::map<uint32_t, uint32_t> result;
    for (const CutNode& node : cut.nodes) result[node.node] = node.count;
    return result;
}

void expect_sound(const NodeSource& source, const Cut& cut, uint64_t budget) {
    const auto count = prefixes(cut);
    ASSERT_EQ(count.size(), cut.nodes.size()) << "a node occurs twice";
    EXPECT_TRUE(std::ranges::is_sorted(cut.nodes, {}, &CutNode::node));
    uint64_t points = 0;
    for (const CutNode& node : cut.nodes) {
        points += node.count;
        const NodeInfo& info = source.nodes()[node.node];
        EXPECT_LE(node.count, info.count);
        if (node.node == 0) continue;
        ASSERT_TRUE(count.contains(info.parent)) << "node " << node.node << " without its parent";
        EXPECT_EQ(count.at(info.parent), source.nodes()[info.parent].count) << "an ancestor is not whole";
    }
    EXPECT_EQ(points, cut.points);
    EXPECT_LE(points, budget);
}

TEST(Cut, IsClosedUnderParentsAndWithinItsBudgetForAnyView) {
    const PlaneSource source(7, 500, 100.0);
    for (const double height : {0.001, 0.5, 3.0, 40.0, 900.0})
        for (const uint64_t budget :
             {uint64_t{1}, uint64_t{499}, uint64_t{500}, uint64_t{12345}, uint64_t{1} << 40}) {
            expect_sound(source, view_cut(source, camera({31, 57, height}, {0.4, 0.1, -1}), budget), budget);
            expect_sound(source, light_view_cut(source, camera({31, 57, height}, kDown), budget), budget);
            expect_sound(source, light_cut(source, {31, 57, height}, budget), budget);
        }
}

TEST(Cut, UsesNearlyAllOfABudgetThatIsHit) {
    const PlaneSource source(7, 500, 100.0);
    for (const uint64_t budget : {600u, 5000u, 77777u, 300000u}) {
        const Cut cut = view_cut(source, camera({31, 57, 60}, {0.4, 0.1, -1}), budget, 0.01);
        EXPECT_TRUE(cut.budget_hit);
        EXPECT_GE(cut.points, budget - cut.nodes.size()) << "less than a point a node is lost by rounding";
    }
}

TEST(Cut, CutsTheRootsPrefixWhereTheRootAloneIsOverTheBudget) {
    const PlaneSource source(3, 5000, 10.0);
    const Cut cut = light_cut(source, glm::dvec3(5.0), 77);
    ASSERT_EQ(cut.nodes.size(), 1u);
    EXPECT_EQ(cut.nodes[0].count, 77u);
    EXPECT_TRUE(cut.budget_hit);
}

TEST(Cut, ReachesTheWantedSpacingEverywhereAndNoMore) {
    const PlaneSource source(7, 500, 100.0);
    const View view = camera({50, 50, 20}, kDown);
    const double pixel = 2 * view.tan_half_height / view.height;
    for (const double wanted : {1.0, 2.0, 5.0}) {
        const Cut cut = view_cut(source, view, UINT64_MAX, wanted);
        EXPECT_FALSE(cut.budget_hit);
        const auto count = prefixes(cut);
        for (const auto& [node, used] : count) {
            const NodeInfo& info = source.nodes()[node];
            if (info.child_mask == 0) continue;
            const Cube cube = source.header().root.of(info.key);
            const glm::dvec3 nearest = glm::clamp(view.position, cube.min, cube.min + cube.size);
            const double reach = wanted * pixel * glm::distance(nearest, view.position);
            if (used == info.count) continue;
            EXPECT_LT(info.spacing(), reach * 1.0001) << "a node fine enough when whole fades";
            const double own = 1 / std::pow(info.spacing(), 2), needed = 1 / (reach * reach);
            const double coarser = 1 / std::pow(source.nodes()[info.parent].spacing(), 2);
            EXPECT_NEAR(double(used) / info.count, (needed - coarser) / (own - coarser), 0.003);
        }
    }
}

TEST(Cut, MoreBudgetNeverMakesAnyPlaceCoarser) {
    const PlaneSource source(7, 500, 100.0);
    const View view = camera({20, 70, 1.5}, {1, -0.5, -0.3});
    for (const bool light : {false, true}) {
        std::map<uint32_t, uint32_t> before;
        for (uint64_t budget = 100; budget < 2000000; budget = budget * 21 / 20 + 1) {
            const auto now = prefixes(light ? light_cut(source, view.position, budget)
                                            : view_cut(source, view, budget, 0.2));
            for (const auto& [node, count] : before) {
                ASSERT_TRUE(now.contains(node)) << "budget " << budget;
                ASSERT_GE(now.at(node), count) << "budget " << budget;
            }
            before = now;
        }
    }
}

TEST(Cut, LeavesOutWhatTheViewCannotSeeAndHoldsWhatItCan) {
    const PlaneSource source(7, 500, 100.0);
    const View view = camera({50, 50, 10}, kDown);
    const auto count = prefixes(view_cut(source, view, UINT64_MAX, 4.0));
    const double seen = 10 * view.tan_half_width;  // half the side of the visible square on the ground
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const NodeInfo& info = source.nodes()[node];
        const Cube cube = source.header().root.of(info.key);
        // The view is turned about its axis: compare with the circles inside and around its square.
        const glm::dvec3 nearest = glm::clamp(view.position, cube.min, cube.min + cube.size);
        const double away = glm::distance(glm::dvec2(nearest), glm::dvec2(view.position));
        if (away > seen * std::sqrt(2.0) + cube.size + 4 * info.spacing()) {
            EXPECT_FALSE(count.contains(node)) << "node " << node << ", " << away << " away";
        }
        const double reach = 4 * 2 * view.tan_half_width / view.width * glm::distance(nearest, view.position);
        const bool wanted = info.parent != kNoNode && source.nodes()[info.parent].spacing() > reach * 1.05;
        if (away < seen * 0.99 && wanted) {
            EXPECT_TRUE(count.contains(node)) << "node " << node;
        }
    }
    View away = camera({50, 50, 10}, {0, 0, 1});
    away.near_plane = 1.0;
    away.position.z = 101.0 + 1000.0;  // above the root's cube, looking up
    EXPECT_TRUE(view_cut(source, away, UINT64_MAX).nodes.empty());
}

TEST(Cut, RefinesToTheLeavesAroundACameraThatStandsInThem) {
    const PlaneSource source(6, 500, 100.0);
    const auto count = prefixes(view_cut(source, camera({33, 44, 0.01}, {1, 0.2, 0}), UINT64_MAX));
    bool found = false;
    for (const auto& [node, used] : count) {
        const Cube cube = source.header().root.of(source.nodes()[node].key);
        const bool around = cube.min.x <= 33 && 33 < cube.min.x + cube.size && cube.min.y <= 44 &&
                            44 < cube.min.y + cube.size;
        if (around && source.nodes()[node].child_mask == 0) {
            found = true;
            EXPECT_EQ(used, 500u);
        }
    }
    EXPECT_TRUE(found);
}

TEST(Cut, ChangesByNoMoreThanTheStatedBoundWhenTheCameraMovesSlightly) {
    const PlaneSource source(8, 500, 100.0);
    for (int step = 0; step < 200; ++step) {
        const double height = 30 * std::pow(0.985, step), share = 0.001;
        View view = camera({50, 50, height}, kDown);
        const auto before = prefixes(view_cut(source, view, UINT64_MAX));
        view.position.z = height * (1 - share);
        const auto after = prefixes(view_cut(source, view, UINT64_MAX));
        for (uint32_t node = 0; node < source.nodes().size(); ++node) {
            // Nodes at the picture's border are culled or not, which is not a change of the level of detail.
            const Cube cube = source.header().root.of(source.nodes()[node].key);
            const double across = glm::length(glm::dvec2(cube.min) + cube.size / 2 - 50.0) + cube.size;
            if (across > height * view.tan_half_width * 0.9) continue;
            const double a = before.contains(node) ? before.at(node) : 0,
                         b = after.contains(node) ? after.at(node) : 0;
            ASSERT_LE(std::abs(a - b), 10 * share * 500 + 1) << "node " << node << " at height " << height;
        }
    }
}

TEST(Cut, ChangesSmoothlyUnderAHitBudgetToo) {
    const PlaneSource source(8, 500, 100.0);
    View view = camera({50, 50, 12}, {0.5, 0.2, -0.6});
    auto before = prefixes(view_cut(source, view, 60000, 0.1));
    for (int step = 0; step < 100; ++step) {
        view.position += glm::dvec3(0.004, 0.002, -0.006);  // at least .05 % of the distance to the ground
        const auto after = prefixes(view_cut(source, view, 60000, 0.1));
        uint64_t changed = 0;
        for (const auto& [node, count] : after)
            changed += std::abs(int64_t{count} - (before.contains(node) ? int64_t{before.at(node)} : 0));
        for (const auto& [node, count] : before) changed += after.contains(node) ? 0 : count;
        EXPECT_LT(changed, 60000u / 20) << "step " << step;
        before = after;
    }
}

TEST(Cut, VisitsOnlyWhatItNeedsOfAMillionNodes) {
    const PlaneSource source(11, 2000, 10000.0);
    ASSERT_GT(source.nodes().size(), 1000000u);
    const Cut cut = view_cut(source, camera({5000, 5000, 100}, {0.5, 0.5, -0.2}), 3000000);
    expect_sound(source, cut, 3000000);
    EXPECT_GT(cut.points, 100000u);
    EXPECT_LT(cut.visited, 12 * cut.nodes.size());
    const Cut light = light_cut(source, {5000, 5000, 100}, 1000000);
    expect_sound(source, light, 1000000);
    EXPECT_LT(light.visited, 12 * light.nodes.size());
}

/// The level of the deepest node of a cut that contains a position on the plane.
int level_at(const PlaneSource& source, const Cut& cut, double x, double y) {
    const auto count = prefixes(cut);
    uint32_t node = 0;
    while (source.nodes()[node].child_mask) {
        const Cube cube = source.header().root.of(source.nodes()[node].key);
        const uint32_t octant = (x >= cube.min.x + cube.size / 2) | (y >= cube.min.y + cube.size / 2) << 1;
        const uint32_t child = source.nodes()[node].child(octant);
        if (!count.contains(child)) break;
        node = child;
    }
    return source.nodes()[node].key.level;
}

TEST(Cut, TheLightCutIsFineAtItsCentreCoarseFarAwayAndMissesNothing) {
    const PlaneSource source(8, 500, 1000.0);
    const Cut cut = light_cut(source, {200, 200, 2}, 400000);
    EXPECT_GT(level_at(source, cut, 200, 200), level_at(source, cut, 950, 950) + 1);
    EXPECT_GE(level_at(source, cut, 950, 950), 1)
        << "the far corner is behind a camera at the centre, but must be in the cut";
}

/// An outlier a hundred kilometres away enlarges the whole scene, but not the robust bounds.
TEST(Cut, TheLightCutIsFineWhereTheScanIsHoweverFarStraysAre) {
    const PlaneSource source(8, 500, 1000.0);
    const glm::dvec3 centre{200, 200, 2};
    const auto levels = [&](double extent) {
        const Cut cut = light_cut(source, centre, 100000, {}, extent);
        return level_at(source, cut, 200, 200) - level_at(source, cut, 400, 400);
    };
    EXPECT_EQ(levels(100000), 0);
    EXPECT_GT(levels(100), 1);
}

TEST(Cut, TheLightCutIsFineBeforeLampsToo) {
    const PlaneSource source(9, 500, 1000.0);
    const std::vector<glm::dvec3> lamps = {{900, 900, .5}, {900, 100, 2}};
    const Cut cut = light_cut(source, {200, 200, 2}, 100000, lamps);
    expect_sound(source, cut, 100000);
    const int middle = level_at(source, cut, 550, 550);
    for (const auto& lamp : lamps) EXPECT_GT(level_at(source, cut, lamp.x, lamp.y), middle + 2);
    EXPECT_EQ(level_at(source, light_cut(source, {200, 200, 2}, 100000), 900, 900), middle);
}

TEST(Cut, TheFullCutIsEveryPoint) {
    const PlaneSource source(5, 321, 10.0);
    const Cut cut = full_cut(source);
    EXPECT_EQ(cut.points, source.header().points);
    expect_sound(source, cut, UINT64_MAX);
    const Cut all = light_cut(source, glm::dvec3(0.0), UINT64_MAX);
    EXPECT_EQ(all.points, cut.points);
    EXPECT_FALSE(all.budget_hit);
}

TEST(Cut, TakesEmptySourcesAndUnknownSpacingsAndViewsThatAreNotNumbers) {
    PlaneSource source(5, 300, 10.0);
    for (NodeInfo& node : source.edit()) node.area_floor.fill(node.key.level % 2 ? 0.0f : NAN);
    expect_sound(source, view_cut(source, camera({5, 5, 1}, kDown), 20000), 20000);
    EXPECT_EQ(light_cut(source, {5, 5, 1}, UINT64_MAX).points, source.header().points);
    View odd = camera({NAN, 5, 1}, kDown);
    odd.tan_half_width = NAN;
    odd.width = odd.height = 0;
    expect_sound(source, view_cut(source, odd, 20000), 20000);
    expect_sound(source, light_cut(source, {NAN, NAN, NAN}, 20000), 20000);
    source.edit().clear();
    EXPECT_TRUE(view_cut(source, camera({5, 5, 1}, kDown), 20000).nodes.empty());
    EXPECT_TRUE(light_cut(source, glm::dvec3(0.0), 20000).nodes.empty());
    EXPECT_TRUE(full_cut(source).nodes.empty());
}

TEST(Cut, KeepsNodesWithoutPointsOfTheirOwnAboveThoseThatHaveThem) {
    PlaneSource source(6, 400, 50.0);
    for (NodeInfo& node : source.edit())
        if (node.key.level < 2) node.count = 0;
    const Cut cut = view_cut(source, camera({25, 25, 20}, kDown), 50000);
    EXPECT_GT(cut.points, 10000u);
    expect_sound(source, cut, 50000);
}

/// The error of the picture while only `held` are loaded: the spacing of the points along rays to the plane,
/// in pixels, above that of the whole cut, summed.
double spacing_error(const PlaneSource& source, const Cut& cut, const std::set<uint32_t>& held,
                     const View& view) {
    const auto count = prefixes(cut);
    double error = 0;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) {
            const glm::dvec3 ray = view.forward + view.right * (view.tan_half_width * (x / 19.5 - 1)) +
                                   view.up * (view.tan_half_height * (y / 19.5 - 1));
            if (!(ray.z < 0)) continue;
            const double along = -view.position.z / ray.z;
            const glm::dvec3 point = view.position + ray * along;
            if (point.x < 0 || point.y < 0 || point.x >= 100 || point.y >= 100) continue;
            double density = 0, here = 0;  // points a unit^2: of the whole cut, of the resident nodes
            for (uint32_t node = 0, parent_held = 1;;) {
                if (!count.contains(node)) break;
                const double side = source.cube(node).size, added = count.at(node) / (side * side);
                density += added;
                parent_held = parent_held && held.contains(node);
                if (parent_held) here += added;
                const glm::dvec3 middle = source.cube(node).min + side / 2;
                const uint32_t child =
                    source.nodes()[node].child((point.x >= middle.x ? 1 : 0) | (point.y >= middle.y ? 2 : 0));
                if (child == kNoNode) break;
                node = child;
            }
            const double pixel = 2 * view.tan_half_width / view.width * along;
            error += (1 / std::sqrt(std::max(here, 1e-6)) - 1 / std::sqrt(density)) / pixel;
        }
    return error;
}

TEST(Cut, LoadingByPriorityMendsThePictureSoonerThanLevelByLevel) {
    const PlaneSource source(7, 500, 100.0);
    for (const View& view : {camera({20, 50, 5}, {1, 0.1, -0.4}), camera({50, 50, 3}, {0.2, 1, -0.2})}) {
        const Cut cut = view_cut(source, view, 1'000'000);
        const auto error_on_the_way = [&](auto before) {
            std::vector<CutNode> order = cut.nodes;
            std::ranges::stable_sort(order, before);
            std::set<uint32_t> held;
            double sum = 0;
            for (size_t i = 0; i < order.size(); ++i) {
                held.insert(order[i].node);
                if (i % 16 == 0) sum += spacing_error(source, cut, held, view);
            }
            return sum;
        };
        const double by_priority =
            error_on_the_way([](const CutNode& a, const CutNode& b) { return a.priority > b.priority; });
        const double by_level =
            error_on_the_way([](const CutNode& a, const CutNode& b) { return a.node < b.node; });
        std::printf("error on the way: %.0f by priority, %.0f level by level, %zu nodes\n", by_priority,
                    by_level, cut.nodes.size());
        EXPECT_LT(by_priority, 0.9 * by_level);
    }
}

}  // namespace
}  // namespace lucarne::octree
