#include "gi/tree/surfel_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "io/core/random.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi {
namespace {

/// Calls visit(slot) for every slot with a child.
void for_each_slot(const SurfelTree& tree, const std::function<void(size_t)>& visit) {
    for (size_t slot = 0; slot < 8 * tree.nodes.size(); ++slot)
        if (tree.nodes[slot / 8].child[slot % 8] != kNoChild) visit(slot);
}

/// Returns the surfels below a slot.
std::vector<uint32_t> surfels_below(const SurfelTree& tree, size_t slot) {
    const int child = tree.nodes[slot / 8].child[slot % 8];
    if (child == kNoChild) return {};
    if (child == kLeafChild) return {tree.surfels[slot]};
    std::vector<uint32_t> found;
    for (size_t k = 0; k < 8; ++k) {
        const auto below = surfels_below(tree, 8 * static_cast<size_t>(child) + k);
        found.insert(found.end(), below.begin(), below.end());
    }
    return found;
}

glm::vec3 middle_of(const SurfelTree& tree, size_t slot) {
    const WideNode& node = tree.nodes[slot / 8];
    return {node.x[slot % 8], node.y[slot % 8], node.z[slot % 8]};
}
glm::vec3 axis_of(const SurfelTree& tree, size_t slot) {
    const WideNode& node = tree.nodes[slot / 8];
    return {node.nx[slot % 8], node.ny[slot % 8], node.nz[slot % 8]};
}

class Trees : public testing::TestWithParam<size_t> {
 protected:
    std::vector<FlatSurfel> surfels() const { return flat::noisy_room(GetParam()); }
};

TEST_P(Trees, HoldEverySurfelOnceAndAreasAddUp) {
    const auto room = surfels();
    const SurfelTree tree = build_tree(room);
    std::vector<int> seen(room.size());
    for_each_slot(tree, [&](size_t slot) {
        if (tree.nodes[slot / 8].child[slot % 8] == kLeafChild) ++seen[tree.surfels[slot]];
        double area = 0;
        for (const uint32_t s : surfels_below(tree, slot)) area += room[s].area;
        EXPECT_NEAR(tree.areas[slot] / area, 1, 1e-4) << slot;
    });
    EXPECT_EQ(std::ranges::count(seen, 1), static_cast<ptrdiff_t>(room.size()));
    EXPECT_EQ(tree.leaves, room.size());
}

TEST_P(Trees, BoundEveryDiscBelow) {
    const auto room = surfels();
    const SurfelTree tree = build_tree(room);
    for_each_slot(tree, [&](size_t slot) {
        const WideNode& node = tree.nodes[slot / 8];
        const float bound = node.bound[slot % 8], thickness = node.thickness[slot % 8];
        for (const uint32_t s : surfels_below(tree, slot)) {
            const glm::vec3 offset = glm::vec3(room[s].x, room[s].y, room[s].z) - middle_of(tree, slot);
            EXPECT_LE(glm::length(offset) + room[s].radius, bound * 1.0001f + 1e-6f) << slot;
            const float cosine = glm::dot(decode_octahedral(room[s].normal), axis_of(tree, slot));
            const float rise = room[s].radius * std::sqrt(std::max(0.0f, 1 - cosine * cosine));
            EXPECT_LE(std::abs(glm::dot(offset, axis_of(tree, slot))) + rise,
                      std::min(bound, thickness) + 1e-3f * bound + 1e-6f);
        }
    });
}

TEST_P(Trees, NodesHaveRoomForNoMore) {
    const SurfelTree tree = build_tree(surfels());
    if (GetParam() >= 1000) {
        EXPECT_LT(static_cast<double>(tree.nodes.size()), 0.22 * static_cast<double>(tree.leaves));
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Trees, testing::Values(1, 2, 7, 8, 9, 100, 5000));

TEST(SurfelTree, OfNothingIsEmpty) {
    EXPECT_TRUE(build_tree({}).empty());
    EXPECT_TRUE(pull_light(build_tree({}), {}).empty());
}

TEST(SurfelTree, LeavesOutWhatHasNoDisc) {
    auto room = flat::noisy_room(100);
    room[3].x = std::numeric_limits<float>::quiet_NaN();
    room[5].radius = 0;
    room[7].radius = std::numeric_limits<float>::infinity();
    room[9].albedo &= ~kSurfelHasNormal;
    room[11].z = std::numeric_limits<float>::infinity();
    EXPECT_EQ(build_tree(room).leaves, 95u);
}

TEST(SurfelTree, DividesSurfelsAtOnePlaceEvenly) {
    const std::vector<FlatSurfel> heap(100000, flat::noisy_room(1).front());
    const SurfelTree tree = build_tree(heap);
    EXPECT_EQ(tree.leaves, heap.size());
    EXPECT_LE(tree.levels.size(), 8u);
}

TEST(SurfelTree, PullsTheMeanOfEvenLight) {
    const auto room = flat::noisy_room(3000);
    const SurfelTree tree = build_tree(room);
    const auto slots = pull_light(tree, std::vector<SideLight>(room.size(), {glm::vec3(2), glm::vec3(2)}));
    for_each_slot(tree, [&](size_t slot) {
        EXPECT_NEAR(slots[slot].front.x, 2, 1e-4);
        EXPECT_NEAR(slots[slot].back.x, 2, 1e-4);
    });
}

// A wall that was scanned from two rooms is two sheets. Seen from afar it is one node, and each room sees the
// light of its own sheet, not the mean with the inside of the wall.
TEST(SurfelTree, NodeOfTwoSheetsShinesWithTheOuterSides) {
    std::vector<FlatSurfel> wall;
    std::vector<SideLight> light;
    for (int sheet = 0; sheet < 2; ++sheet)
        for (const FlatSurfel& s : flat::square(20, 1.0f)) {
            wall.push_back(s);
            wall.back().z = sheet ? 0.1f : 0.0f;
            wall.back().normal = encode_octahedral({0, 0, sheet ? 1 : -1});
            light.push_back({glm::vec3(sheet ? 3 : 1), glm::vec3(0)});
        }
    const SurfelTree tree = build_tree(wall);
    const auto slots = pull_light(tree, light);
    for_each_slot(tree, [&](size_t slot) {
        const auto below = surfels_below(tree, slot);
        const auto upper = std::ranges::count_if(below, [&](uint32_t s) { return wall[s].z > 0; });
        if (2 * upper != static_cast<ptrdiff_t>(below.size())) return;
        const bool up = axis_of(tree, slot).z > 0;
        EXPECT_NEAR((up ? slots[slot].front : slots[slot].back).x, 3, 0.3) << slot;
        EXPECT_NEAR((up ? slots[slot].back : slots[slot].front).x, 1, 0.1) << slot;
    });
}

TEST(SurfelTree, IsTheSameForEveryNumberOfThreads) {
    const auto room = flat::noisy_room(20000);
    const SurfelTree many = build_tree(room);
    const ThreadLimit one(1);
    const SurfelTree single = build_tree(room);
    ASSERT_EQ(many.nodes.size(), single.nodes.size());
    EXPECT_EQ(std::memcmp(many.nodes.data(), single.nodes.data(), many.nodes.size() * sizeof(WideNode)), 0);
    EXPECT_EQ(many.surfels, single.surfels);
}

}  // namespace
}  // namespace lucarne::gi
