// The engine `paths` in the program: what an edit computes again in advance, and that the picture after it is
// that of a fresh preparation, bit for bit.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

class PathsCommand : public testing::Test {
 protected:
    void SetUp() override {
        cache_ = test::make_cornell(folder_, "20k");
        place_ = cache_ + ".paths.bake";
        std::ofstream(scene()) << scene_text(1.5);
    }
    std::string scene() const { return folder_ / "scene.json"; }
    static std::string scene_text(double lamp, const std::string& more = "") {
        return R"({"lights": [{"type": "point", "position": [)" + std::to_string(lamp) +
               R"(, 2.2, 4.5], "intensity": [20, 18, 15]}])" + more + "}";
    }
    /// Returns the bytes of the picture with these options.
    std::string picture(const std::string& more) const {
        const auto done =
            test::lucarne("render " + cache_ + " -o " + (folder_ / "p.exr") +
                          " --engine paths --preset preview --bounces 2 --point-spacing 60 --gather-rays 64"
                          " --size 48x48 --overwrite --scene " +
                          scene() + " " + more);
        EXPECT_EQ(done.code, 0) << done.output;
        return test::bytes_of(folder_ / "p.exr");
    }
    struct Edit {
        const char* what;
        std::string options;
        bool computes;  ///< light paths anew
    };
    void expect_like_fresh(const Edit& edit) {
        SCOPED_TRACE(edit.what);
        const std::string kept = test::bytes_of(place_);
        const std::string edited = picture(edit.options);
        EXPECT_EQ(test::bytes_of(place_) != kept, edit.computes);
        std::filesystem::remove(place_);
        EXPECT_EQ(picture(edit.options), edited);
    }
    test::TemporaryFolder folder_;
    std::string cache_, place_;
};

TEST_F(PathsCommand, EditsRepeatOnlyWhatDependsOnThemAndEqualAFreshPreparation) {
    const std::string first = picture("");
    for (const Edit& edit :
         std::vector<Edit>{{"points' colours", "--colour elevation", false},
                           {"a clip that casts", "--clip-box 0,0,0,3,3,3 --clip-casts", false},
                           {"a clip", "--clip-box 0,0,0,3,3,3", true},
                           {"number of entry points", "--entry-points 50000", true}}) {
        expect_like_fresh(edit);
    }
    EXPECT_EQ(picture(""), first) << "and back";
    const std::vector<std::string> scenes = {
        scene_text(4),
        scene_text(1.5, R"(, "cameras": [{"name": "c", "position": [2, 1, 2], "target": [3, 5, 2]}])"),
        scene_text(1.5, R"(, "environment": {"radiance": [1, 1, 2]})"),
        scene_text(1.5, R"(, "materials": [{"name": "all", "diffuse": [0.5, 0.6, 0.7]}])"),
        scene_text(1.5, R"(, "materials": [{"name": "all"}, {"name": "some", "diffuse": [1, 0.2, 0.2],
            "box": {"min": [0, 0, 0], "max": [3, 6, 6]}}])")};
    for (const std::string& text : scenes) {
        std::ofstream(scene()) << text;
        expect_like_fresh({text.c_str(), "", false});
    }
    std::ofstream(scene()) << scene_text(1.5, R"(, "lighting_region": {"min": [2, 2, 4], "max": [3, 3, 5]})");
    expect_like_fresh({"where lamps will be", "", true});
}

TEST_F(PathsCommand, PreparesOnceAndSaysWhatItKeeps) {
    const std::string prepare = "prepare " + cache_ + " --engine paths --preset preview --point-spacing 60";
    const auto done = test::lucarne(prepare);
    EXPECT_EQ(done.code, 0) << done.output;
    EXPECT_THAT(done.output, HasSubstr("cornell.luc.paths.bake"));
    const std::string kept = test::bytes_of(place_);
    EXPECT_EQ(test::lucarne(prepare).code, 0);
    EXPECT_EQ(test::bytes_of(place_), kept);
    EXPECT_EQ(test::lucarne(prepare + " --gather-rays 100").code, 2);
}

}  // namespace
}  // namespace lucarne::viewer
