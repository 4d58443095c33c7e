#include "octree/stream/motion.h"

#include <cmath>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "octree/stream/residency.h"
#include "tests/octree/plane_source.h"

namespace lucarne::octree {
namespace {

using test::PlaneSource;

/// A view at `place`, turned by `angle` from +x in the plane.
View at(const glm::dvec3& place, double angle) {
    View view;
    view.position = place;
    view.forward = {std::cos(angle), std::sin(angle), 0};
    view.right = {std::sin(angle), -std::cos(angle), 0};
    view.up = {0, 0, 1};
    view.tan_half_width = view.tan_half_height = 0.5;
    view.width = view.height = 512;
    return view;
}

TEST(Motion, GoesOnAsItDidInPlaceAndDirection) {
    Motion motion;
    const auto frame = [](double n) { return at({3 + 0.2 * n, 1 - 0.1 * n, 2}, 0.03 * n); };
    for (int n = 0; n < 5; ++n) motion.observe(frame(n));
    const auto ahead = motion.ahead(10);
    ASSERT_TRUE(ahead);
    const View there = frame(14);
    EXPECT_LT(glm::distance(ahead->position, there.position), 1e-9);
    EXPECT_LT(glm::distance(ahead->forward, there.forward), 1e-3);
    EXPECT_NEAR(glm::length(ahead->right), 1, 1e-12);
    EXPECT_NEAR(glm::dot(ahead->right, ahead->forward), 0, 1e-9);
}

TEST(Motion, OfACameraThatStandsOrHasJumpedIsUnknown) {
    Motion motion;
    EXPECT_FALSE(motion.ahead(5));
    motion.observe(at({0, 0, 0}, 0));
    EXPECT_FALSE(motion.ahead(5));
    motion.observe(at({0, 0, 0}, 0));
    motion.observe(at({0, 0, 0}, 0));
    EXPECT_FALSE(motion.ahead(5)) << "the camera stands still";
    motion.observe(at({1, 0, 0}, 0));
    EXPECT_TRUE(motion.ahead(5));
    motion.forget();
    EXPECT_FALSE(motion.ahead(5));
}

/// Flies a camera over a plane. After each frame there is time to load `loads_a_frame` nodes. Returns how
/// many wanted nodes were missing in their frames.
size_t missing_along_a_flight(bool prefetch, size_t loads_a_frame) {
    const PlaneSource source(7, 500, 100.0);
    Motion motion;
    std::set<uint32_t> held;
    size_t missing = 0;
    for (int n = 0; n < 60; ++n) {
        View view = at({10 + 0.5 * n, 50, 6}, 0);
        view.forward = {0, 0, -1};
        view.right = {1, 0, 0};
        view.up = {0, 1, 0};
        motion.observe(view);
        const Cut cut = view_cut(source, view, 1'000'000);
        std::vector<std::pair<float, uint32_t>> wanted;
        for (const CutNode& node : cut.nodes)
            if (!held.contains(node.node)) wanted.emplace_back(1e10f + node.priority, node.node);
        if (n > 5) missing += wanted.size();
        if (const auto there = motion.ahead(6); there && prefetch)
            for (const CutNode& node : view_cut(source, *there, 1'000'000).nodes)
                if (!held.contains(node.node)) wanted.emplace_back(node.priority, node.node);
        std::ranges::sort(wanted, std::greater<>());
        for (size_t i = 0; i < std::min(loads_a_frame, wanted.size()); ++i) held.insert(wanted[i].second);
        if (n == 5)
            for (const CutNode& node : cut.nodes) held.insert(node.node);
    }
    return missing;
}

TEST(Motion, WhatIsLoadedAheadIsThereWhenItIsSeen) {
    const size_t without = missing_along_a_flight(false, 12), with = missing_along_a_flight(true, 12);
    std::printf("nodes missing in their frame: %zu without, %zu with prefetching\n", without, with);
    EXPECT_GT(without, 50u);
    EXPECT_LT(with, without / 4);
}

}  // namespace
}  // namespace lucarne::octree
