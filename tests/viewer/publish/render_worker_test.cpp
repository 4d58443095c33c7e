#include "viewer/publish/render_worker.h"

#include <fstream>
#include <semaphore>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"
#include "tests/viewer/window/picture_difference.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

class Rendering : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<test::TemporaryFolder>();
        cache_ = test::make_cornell(*shared_, "10k");
    }
    static void TearDownTestSuite() { shared_.reset(); }
    void SetUp() override {
        const auto source = open_input(cache_);
        ASSERT_TRUE(source) << source.error().line();
        order_.source = *source;
        std::ofstream(scene_) << R"({"lights": [{"type": "point", "position": [0.3, 0.3, 0.4],
            "intensity": [40, 40, 40]}], "cameras": [{"name": "front", "position": [0.28, -0.7, 0.28],
            "target": [0.28, 0.3, 0.28]}]})";
        const auto scene = gi::load_scene(scene_);
        ASSERT_TRUE(scene) << scene.error().line();
        order_.scene = *scene;
        order_.method.engine = "direct";
        order_.method.settings = find_preset(kDefaultPreset)->engine;
        order_.method.budgets = find_preset(kDefaultPreset)->budgets;
        order_.size = {64, 48};
    }
    StillOrder still(const std::string& name) const {
        StillOrder order;
        order.camera = order_.scene.cameras.front();
        order.file = folder_ / name;
        return order;
    }
    FlightOrder flight(double seconds) const {
        FlightOrder order;
        order.path.frames_per_second = 10;
        order.path.keys = {{0, order_.scene.cameras.front()}, {seconds, order_.scene.cameras.front()}};
        order.path.keys.back().camera.position.z += 0.2;
        order.frames_folder = folder_ / "frames";
        return order;
    }
    bool start() {
        return worker_.start(order_, {[] { return gi::Device::headless(); }, [] {}});
    }
    Result<std::string> outcome() {
        for (;;) {
            if (auto done = worker_.take_outcome()) return *done;
            changed_.acquire();
        }
    }

    static std::unique_ptr<test::TemporaryFolder> shared_;
    static std::string cache_;
    test::TemporaryFolder folder_;
    const std::string scene_ = folder_ / "scene.json";
    RenderOrder order_;
    std::counting_semaphore<> changed_{0};
    RenderWorker worker_{[this] { changed_.release(); }};
};
std::unique_ptr<test::TemporaryFolder> Rendering::shared_;
std::string Rendering::cache_;

TEST_F(Rendering, SavesWhatTheCommandRenders) {
    order_.what = still("window.png");
    ASSERT_TRUE(start());
    const auto done = outcome();
    ASSERT_TRUE(done) << done.error().line();
    EXPECT_THAT(*done, HasSubstr("window.png"));
    EXPECT_FALSE(worker_.state().running);
    const auto ran = test::lucarne("render " + cache_ + " --engine direct --size 64x48 --scene " + scene_ +
                                   " -o " + (folder_ / "command.png"));
    ASSERT_EQ(ran.code, 0) << ran.output;
    EXPECT_EQ(test::bytes_of(folder_ / "window.png"), test::bytes_of(folder_ / "command.png"));
}

TEST_F(Rendering, RoomsAreOpenFromOutsideInPicturesAndFlights) {
    order_.site.kind = SiteKind::interior;
    order_.site.box = {order_.source->header().min, order_.source->header().max};
    gi::SceneCamera& camera = order_.scene.cameras.front();
    camera.target = (order_.site.box[0] + order_.site.box[1]) / 2.0;
    camera.position = camera.target - glm::dvec3(3 * (camera.target.x - order_.site.box[0].x), 0, 0);
    ASSERT_TRUE(gi::save_scene(order_.scene, folder_ / "outside.json", false));
    const std::string render = "render " + cache_ + " --engine direct --size 64x48 --scene " +
                               (folder_ / "outside.json") + " -o " + folder_.path().string();
    ASSERT_EQ(test::lucarne(render + "/closed.png").code, 0);
    ASSERT_EQ(test::lucarne(render + "/open.png --front-only").code, 0);
    const auto open = test::bytes_of(folder_ / "open.png");
    EXPECT_NE(open, test::bytes_of(folder_ / "closed.png"));
    order_.what = still("window.png");
    ASSERT_TRUE(start());
    ASSERT_TRUE(outcome());
    EXPECT_EQ(test::bytes_of(folder_ / "window.png"), open);
    FlightOrder along = flight(0.1);
    along.path.keys.back().camera = camera;
    order_.what = along;
    ASSERT_TRUE(start());
    ASSERT_TRUE(outcome());
    const auto in_flight = io::read_png(folder_ / "frames/frame_00001.png"),
               seen = io::read_png(folder_ / "open.png"), closed = io::read_png(folder_ / "closed.png");
    ASSERT_TRUE(in_flight && seen && closed);
    EXPECT_LT(test::difference(*in_flight, *seen), test::difference(*in_flight, *closed) / 4);
}

TEST_F(Rendering, OverwritesNothingAndSaysWhatCannotBeMade) {
    std::ofstream(folder_ / "taken.png") << "precious";
    order_.what = still("taken.png");
    ASSERT_TRUE(start());
    EXPECT_THAT(outcome().error().line(), HasSubstr("exists already"));
    EXPECT_EQ(test::bytes_of(folder_ / "taken.png"), "precious");
    order_.what = still("picture.gif");
    ASSERT_TRUE(start());
    EXPECT_THAT(outcome().error().line(), HasSubstr("name it .png"));
    order_.what = FlightOrder{{}, folder_ / "frames", {}};
    ASSERT_TRUE(start());
    EXPECT_THAT(outcome().error().line(), HasSubstr("no key frame"));
    order_.size = {16384, 16384};
    order_.caps.device_memory = uint64_t{64} << 20;
    order_.what = still("huge.png");
    ASSERT_TRUE(start());
    EXPECT_THAT(outcome().error().line(), HasSubstr("MiB"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "huge.png"));
}

TEST_F(Rendering, AFlightIsWrittenFrameByFrame) {
    order_.what = flight(0.5);
    ASSERT_TRUE(start());
    EXPECT_FALSE(start()) << "one at a time";
    const auto done = outcome();
    ASSERT_TRUE(done) << done.error().line();
    EXPECT_EQ(worker_.state().done, 6u);
    EXPECT_EQ(worker_.state().total, 6u);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "frames/frame_00006.png"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "frames/frame_00007.png"));
}

TEST_F(Rendering, CancellingEndsAnEndlessFlightAndTheNextOrderIsTaken) {
    order_.what = flight(90'000);
    ASSERT_TRUE(start());
    while (worker_.state().done < 2) changed_.acquire();
    worker_.cancel();
    EXPECT_THAT(outcome().error().line(), HasSubstr("cancelled"));
    EXPECT_LT(worker_.state().done, 900'001u);
    order_.what = still("next.png");
    ASSERT_TRUE(start());
    EXPECT_TRUE(outcome());
}

}  // namespace
}  // namespace lucarne::viewer
