#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/scene.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;
using testing::HasSubstr;

constexpr const char* kWhole = R"({
  "exposure": {"ev": -1.5, "tone_map": "reinhard"},
  "background": [0.1, 0.2, 0.3],
  "lighting_region": {"min": [500000.25, 0, 0], "max": [500002, 1, 2]},
  "lights": [
    {"type": "spot", "name": "a", "position": [1, 2, 3], "target": [1, 2, 0], "angle": 90, "softness": 0.5, "intensity": [10, 20, 30]},
    {"type": "spot", "position": [500000.25, 5000000.5, 100], "direction": [0, 1, 0], "intensity": [1, 1, 1]}],
  "materials": [
    {"name": "brass", "diffuse": [0.5, 0.4, 0.3], "specular": 0.4, "shininess": 80, "class": 6, "scan": 2,
     "box": {"min": [0, 0, 0], "max": [1, 2, 3]}},
    {"name": "all", "emission": [0.5, 0.5, 0.5]}],
  "cameras": [{"name": "front", "position": [0, -5, 1], "target": [0, 0, 1], "up": [0, 0, 2], "fov": 45}]
})";

TEST(SceneFile, EveryKeyArrives) {
    const auto scene = parse_scene(kWhole, "whole.json");
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(scene->exposure_ev, -1.5);
    EXPECT_EQ(scene->tone_map, ToneMap::reinhard);
    EXPECT_EQ(scene->background, dvec3(.1, .2, .3));
    EXPECT_EQ(scene->lighting_region, SceneBox(dvec3(500000.25, 0, 0), dvec3(500002, 1, 2)));
    ASSERT_EQ(scene->lights.size(), 2u);
    EXPECT_EQ(scene->lights[0].name, "a");
    EXPECT_EQ(scene->lights[0].position, dvec3(1, 2, 3));
    EXPECT_EQ(scene->lights[0].target, dvec3(1, 2, 0));
    EXPECT_DOUBLE_EQ(scene->lights[0].angle, M_PI / 2);
    EXPECT_EQ(scene->lights[0].softness, .5);
    EXPECT_EQ(scene->lights[0].strength, dvec3(10, 20, 30));
    EXPECT_EQ(scene->lights[1].target, dvec3(500000.25, 5000001.5, 100));  // exact: never converted to float
    ASSERT_EQ(scene->materials.size(), 2u);
    EXPECT_EQ(scene->materials[0].name, "all");  // the default has no condition; it may stand anywhere
    EXPECT_EQ(scene->materials[0].emission, dvec3(.5));
    EXPECT_EQ(scene->materials[1].diffuse, dvec3(.5, .4, .3));
    EXPECT_EQ(scene->materials[1].specular, .4);
    EXPECT_EQ(scene->materials[1].shininess, 80);
    EXPECT_EQ(scene->materials[1].classification, 6);
    EXPECT_EQ(scene->materials[1].scan, 2);
    EXPECT_EQ(scene->materials[1].box->second, dvec3(1, 2, 3));
    ASSERT_EQ(scene->cameras.size(), 1u);
    EXPECT_EQ(scene->cameras[0].name, "front");
    EXPECT_EQ(scene->cameras[0].up, dvec3(0, 0, 2));
    EXPECT_DOUBLE_EQ(scene->cameras[0].vertical_fov, M_PI / 4);
}

TEST(SceneFile, WhatIsLeftOutHasItsDocumentedDefault) {
    const auto scene = parse_scene("{}", "empty.json");
    ASSERT_TRUE(scene);
    EXPECT_FALSE(scene->exposure_ev);
    EXPECT_EQ(scene->tone_map, ToneMap::filmic);
    EXPECT_EQ(scene->background, dvec3(0));
    EXPECT_TRUE(scene->lights.empty());
    EXPECT_TRUE(scene->cameras.empty());
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->materials[0].diffuse, dvec3(1));
    EXPECT_EQ(scene->materials[0].specular, 0);

    const auto spot = parse_scene(
        R"({"lights": [{"type": "spot", "position": [0,0,3], "target": [0,0,0], "intensity": [1,1,1]}]})",
        "s.json");
    ASSERT_TRUE(spot);
    EXPECT_DOUBLE_EQ(spot->lights[0].angle, glm::radians(60.0));
    EXPECT_EQ(spot->lights[0].softness, .1);
}

struct Mistake {
    const char* text;
    const char* place;  ///< what the message must contain
    const char* reason;
};

