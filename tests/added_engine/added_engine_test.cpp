// An engine that consists of one folder and one line in the list of engines. All commands have it, and its
// options appear on the command line, in scene files, presets, reports and the window without further code.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include "gi/registry.h"
#include "gi/scene/render_settings_file.h"
#include "gi/scene/scene.h"
#include "tests/added_engine/run.h"
#include "tests/viewer/program.h"
#include "viewer/flythrough/report.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

using testing::Contains;
using testing::HasSubstr;

using test::run;

class AddedEngine : public ::testing::Test {
 protected:
    void SetUp() override { cache_ = test::make_cornell(folder_, "20k"); }
    /// Returns the maximum of each channel in a picture of the engine.
    glm::vec3 brightest(const std::vector<std::string>& options) const {
        return test::brightest(cache_, folder_ / "out.exr", "paint", options);
    }
    std::string scene(const std::string& render) const {
        const std::string cornell = test::bytes_of(LUCARNE_SOURCE_DIR "/data/scenes/cornell.json");
        std::ofstream(folder_ / "scene.json") << "{\"render\": " << render << "," << cornell.substr(1);
        return folder_ / "scene.json";
    }
    const test::TemporaryFolder folder_;
    std::string cache_;
};

TEST_F(AddedEngine, TakesItsOptionsFromTheCommandLine) {
    EXPECT_EQ(brightest({}), glm::vec3(0, 1, 0)) << "the default of the preset interactive";
    EXPECT_EQ(brightest({"--preset", "preview"}), glm::vec3(1, 0, 0));
    EXPECT_EQ(brightest({"--tint", "0.25,0.5,1", "--paint-gain", "2"}), glm::vec3(0.5f, 1, 2));
    EXPECT_EQ(brightest({"--tint", "0,0,0.5", "--pattern", "stripes", "--stripe-width", "64"}),
              glm::vec3(0, 0, 0.5f));
}

TEST_F(AddedEngine, StandsInTheHelpOfAllCommandsThatDraw) {
    for (const char* command : {"render", "view", "fly", "prepare"}) {
        testing::internal::CaptureStdout();
        EXPECT_TRUE(run({command, "--help"}));
        const std::string help = testing::internal::GetCapturedStdout();
        for (const char* text :
             {"paint        one colour", "--tint R,G,B", "paint: Pixels of a stripe (1 to 64)",
              "plain, stripes, grey, mean", "--paint-sky", "--mean-scale"})
            EXPECT_THAT(help, HasSubstr(text)) << command;
    }
}

TEST_F(AddedEngine, FliesWithTheNodesOfTheViewAlone) {
    std::ofstream(folder_ / "path.json") << R"({"frames_per_second": 2, "keys": [
        {"time": 0, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]},
        {"time": 1, "position": [1.5, 0.8, 3.5], "target": [3, 4, 1.5]}]})";
    const auto flown = run({"fly", cache_, "--path", folder_ / "path.json", "-o", folder_ / "report.json",
                            "--engine", "paint", "--tint", "0,0,1", "--wait", "--size", "64x48"});
    ASSERT_TRUE(flown) << flown.error().line();
    const auto report = nlohmann::json::parse(test::bytes_of(folder_ / "report.json"));
    EXPECT_EQ(report["engine"], "paint");
    EXPECT_EQ(report["settings"]["tint"], (nlohmann::json{0.0, 0.0, 1.0}));
    EXPECT_GT(report["points_per_frame"]["view"]["mean"], 1000);
    EXPECT_EQ(report["points_per_frame"]["light"]["mean"], 0);
    EXPECT_TRUE(report["passes_ms"].contains("bands"));
    EXPECT_TRUE(std::filesystem::exists(cache_ + ".paint.bake"));
}

TEST_F(AddedEngine, RejectsWrongValuesBeforeAnythingIsDone) {
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--tint", "1,2,3"},
                                                  {"--tint", "red"},
                                                  {"--stripe-width", "0"},
                                                  {"--paint-gain", "9"},
                                                  {"--pattern", "dots"}}) {
        std::vector<std::string> arguments = {"render", cache_, "-o", folder_ / "none.exr"};
        arguments.insert(arguments.end(), wrong.begin(), wrong.end());
        const auto done = run(arguments);
        ASSERT_FALSE(done) << wrong[1];
        EXPECT_EQ(done.error().kind, ErrorKind::arguments);
        EXPECT_THAT(done.error().line(), HasSubstr(wrong[0]));
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none.exr"));
}

