#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"

// What `render` and `fly` show without a scene.
namespace lucarne {
namespace {

using test::bytes_of, test::Outcome;
using testing::HasSubstr, testing::Not;

const std::string kScene = std::string(" --scene ") + LUCARNE_SOURCE_DIR + "/data/scenes/cornell.json";

class FirstViewCommand : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<test::TemporaryFolder>();
        object_ = test::make_cornell(*folder_, "10k");
        room_ = *folder_ / "nave.ply";
        ASSERT_EQ(test::lucarne("generate nave -o " + room_ + " --points 60k --even --normals").code, 0);
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static std::string at(const std::string& name) { return *folder_ / name; }
    static Outcome render(const std::string& input, const std::string& output, const std::string& options) {
        const Outcome ran =
            test::lucarne("render " + input + " -o " + at(output) + " --size 64x48 --overwrite " + options);
        EXPECT_EQ(ran.code, 0) << ran.output;
        return ran;
    }

    static std::unique_ptr<test::TemporaryFolder> folder_;
    static std::string object_, room_;
};
std::unique_ptr<test::TemporaryFolder> FirstViewCommand::folder_;
std::string FirstViewCommand::object_, FirstViewCommand::room_;

TEST_F(FirstViewCommand, IsThatOfScanColoursUnlessAnEngineIsToLightTheScan) {
    EXPECT_THAT(render(object_, "a.png", "").output, HasSubstr("object: camera 'overview' at"));
    render(object_, "b.png", "--mood scan-colours");
    EXPECT_EQ(bytes_of(at("a.png")), bytes_of(at("b.png")));

    EXPECT_THAT(render(object_, "lit.png", "--engine vpl").output, HasSubstr("mood daylight"));
    EXPECT_THAT(render(object_, "day.png", "--mood daylight --seed 0").output, HasSubstr("environment"));
    // An option that only another engine has asks for that engine.
    EXPECT_THAT(render(object_, "day.png", "--mood daylight --overwrite --vpls 256").output,
                HasSubstr("vpl, "));
    EXPECT_TRUE(bytes_of(at("lit.png")) == bytes_of(at("day.png")));
    EXPECT_THAT(render(object_, "bounces.png", "--bounces 1").output, HasSubstr("vpl, preset interactive"));
}

TEST_F(FirstViewCommand, TheEveningHasTheEngineThatSuitsThePlace) {
    EXPECT_THAT(render(object_, "dusk.png", "--mood evening").output, HasSubstr("environment, "));
    EXPECT_THAT(render(room_, "lamps.png", "--mood evening").output, HasSubstr("vpl, "));
    EXPECT_THAT(render(object_, "own.png", "--mood evening --engine vpl").output, HasSubstr("vpl, "));
}

TEST_F(FirstViewCommand, OfARoomIsFromInside) {
    EXPECT_THAT(render(room_, "a.png", "").output, HasSubstr("interior: camera 'inside' at"));
    EXPECT_THAT(render(room_, "lit.png", "--engine direct").output, HasSubstr("mood evening"));
    EXPECT_THAT(render(room_, "out.png", "--camera overview").output, HasSubstr("scan-colours"));
    EXPECT_NE(bytes_of(at("a.png")), bytes_of(at("out.png")));
}

TEST_F(FirstViewCommand, AGivenSceneIsNotTouched) {
    const Outcome ran = render(object_, "scene.png", kScene);
    EXPECT_THAT(ran.output, Not(HasSubstr("mood")));
    EXPECT_THAT(ran.output, HasSubstr("vpl, preset interactive"));
    // The mood replaces its light, but not its cameras.
    EXPECT_THAT(render(object_, "mood.png", kScene + " --mood museum").output,
                testing::AllOf(HasSubstr("object: mood museum"), Not(HasSubstr("camera"))));
}

}  // namespace
}  // namespace lucarne
