#include "gi/scene/look_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/scene.h"

namespace lucarne::gi {
namespace {

using testing::HasSubstr;

Result<Look> parse(const std::string& look) {
    LUCARNE_ASSIGN(const Scene scene, parse_scene("{\"look\": " + look + "}", "test.json"));
    return scene.look;
}

constexpr const char* kWholeLook = R"({
  "colour": "attribute", "attribute": "gps_time", "map": "cool-warm", "reversed": true,
  "range": {"low": 1.5, "high": -2}, "hidden_classes": [7, 18], "point_size": 2, "point_pixels": 3,
  "outliers": 2, "single_discs": true,
  "shading": "occlusion", "shading_strength": 0.5, "brightness": 2, "eye_dome_pixels": 3, "occlusion_reach": 6,
  "backdrop": {"top": [0.1, 0.2, 0.3], "bottom": [0, 0, 0.5]},
  "clip": {"boxes": [{"min": [0, 1, 2], "max": [3, 4, 5], "rotation": 30, "inverted": true}],
           "planes": [{"position": [1, 1, 1], "normal": [0, 0, -2], "inverted": true}], "casts": true},
  "legend": true, "axes": true, "scale_bar": true
})";

TEST(LookFile, EveryKeyIsReadAndWrittenBackTheSame) {
    const auto look = parse(kWholeLook);
    ASSERT_TRUE(look) << look.error().line();
    EXPECT_EQ(look->colour, ColourBy::attribute);
    EXPECT_EQ(look->attribute, "gps_time");
    EXPECT_EQ(look->map, ColourMap::cool_warm);
    EXPECT_EQ(look->range, (ValueRange{1.5, -2}));
    EXPECT_TRUE(look->hidden_classes[7] && look->hidden_classes[18] && look->hidden_classes.count() == 2);
    EXPECT_EQ(look->outliers, 2u);
    EXPECT_EQ(look->unlit.shading, Shading::occlusion);
    EXPECT_EQ(look->backdrop.kind, Backdrop::Kind::gradient);
    ASSERT_EQ(look->clip.boxes.size(), 1u);
    EXPECT_NEAR(look->clip.boxes[0].rotation, 0.5235987755982988, 1e-15);
    EXPECT_TRUE(look->clip.boxes[0].inverted && look->clip.planes.at(0).inverted && look->clip.casts);
    const auto again = parse(write_look(*look).dump());
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_NEAR(again->clip.boxes[0].rotation, look->clip.boxes[0].rotation, 1e-15);
    Look same = *again;
    same.clip.boxes[0].rotation = look->clip.boxes[0].rotation;
    EXPECT_EQ(same, *look);
}

TEST(LookFile, AnEmptyLookIsTheUsualOneAndWritesNothing) {
    const auto look = parse("{}");
    ASSERT_TRUE(look);
    EXPECT_EQ(*look, Look());
    EXPECT_EQ(write_look(Look()).dump(), "{}");
}

TEST(LookFile, MistakesNameTheirPlace) {
    const std::pair<const char*, const char*> mistakes[] = {
        {R"({"colour": "hue"})", "/look/colour"},
        {R"({"colour": "attribute"})", "attribute"},
        {R"({"hidden_classes": [256]})", "/look/hidden_classes"},
        {R"({"hidden_classes": [1.5]})", "/look/hidden_classes"},
        {R"({"hidden_classes": 7})", "/look/hidden_classes"},
        {R"({"outliers": 4})", "/look/outliers"},
        {R"({"point_size": 0})", "/look/point_size"},
        {R"({"range": {"low": 1}})", "high"},
        {R"({"backdrop": {"top": [2, 0, 0]}})", "/look/backdrop/top"},
        {R"({"clip": {"boxes": [{"min": [0, 0, 0], "max": [1, -1, 1]}]}})", "/look/clip/boxes/0/max"},
        {R"({"clip": {"planes": [{"position": [0, 0, 0], "normal": [0, 0, 0]}]}})",
         "/look/clip/planes/0/normal"},
        {R"({"colr": 1})", "/look/colr"},
    };
    for (const auto& [text, place] : mistakes) {
        const auto look = parse(text);
        ASSERT_FALSE(look) << text;
        EXPECT_EQ(look.error().kind, ErrorKind::input_rejected) << text;
        EXPECT_THAT(look.error().line(), HasSubstr(place)) << text;
    }
}

}  // namespace
}  // namespace lucarne::gi