TEST_F(AddedEngine, TakesItsOptionsFromSceneFilesAndWritesThem) {
    const std::string render =
        R"({"engine": "paint", "tint": [0.5, 0, 0], "paint_gain": 4, "stripe_width": 2, "pattern": "plain", "paint_sky": true, "mean_scale": 2})";
    EXPECT_EQ(brightest({"--scene", scene(render)}), glm::vec3(2, 0, 0));
    EXPECT_EQ(brightest({"--scene", scene(render), "--paint-gain", "1"}), glm::vec3(0.5f, 0, 0))
        << "options win";
    const auto read = gi::load_render_settings(scene(render));
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(gi::write_render_settings(*read), nlohmann::ordered_json::parse(render));
    for (const char* wrong : {R"("tint": [1, 2, 3])", R"("paint_gain": 0)", R"("stripe_width": 65)",
                              R"("pattern": "dots")", R"("paint_sky": 1)"}) {
        const auto rejected = gi::parse_scene(std::string("{\"render\": {") + wrong + "}}", "wrong.json");
        ASSERT_FALSE(rejected) << wrong;
        const std::string key = std::string(wrong).substr(1, std::string(wrong).find('"', 1) - 1);
        EXPECT_THAT(rejected.error().line(), HasSubstr("/render/" + key));
    }
}

TEST_F(AddedEngine, StandsInReports) {
    FlightConditions conditions;
    conditions.engine = "paint";
    conditions.settings = gi::default_settings(gi::Effort::high);
    const auto report = flight_report(conditions, {});
    EXPECT_EQ(report["settings"]["tint"], (nlohmann::ordered_json{0.0, 0.0, 1.0}));
    EXPECT_EQ(report["settings"]["stripe_width"], 2);
    EXPECT_EQ(report["settings"]["pattern"], "plain");
    EXPECT_EQ(report["settings"]["mean_scale"], 1.0);
    EXPECT_FALSE(report["settings"].contains("vpls"));
}

/// Draws the panel once for each call, without a window.
class Panel {
 public:
    Panel() {
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().DisplaySize = ImVec2(400, 900);
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    }
    ~Panel() { ImGui::DestroyContext(); }
    void draw(ViewModel& model, ImVec2 mouse, bool pressed) {
        ImGuiIO& io = ImGui::GetIO();
        io.DeltaTime = 0.1f;
        io.MousePos = mouse;
        io.MouseDown[0] = pressed;
        ImGui::NewFrame();
        ImGui::SetNextWindowPos(ImVec2(0, 0));
        ImGui::SetNextWindowSize(ImVec2(400, 900));
        ImGui::Begin("panel");
        ImGui::GetStateStorage()->SetInt(ImGui::GetID("Effort"), 1);  // opened as if clicked
        draw_rendering_panel(model.rendering());
        ImGui::End();
        ImGui::EndFrame();
    }
    void click(ViewModel& model, ImVec2 at) {
        // A window reacts to the mouse from its second frame on. Make a short drag to the right, since
        // numbers change by dragging.
        const ImVec2 to(at.x + 20, at.y);
        for (const bool pressed : {false, false, false, true}) draw(model, at, pressed);
        for (const bool pressed : {true, true, false, false}) draw(model, to, pressed);
    }
};

TEST(AddedEnginePanel, HasAControlForEachOfItsOptions) {
    std::set<std::string> changed;
    const auto look = [&](const ViewModel& model, const gi::EngineSettings& before) {
        for (const gi::OptionInfo* option : gi::engine_options())
            if (model.view.method.settings.get(*option) != before.get(*option))
                changed.insert(std::string(option->key));
    };
    // Click at all heights, on the left where boxes are ticked, and on the right where fields are: a click on
    // a control changes something, and another click below chooses from an open list.
    const auto click_at = [&](float x, float y) {
        Panel panel;
        ViewModel model(10);
        model.view.method.engine = "paint";
        ASSERT_TRUE(model.view.choose_preset("interactive"));
        const gi::EngineSettings before = model.view.method.settings;
        for (const ImVec2 at : {ImVec2(x, y), ImVec2(x, y + 40)}) {
            panel.click(model, at);
            if (model.view.method.engine == "paint" && model.view.preset == "interactive")
                look(model, before);
        }
    };
    for (float y = 20; y < 500; y += 6)
        for (const float x : {60.0f, 140.0f, 200.0f}) click_at(x, y);
    for (const char* key : {"tint", "paint_gain", "stripe_width", "pattern", "paint_sky", "mean_scale"})
        EXPECT_THAT(changed, Contains(key));
    EXPECT_FALSE(changed.contains("vpls")) << "another engine's";
}

}  // namespace
}  // namespace lucarne::viewer
