// Render settings: from the window to its scene file, and from there to every command.
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "gi/scene/render_settings_file.h"
#include "tests/viewer/window/measuring_window.h"
#include "viewer/ui/scene_file.h"

namespace lucarne::viewer {
namespace {

using test::bytes_of, test::eventually, test::lucarne, test::MeasuringWindow, test::Outcome;
using testing::HasSubstr;

View changed_view() {
    View view(10);
    view.method.engine = "reference";
    EXPECT_TRUE(view.choose_preset("high"));
    view.method.settings.set(gi::kBounces, 3);
    view.method.settings.set(gi::kOnlyBounce, 2);
    view.method.settings.set(gi::kVpls, 64);
    view.method.settings.set(gi::vpl::kInterleave, 2);
    view.method.settings.set(gi::vpl::kAtlas, 512);
    view.method.settings.set(gi::kLightResolution, 256);
    view.method.settings.set(gi::reference::kSamples, 5);
    view.resolution_scale = 0.5;
    return view;
}

TEST(RenderSettings, WhatThePanelChangesIsInTheSceneThatTheWindowWrites) {
    const View view = changed_view();
    const auto scene = gi::parse_scene(gi::write_scene(scene_to_save(view)), "saved.json");
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(scene->render.engine, "reference");
    EXPECT_EQ(scene->render.scale, 0.5);
    const auto preset = find_preset(scene->render.preset);
    ASSERT_TRUE(preset);
    gi::EngineSettings settings = preset->engine;
    apply(scene->render, settings);
    EXPECT_EQ(settings, view.method.settings);
}

TEST(RenderSettings, APresetAsItIsIsWrittenAsItsName) {
    View view(10);
    view.method.engine = "vpl";
    ASSERT_TRUE(view.choose_preset("preview"));
    gi::RenderSettings expected;
    expected.engine = "vpl";
    expected.preset = "preview";
    EXPECT_EQ(scene_to_save(view).render, expected);
}

TEST(RenderSettings, ValuesThatNoOptionHasAreRejectedAtTheirPlace) {
    for (const char* wrong :
         {R"("bounces": 65)", R"("only_bounce": -1)", R"("vpls": 0)", R"("interleave": 3)",
          R"("atlas": 1000)", R"("light_resolution": 8192)", R"("samples": 0)", R"("scale": 0.2)",
          R"("scale": 1.5)", R"("engine": 7)", R"("quality": 1)"}) {
        const auto scene = gi::parse_scene(fmt::format(R"({{"render": {{{}}}}})", wrong), "wrong.json");
        ASSERT_FALSE(scene) << wrong;
        const std::string key = std::string(wrong).substr(1, std::string(wrong).find('"', 1) - 1);
        EXPECT_THAT(scene.error().line(), HasSubstr("/render/" + key));
    }
}

class RenderSettingsCommand : public testing::Test {
 protected:
    void SetUp() override {
        cache_ = test::make_cornell(folder_, "20k");
        cornell_ = bytes_of(LUCARNE_SOURCE_DIR "/data/scenes/cornell.json");
    }
    /// Writes Cornell's scene with or without an object `render`.
    std::string scene(const std::string& render) const {
        const std::string file = folder_ / "scene.json";
        std::ofstream(file) << (render.empty() ? cornell_
                                               : "{\"render\": " + render + "," + cornell_.substr(1));
        return file;
    }
    Outcome run(const std::string& render, const std::string& options) const {
        return lucarne("render " + cache_ + " -o " + (folder_ / "out.png") +
                       " --overwrite --size 64x48 --scene " + scene(render) + " " + options);
    }
    std::string picture(const std::string& render, const std::string& options) const {
        const Outcome outcome = run(render, options);
        EXPECT_EQ(outcome.code, 0) << outcome.output;
        return bytes_of(folder_ / "out.png");
    }
    const test::TemporaryFolder folder_;
    std::string cache_, cornell_;
};

TEST_F(RenderSettingsCommand, ASceneSaysWhatOptionsSayAndOptionsWin) {
    const std::string as_options = picture(
        "", "--engine vpl --preset preview --bounces 2 --vpls 32 --interleave 1 --light-resolution 128");
    const std::string settings =
        R"({"engine": "vpl", "preset": "preview", "bounces": 2, "vpls": 32, "interleave": 1,
        "light_resolution": 128})";
    EXPECT_EQ(picture(settings, ""), as_options);
    const std::string direct = picture("", "--engine direct --preset preview --light-resolution 128");
    EXPECT_NE(direct, as_options);
    EXPECT_EQ(picture(settings, "--engine direct"), direct);
}

TEST_F(RenderSettingsCommand, AFlightTakesItsEngineFromTheSceneToo) {
    const std::string report = folder_ / "report.json", path = folder_ / "path.json";
    std::ofstream(path) << R"({"frames_per_second": 1, "keys": [
        {"time": 0, "position": [2.75, -6, 2.75], "target": [2.75, 0, 2.75], "fov": 40},
        {"time": 1, "position": [2.75, -7, 2.75], "target": [2.75, 0, 2.75], "fov": 40}]})";
    const Outcome flown =
        lucarne("fly " + cache_ + " --path " + path + " -o " + report + " --size 32x24 --scene " +
                scene(R"({"engine": "direct", "preset": "preview"})"));
    ASSERT_EQ(flown.code, 0) << flown.output;
    EXPECT_THAT(bytes_of(report), HasSubstr("\"engine\": \"direct\""));
    EXPECT_THAT(bytes_of(report), HasSubstr("\"preset\": \"preview\""));
}

TEST_F(RenderSettingsCommand, AnEngineThatThereIsNotIsRejectedWithItsFile) {
    for (const char* what : {"engine", "preset"}) {
        const Outcome outcome = run(fmt::format(R"({{"{}": "quantum"}})", what), "");
        EXPECT_EQ(outcome.code, 3);
        EXPECT_THAT(outcome.output,
                    HasSubstr(fmt::format("scene.json: /render/{}: there is no {} 'quantum'", what, what)));
    }
}

TEST_F(MeasuringWindow, PicturesOfHalfTheSizeAreMeasuredInTheSamePlacesAndTheSavedSceneSaysSo) {
    resolution_ = 0.5;
    measure_a_known_distance(" --scale 0.5 --light-resolution 256");
    const std::string scene = folder_ / "front.json";
    std::filesystem::remove(scene);
    xdo("key ctrl+s");
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(scene); }));
    const auto saved = gi::load_render_settings(scene);
    ASSERT_TRUE(saved) << saved.error().line();
    EXPECT_EQ(saved->engine, "direct");
    EXPECT_EQ(saved->scale, 0.5);
    EXPECT_EQ(saved->options[gi::kLightResolution], 256u);
}

}  // namespace
}  // namespace lucarne::viewer
