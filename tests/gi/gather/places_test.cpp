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
    const Places places = choose_places(build_tree(surfels), surfels, kMost, 1);
    size_t apart = 0;
    for (size_t i = 0; i < surfels.size(); ++i)
        apart += std::abs(surfels[i].z - surfels[places.surfels[places.place_of[i]]].z) > 0.05f;
    EXPECT_LT(apart, surfels.size() / 50);
}

TEST(Places, OppositeSidesOfAWallAreApart) {
    auto surfels = flat::square(60, 2);
    for (FlatSurfel s : flat::square(60, 2)) {
        s.z = -0.05f;
        s.normal = encode_octahedral(-kZ);
        surfels.push_back(s);
    }
    const Places places = choose_places(build_tree(surfels), surfels, kMost, 1);
    for (size_t i = 0; i < surfels.size(); ++i)
        EXPECT_EQ(surfels[places.surfels[places.place_of[i]]].normal, surfels[i].normal);
}

TEST(Places, EverySurfelWithADiscHasAPlaceNearIt) {
    auto surfels = flat::noisy_room(20000);
    surfels[7].radius = 0;
    const Places places = choose_places(build_tree(surfels), surfels, 1024, 1);
    EXPECT_LE(places.surfels.size(), 1024u);
    EXPECT_GE(places.surfels.size(), 256u);
    EXPECT_EQ(std::set(places.surfels.begin(), places.surfels.end()).size(), places.surfels.size());
    for (size_t i = 0; i < surfels.size(); ++i) {
        if (i == 7) {
            EXPECT_EQ(places.place_of[i], kNoSurfel);
            continue;
        }
        ASSERT_LT(places.place_of[i], places.surfels.size());
        const FlatSurfel &own = surfels[i], &other = surfels[places.surfels[places.place_of[i]]];
        EXPECT_LT(std::hypot(own.x - other.x, own.y - other.y, own.z - other.z), 0.3f);
    }
}

TEST(Places, NothingHasNoPlaces) {
    const Places places = choose_places({}, {}, kMost, 1);
    EXPECT_TRUE(places.surfels.empty());
}

}  // namespace
}  // namespace lucarne::gi
