#include "gi/gather/places.h"

#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "gi/shared/surfel.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi {
namespace {

constexpr size_t kMost = 64;

/// Returns for each side of each surfel the surfel that gathers for it; kNoSurfel: none.
std::vector<uint32_t> gathering(const std::vector<FlatSurfel>& surfels, const Places& places,
                                const std::vector<uint32_t>& sides) {
    std::vector<uint32_t> result;
    for (const uint32_t side : sides) result.push_back(side == kNoSurfel ? side : places.surfels[side / 2]);
    EXPECT_EQ(result.size(), 2 * surfels.size());
    return result;
}

/// By side of places: nothing is near.
std::vector<float> nothing_near(const Places& places) {
    return std::vector<float>(2 * places.surfels.size(), 0.0f);
}

/// A wall with windows whose panes are a little behind it.
std::vector<FlatSurfel> wall_with_panes() {
    constexpr float kBehind = 0.1f;
    std::vector<FlatSurfel> wall = flat::square(100, 4);
    for (FlatSurfel& s : wall)
        if (std::fmod(s.x, 0.9f) < 0.3f && std::fmod(s.y, 1.1f) < 0.5f) s.z -= kBehind;
    return wall;
}

// One that was drawn from a pane stood for a part of the wall, and had hundreds of times its light.
TEST(Places, SurfelsBelongToPlacesOfTheirOwnSheet) {
    const auto surfels = wall_with_panes();
    const SurfelTree tree = build_tree(surfels);
    const Places places = choose_places(tree, surfels, kMost, 1);
    const auto by = gathering(surfels, places, assign_places(tree, surfels, places, nothing_near(places)));
    size_t apart = 0;
    for (size_t i = 0; i < by.size(); ++i) apart += std::abs(surfels[i / 2].z - surfels[by[i]].z) > 0.05f;
    EXPECT_LT(apart, by.size() / 50);
}

TEST(Places, OppositeSidesOfAWallAreApart) {
    auto surfels = flat::square(60, 2);
    for (FlatSurfel s : flat::square(60, 2)) {
        s.z = -0.05f;
        s.normal = encode_octahedral(-kZ);
        surfels.push_back(s);
    }
    const SurfelTree tree = build_tree(surfels);
    const Places places = choose_places(tree, surfels, kMost, 1);
    const auto by = gathering(surfels, places, assign_places(tree, surfels, places, nothing_near(places)));
    for (size_t i = 0; i < by.size(); ++i) EXPECT_EQ(surfels[by[i]].normal, surfels[i / 2].normal);
}

TEST(Places, SurfelsThatAreTurnedRoundBelongToTheOtherSide) {
    auto surfels = flat::square(60, 2);
    for (size_t i = 0; i < surfels.size(); i += 2) surfels[i].normal = encode_octahedral(-kZ);
    const SurfelTree tree = build_tree(surfels);
    const Places places = choose_places(tree, surfels, kMost, 1);
    const auto sides = assign_places(tree, surfels, places, nothing_near(places));
    for (size_t i = 0; i < sides.size(); ++i) {
        const bool gathers_above =
            (sides[i] % 2 == 0) == (surfels[places.surfels[sides[i] / 2]].normal == encode_octahedral(kZ));
        const bool is_above = (i % 2 == 0) == (surfels[i / 2].normal == encode_octahedral(kZ));
        EXPECT_EQ(gathers_above, is_above) << i;
    }
}

// Light changes within the distance of what shines on it, so what a tape covers, say, is no measure of the
// floor beside it.
TEST(Places, SidesNearOthersGatherForFewUnlessAllAreNear) {
    constexpr float kNear = 1000;  // 1/m
    const auto surfels = flat::square(60, 2);
    const SurfelTree tree = build_tree(surfels);
    const Places places = choose_places(tree, surfels, kMost, 1);
    const auto before = assign_places(tree, surfels, places, nothing_near(places));
    std::vector<float> nearness = nothing_near(places);
    for (size_t i = 0; i < nearness.size(); i += 6) nearness[i] = kNear;  // fronts of every third place
    const auto after = assign_places(tree, surfels, places, nearness);
    size_t changed = 0, own = 0;
    for (size_t i = 0; i < after.size(); ++i) {
        if (nearness[after[i]] == kNear) {
            EXPECT_EQ(places.surfels[after[i] / 2], i / 2) << "a place gathers for itself";
            ++own;
        }
        if (nearness[before[i]] == 0) {
            EXPECT_EQ(after[i], before[i]) << i;
        }
        changed += after[i] != before[i];
    }
    EXPECT_EQ(own, (places.surfels.size() + 2) / 3);
    EXPECT_GT(changed, surfels.size() / 6);
    EXPECT_EQ(assign_places(tree, surfels, places, std::vector<float>(nearness.size(), kNear)), before);
}

TEST(Places, EverySurfelWithADiscHasAPlaceNearIt) {
    auto surfels = flat::noisy_room(20000);
    surfels[7].radius = 0;
    const SurfelTree tree = build_tree(surfels);
    const Places places = choose_places(tree, surfels, 1024, 1);
    const auto by = gathering(surfels, places, assign_places(tree, surfels, places, nothing_near(places)));
    EXPECT_LE(places.surfels.size(), 1024u);
    EXPECT_GE(places.surfels.size(), 256u);
    EXPECT_EQ(std::set(places.surfels.begin(), places.surfels.end()).size(), places.surfels.size());
    for (size_t i = 0; i < by.size(); ++i) {
        if (i / 2 == 7) {
            EXPECT_EQ(by[i], kNoSurfel);
            continue;
        }
        ASSERT_LT(by[i], surfels.size());
        const FlatSurfel &own = surfels[i / 2], &other = surfels[by[i]];
        EXPECT_LT(std::hypot(own.x - other.x, own.y - other.y, own.z - other.z), 0.3f);
    }
}

TEST(Places, NothingHasNoPlaces) {
    const Places places = choose_places({}, {}, kMost, 1);
    EXPECT_TRUE(places.surfels.empty());
    EXPECT_TRUE(assign_places({}, {}, places, {}).empty());
}

}  // namespace
}  // namespace lucarne::gi