TEST(SceneFile, EveryMistakeIsReportedWithItsPlace) {
    const char* const light = R"("type":"spot","position":[0,0,1],"intensity":[1,1,1])";
    const std::string two_aims =
        fmt::format(R"({{"lights":[{{{},"target":[0,0,0],"direction":[0,0,1]}}]}})", light);
    const std::string no_aim = fmt::format(R"({{"lights":[{{{}}}]}})", light);
    const std::string nowhere = fmt::format(R"({{"lights":[{{{},"target":[0,0,1]}}]}})", light);
    const std::string wide = fmt::format(R"({{"lights":[{{{},"target":[0,0,0],"angle":180}}]}})", light);
    const std::string colour = fmt::format(R"({{"lights":[{{{},"target":[0,0,0],"color":1}}]}})", light);
    std::string many_lights = R"({"lights":[)", many_materials = R"({"materials":[)";
    for (int i = 0; i < 65; ++i) many_lights += i ? ",{}" : "{}";
    for (int i = 0; i < 256; ++i) many_materials += i ? ",{}" : "{}";
    many_lights += "]}", many_materials += "]}";
    const Mistake mistakes[] = {
        {"{\n  \"lights\": [\n  }\n", "line 3, column 3", ""},
        {"", "line 1, column 1", ""},
        {"{\"background\": [0,0,NaN]}", "line 1, column 21", ""},
        {"[]", "the whole document", "object"},
        {R"({"light": []})", "/light", "not a known key"},
        {R"({"lights": {}})", "/lights", ""},
        {R"({"lights": [3]})", "/lights/0", "object"},
        {R"({"lights": [{"type": "lamp"}]})", "/lights/0/type", "spot"},
        {R"({"lights": [{"type": "spot"}]})", "/lights/0", "position"},
        {R"({"lights": [{"type": "spot", "position": [0,0]}]})", "/lights/0/position", "three numbers"},
        {R"({"lights": [{"type": "spot", "position": [0,0,"1"]}]})", "/lights/0/position", "three numbers"},
        {R"({"lights": [{"type": "spot", "position": [0,0,1], "target": [0,0,0], "intensity": [-1,0,0]}]})",
         "/lights/0/intensity", "from 0"},
        {two_aims.c_str(), "/lights/0/direction", "not both"},
        {no_aim.c_str(), "/lights/0", "target"},
        {nowhere.c_str(), "/lights/0/target", "nowhere"},
        {wide.c_str(), "/lights/0/angle", "170"},
        {colour.c_str(), "/lights/0/color", "not a known key"},
        {many_lights.c_str(), "/lights", "64"},
        {many_materials.c_str(), "/materials", "255"},
        {R"({"exposure": {"ev": "bright"}})", "/exposure/ev", "number"},
        {R"({"exposure": {"tone_map": "aces"}})", "/exposure/tone_map", "filmic"},
        {R"({"exposure": {"white": [1, 0, 1]}})", "/exposure/white", "0.001"},
        {R"({"exposure": {"eV": 1}})", "/exposure/eV", "not a known key"},
        {R"({"background": [0, 0, 1e13]})", "/background", ""},
        {R"({"materials": [{"specular": 1.5}]})", "/materials/0/specular", "from 0 to 1"},
        {R"({"materials": [{"class": 256}]})", "/materials/0/class", "255"},
        {R"({"materials": [{"class": 2.5}]})", "/materials/0/class", "integer"},
        {R"({"materials": [{"scan": -1}]})", "/materials/0/scan", "65535"},
        {R"({"lighting_region": {"min": [0,0,1], "max": [1,1,0]}})", "/lighting_region/max", "below"},
        {R"({"materials": [{"box": {"min": [0,0,0]}}]})", "/materials/0/box", "max"},
        {R"({"materials": [{"box": {"min": [0,0,1], "max": [1,1,0]}}]})", "/materials/0/box/max", "below"},
        {R"({"materials": [{"box": {"min": [0,0,0], "max": [1,1,1], "mid": 0}}]})", "/materials/0/box/mid",
         "not a known key"},
        {R"({"materials": [{}, {"class": 1}, {}]})", "/materials/2", "second"},
        {R"({"cameras": [{"position": [0,0,0], "target": [0,1,0]}]})", "/cameras/0", "name"},
        {R"({"cameras": [{"name": "a", "position": [0,0,0], "target": [0,0,0]}]})", "/cameras/0/target",
         "stands"},
        {R"({"cameras": [{"name": "a", "position": [0,0,9], "target": [0,0,0]}]})", "/cameras/0/target",
         "up"},
        {R"({"cameras": [{"name": "a", "position": [0,0,0], "target": [0,1,0], "up": [0,0,0]}]})",
         "/cameras/0/up", "up"},
        {R"({"cameras": [{"name": "a", "position": [0,0,0], "target": [0,1,0], "fov": 0}]})",
         "/cameras/0/fov", "1 to 170"},
        {R"({"cameras": [{"name": "a", "position": [0,0,0], "target": [0,1,0]}, {"name": "a", "position": [0,0,0], "target": [0,1,0]}]})",
         "/cameras/1/name", "second"},
    };
    for (const auto& [text, place, reason] : mistakes) {
        const auto scene = parse_scene(text, "bad.json");
        ASSERT_FALSE(scene) << text;
        EXPECT_EQ(scene.error().kind, ErrorKind::input_rejected) << text;
        EXPECT_EQ(scene.error().what, "bad.json") << text;
        EXPECT_THAT(scene.error().why, HasSubstr(place)) << text;
        EXPECT_THAT(scene.error().why, HasSubstr(reason)) << text;
    }
}

