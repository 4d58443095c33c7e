#include "octree/stations/lone_station.h"

#include <gtest/gtest.h>

#include "tests/octree/holes/room_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;

/// A room with furniture, and without stations in the sample.
HoleSample silent_room(const std::vector<glm::vec3>& stations, int columns = 700) {
    std::vector<Wall> walls;
    add_box(walls, glm::vec3(0), {6, 5, 3}, true);
    add_box(walls, {4, 1, 0}, {4.6f, 1.6f, 1.4f}, false);
    add_box(walls, {1, 4, 0}, {3, 4.4f, 1}, false);
    add_box(walls, {0, 0.5f, 1.1f}, {6, 0.55f, 1.15f}, false);  // a rail
    HoleSample sample = scan_walls(walls, stations, columns);
    sample.stations.clear();
    for (HolePoint& point : sample.points) point.station = -1;
    return sample;
}

std::vector<glm::vec3> positions(const HoleSample& sample) {
    std::vector<glm::vec3> all;
    for (const HolePoint& point : sample.points) all.push_back(point.position);
    return all;
}

TEST(LoneStation, StandsWhereNoPointHidesAnother) {
    for (const glm::vec3& station : {glm::vec3(2.6f, 2.2f, 1.5f), glm::vec3(3.1f, 2.8f, 1.9f)}) {
        const HoleSample sample = silent_room({station});
        const auto found = find_holes(sample);
        ASSERT_EQ(found.tripods.size(), 1u);
        const auto at = find_lone_station(positions(sample), found.tripods.front());
        ASSERT_TRUE(at);
        EXPECT_LT(glm::distance(*at, station), 0.1f) << at->x << " " << at->y << " " << at->z;
    }
}

/// Of 500 000 points a dozen are hidden from the station, and some hundred from other places.
TEST(LoneStation, IsFoundInFineScansInWhichLittleIsHidden) {
    for (const glm::vec3& station :
         {glm::vec3(2.6f, 2.2f, 1.5f), glm::vec3(2, 3, 1.7f), glm::vec3(3.5f, 2.5f, 1.6f)}) {
        const auto at = find_lone_station(positions(silent_room({station}, 1300)), {station.x, station.y, 0});
        ASSERT_TRUE(at) << station.x;
        EXPECT_LT(glm::distance(*at, station), 0.1f) << at->x << " " << at->y << " " << at->z;
    }
}

TEST(LoneStation, SeveralStationsAreNone) {
    const HoleSample sample = silent_room({{1.6f, 2.2f, 1.5f}, {4.6f, 3.5f, 1.5f}});
    for (const glm::vec2& below : {glm::vec2(1.6f, 2.2f), glm::vec2(4.6f, 3.5f), glm::vec2(3, 3)})
        EXPECT_FALSE(find_lone_station(positions(sample), {below, 0})) << below.x;
}

TEST(LoneStation, BadInputShowsNone) {
    EXPECT_FALSE(find_lone_station({}, glm::vec3(0)));
    const std::vector<glm::vec3> same(50000, glm::vec3(1, 2, 3));
    EXPECT_FALSE(find_lone_station(same, {1, 2, 1}));
    std::vector<glm::vec3> floor, noise;
    Random random(1);
    const auto any = [&] { return static_cast<float>(8 * random.uniform()); };
    for (int i = 0; i < 50000; ++i) {
        const float x = any(), y = any(), z = any();
        floor.emplace_back(x, y, 0);
        noise.emplace_back(x, y, z);
    }
    EXPECT_FALSE(find_lone_station(floor, {4, 4, 0})) << "every place over a plane sees all of it";
    EXPECT_FALSE(find_lone_station(noise, {4, 4, 0}));
    noise[7] = glm::vec3(std::numeric_limits<float>::infinity());
    noise[9] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    EXPECT_FALSE(find_lone_station(noise, {4, 4, 0}));
}

}  // namespace
}  // namespace lucarne::octree
