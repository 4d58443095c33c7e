#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/scene.h"
#include "io/image/image.h"
#include "tests/temporary_folder.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;
using testing::HasSubstr;

class SceneLights : public ::testing::Test {
 protected:
    test::Folder files;
    const std::filesystem::path& folder = files.path();
};

TEST_F(SceneLights, EveryKindArrivesWithItsOwnKeys) {
    const auto scene = parse_scene(R"({"lights": [
      {"type": "point", "position": [1, 2, 3], "intensity": [4, 5, 6]},
      {"type": "directional", "direction": [0, 3, -4], "irradiance": [7, 8, 9], "angular_radius": 0.265},
      {"type": "rectangle", "position": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "width": 2,
       "height": 0.5, "radiance": [10, 11, 12]},
      {"type": "disc", "position": [0, 0, 3], "direction": [0, 0, -1], "radius": 0.25,
       "radiance": [1, 2, 3]}]})",
                                   "kinds.json");
    ASSERT_TRUE(scene) << scene.error().line();
    ASSERT_EQ(scene->lights.size(), 4u);
    const auto& [point, sun, rectangle, disc] =
        std::tie(scene->lights[0], scene->lights[1], scene->lights[2], scene->lights[3]);
    EXPECT_EQ(point.kind, LightKind::point);
    EXPECT_EQ(point.position, dvec3(1, 2, 3));
    EXPECT_EQ(point.strength, dvec3(4, 5, 6));
    EXPECT_EQ(sun.kind, LightKind::directional);
    EXPECT_EQ(sun.target - sun.position, dvec3(0, 3, -4));
    EXPECT_EQ(sun.strength, dvec3(7, 8, 9));
    EXPECT_DOUBLE_EQ(sun.angular_radius, glm::radians(.265));
    EXPECT_EQ(rectangle.kind, LightKind::rectangle);
    EXPECT_EQ(rectangle.up, dvec3(0, 1, 0));
    EXPECT_EQ(rectangle.width, 2);
    EXPECT_EQ(rectangle.height, .5);
    EXPECT_EQ(rectangle.strength, dvec3(10, 11, 12));
    EXPECT_EQ(disc.kind, LightKind::disc);
    EXPECT_EQ(disc.radius, .25);
    EXPECT_EQ(disc.target, dvec3(0, 0, 2));
    EXPECT_EQ(disc.strength, dvec3(1, 2, 3));
}

TEST_F(SceneLights, MistakesAreReportedWithTheirPlace) {
    const std::tuple<const char*, const char*, const char*> mistakes[] = {
        {R"({"lights": [{"type": "laser"}]})", "/lights/0/type", "directional"},
        {R"({"lights": [{"type": "point", "position": [0,0,0]}]})", "/lights/0", "intensity"},
        {R"({"lights": [{"type": "point", "position": [0,0,0], "intensity": [1,1,1], "target": [0,0,1]}]})",
         "/lights/0/target", "not a known key"},
        {R"({"lights": [{"type": "directional", "direction": [0,0,0], "irradiance": [1,1,1]}]})",
         "/lights/0/direction", "nowhere"},
        {R"({"lights": [{"type": "directional", "direction": [0,0,1], "irradiance": [1,1,1], "angular_radius": 91}]})",
         "/lights/0/angular_radius", "90"},
        {R"({"lights": [{"type": "rectangle", "position": [0,0,0], "direction": [0,0,1], "width": 0, "height": 1, "radiance": [1,1,1]}]})",
         "/lights/0/width", "from"},
        {R"({"lights": [{"type": "disc", "position": [0,0,0], "radius": 1, "radiance": [1,1,1]}]})",
         "/lights/0", "target"},
        {R"({"environment": {}})", "/environment", "radiance or an image"},
        {R"({"environment": {"radiance": [1,1,1], "rotation": 400}})", "/environment/rotation", "360"},
        {R"({"environment": {"radiance": [1,1,1]}, "background": [0,0,0]})", "/background", "environment"},
        {R"({"environment": {"image": "nothing.exr"}})", "/environment/image", "nothing.exr"},
    };
    for (const auto& [text, place, reason] : mistakes) {
        const auto scene = parse_scene(text, "bad.json", folder);
        ASSERT_FALSE(scene) << text;
        EXPECT_EQ(scene.error().kind, ErrorKind::input_rejected) << text;
        EXPECT_THAT(scene.error().line(), HasSubstr(place)) << text;
        EXPECT_THAT(scene.error().line(), HasSubstr(reason)) << text;
    }
}

TEST_F(SceneLights, UniformEnvironmentIsTheSameInEveryDirection) {
    const auto scene = parse_scene(R"({"environment": {"radiance": [1, 2, 3]}})", "e.json");
    ASSERT_TRUE(scene) << scene.error().line();
    for (const auto& d : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0)})
        EXPECT_EQ(scene->environment->radiance(d), glm::vec3(1, 2, 3));
}

TEST_F(SceneLights, EnvironmentPictureHasTheZenithOnTopAndYInTheMiddle) {
    io::Image image{8, 4, std::vector<glm::vec4>(32, glm::vec4(0, 0, 0, 1))};
    const auto put = [&](uint32_t x, uint32_t y, float value) { image.pixels[y * 8 + x].x = value; };
    for (uint32_t x = 0; x < 8; ++x) put(x, 0, 1), put(x, 3, 2);
    put(4, 1, 3);  // just right of the middle, above the horizon
    put(6, 2, 4);  // 90 degrees to the right, below it
    ASSERT_TRUE(io::write_exr(folder / "sky.exr", image, true));
    const auto radiance = [&](const char* rotation, const glm::vec3& direction) {
        const auto scene = parse_scene(
            fmt::format(R"({{"environment": {{"image": "sky.exr", "radiance": [10,1,1], "rotation": {}}}}})",
                        rotation),
            "e.json", folder);
        EXPECT_TRUE(scene) << scene.error().line();
        return scene ? scene->environment->radiance(glm::normalize(direction)).x : -1;
    };
    EXPECT_EQ(radiance("0", {0, 0, 1}), 10);
    EXPECT_EQ(radiance("0", {0, 0, -1}), 20);
    EXPECT_EQ(radiance("0", {.1f, 1, .1f}), 30);
    EXPECT_EQ(radiance("0", {-.1f, 1, .1f}), 0);
    EXPECT_EQ(radiance("0", {1, -.1f, -.1f}), 40);
    EXPECT_EQ(radiance("90", {-1, .1f, .1f}), 30);  // a quarter turn counterclockwise takes +y to -x
}

TEST_F(SceneLights, EnvironmentThatIsNoPictureOrNotFiniteIsRejected) {
    io::Image image{4, 2, std::vector<glm::vec4>(8, glm::vec4(1))};
    image.pixels[6].y = std::numeric_limits<float>::infinity();
    ASSERT_TRUE(io::write_exr(folder / "infinite.exr", image, true));
    auto scene = parse_scene(R"({"environment": {"image": "infinite.exr"}})", "e.json", folder);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().line(), HasSubstr("pixel (2, 1)"));
    image.pixels[6].y = -1;  // negative values, as filters leave them
    ASSERT_TRUE(io::write_exr(folder / "negative.exr", image, true));
    scene = parse_scene(R"({"environment": {"image": "negative.exr"}})", "e.json", folder);
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(scene->environment->texels[6], glm::vec3(1, 0, 1));
    EXPECT_FALSE(io::read_exr(folder / "negative.exr", 7)) << "a limit below its 8 pixels";
}

}  // namespace
}  // namespace lucarne::gi