TEST(SceneFile, AFileThatIsNotThereIsAnError) {
    const auto scene = load_scene("/nonexistent/scene.json");
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().line(), HasSubstr("/nonexistent/scene.json"));
}

TEST(SceneFile, TheScenesOfThisRepositoryLoad) {
    for (const char* name : {"cornell", "furnace", "nave", "two-rooms", "house", "statue", "ring",
                             "paraboloid", "cornell-glossy", "statue-sky", "survey-sky", "primitives-sky",
                             "loft-lamps", "loft-day", "lattice", "arbour"}) {
        const auto scene = load_scene(std::string(LUCARNE_SOURCE_DIR) + "/data/scenes/" + name + ".json");
        ASSERT_TRUE(scene) << scene.error().line();
        EXPECT_FALSE(scene->cameras.empty()) << name;
    }
}

/// Returns how far from the middle of the picture a point appears: 1 at the nearest edge of the picture,
/// infinite behind the camera.
double place(const SceneCamera& camera, const dvec3& point, double aspect) {
    const dvec3 forward = glm::normalize(camera.target - camera.position);
    const dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
    const dvec3 to = point - camera.position;
    const double depth = dot(to, forward), limit = depth * std::tan(camera.vertical_fov / 2);
    if (!(depth > 0)) return std::numeric_limits<double>::infinity();
    return std::max(std::abs(dot(to, right)) / aspect, std::abs(dot(to, up))) / limit;
}

TEST(DefaultScene, TheBoxFillsThePictureOfAnyShape) {
    const dvec3 min(-6, 0, 0), max(6, 30, 15);
    for (const double aspect : {0.4, 1.0, 16.0 / 9, 3.0}) {
        const Scene scene = default_scene(min, max, 1, aspect);
        double farthest = 0;
        for (int corner = 0; corner < 8; ++corner)
            farthest = std::max(farthest, place(scene.cameras[0],
                                                {corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y,
                                                 corner & 4 ? max.z : min.z},
                                                aspect));
        EXPECT_GT(farthest, 0.9) << aspect;
        EXPECT_LT(farthest, 1) << aspect;
    }
}

TEST(DefaultScene, CameraAndSpotTakeInTheWholeBox) {
    const std::pair<dvec3, dvec3> boxes[] = {{dvec3(0), dvec3(1)},
                                             {dvec3(-6, 0, 0), dvec3(6, 30, 15)},
                                             {dvec3(499990, 5.2e6, 300), dvec3(500010, 5.2e6 + 1, 301)},
                                             {dvec3(3), dvec3(3)}};
    for (const auto& [min, max] : boxes) {
        const Scene scene = default_scene(min, max);
        ASSERT_EQ(scene.cameras.size(), 1u);
        ASSERT_EQ(scene.lights.size(), 1u);
        ASSERT_EQ(scene.materials.size(), 1u);
        const SceneLight& spot = scene.lights[0];
        for (int corner = 0; corner < 8; ++corner) {
            const dvec3 p(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z);
            EXPECT_LT(place(scene.cameras[0], p, 4.0 / 3), 1);
            const double cosine =
                dot(glm::normalize(spot.target - spot.position), glm::normalize(p - spot.position));
            EXPECT_GE(cosine, std::cos(spot.angle / 2));
        }
        // A surface in the middle that faces the light at 45 degrees must be 18 % grey.
        const double distance = glm::length(spot.target - spot.position);
        EXPECT_NEAR(.5 / M_PI * spot.strength.x * M_SQRT1_2 / (distance * distance), .18, 1e-9);
    }
    // With feet as the unit the light must be the same in metres.
    const Scene metres = default_scene(dvec3(0), dvec3(1)),
                feet = default_scene(dvec3(0), dvec3(1 / .3048), .3048);
    EXPECT_NEAR(feet.lights[0].strength.x, metres.lights[0].strength.x, 1e-9);
}

TEST(DefaultScene, AnEmptyBoxStillGivesAFinitePicture) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double bad : {kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
        const Scene scene = default_scene(dvec3(bad), dvec3(-bad));
        EXPECT_TRUE(std::isfinite(glm::length(scene.cameras[0].position)));
        EXPECT_TRUE(std::isfinite(scene.lights[0].strength.x));
    }
}

}  // namespace
}  // namespace lucarne::gi
