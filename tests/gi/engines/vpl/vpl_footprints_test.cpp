// Footprints of VPLs are cut down to the area clear of walls.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "gi/engines/vpl/footprints.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

constexpr float kSide = 2;

class VplFootprints : public OnDevice {
 protected:
    /// Returns what is left of a footprint of `area` at (x, y) on the floor of a closed box.
    float trimmed(float x, float y, float area, float shrink) {
        VplLight light = kDeadLight;
        light.position = {x, y, 0, area};
        light.normal = {0, 0, 1, .005f};
        const SurfelCloud cloud(scenes::closed_box(kSide, 200, glm::vec3(.5f)));
        auto loaded = load_cloud(*device, cloud);
        EXPECT_TRUE(loaded);
        Seeds seeds;
        seeds.host_lights = {light};
        seeds.lights = *device->buffer(sizeof(VplLight), "lights");
        seeds.lights.upload_all(seeds.host_lights);
        PassTimes times(*device);
        ShadowMaps maps;
        const auto layout = atlas_layout(128, 1);
        EXPECT_TRUE(decode_casters(*device, (*loaded)->cut, maps));
        EXPECT_TRUE(draw_shadow_maps(*device, (*loaded)->cut, seeds, *layout, false, times, maps));
        EXPECT_TRUE(trim_footprints(*device, maps, shrink, seeds));
        return seeds.lights.download_all<VplLight>(1)[0].position.w;
    }
};

/// Returns the part of a disc of that area about (x, y) that lies on the floor.
double inside(double x, double y, double area) {
    const double radius = std::sqrt(area / std::numbers::pi);
    constexpr int kSteps = 4000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = 2 * std::numbers::pi * (i + .5) / kSteps;
        const double c = std::cos(angle), s = std::sin(angle);
        const double wall =
            std::min((c > 0 ? kSide - x : x) / std::abs(c), (s > 0 ? kSide - y : y) / std::abs(s));
        const double reach = std::min(radius, wall);
        sum += reach * reach * std::numbers::pi / kSteps;
    }
    return sum;
}

TEST_F(VplFootprints, thoseThatFitStayAsTheyAre) {
    EXPECT_NEAR(trimmed(1, 1, .5f, 1), .5f, .005f);
}

TEST_F(VplFootprints, thoseBesideWallsAreCutOffThere) {
    EXPECT_NEAR(trimmed(.1f, 1, 2, 1) / inside(.1, 1, 2), 1, .05);
    EXPECT_NEAR(trimmed(.1f, .2f, 2, 1) / inside(.1, .2, 2), 1, .05);
}

TEST_F(VplFootprints, framesThatAreAveragedHaveSmallerOnes) {
    EXPECT_NEAR(trimmed(1, 1, .5f, .25f), .125f, .002f);
}

}  // namespace
}  // namespace lucarne::gi::vpl
