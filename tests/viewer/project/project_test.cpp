#include "viewer/project/project.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "io/files/json.h"
#include "tests/temporary_folder.h"
#include "viewer/measure/file.h"
#include "viewer/project/lock.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

Project work() {
    Project project;
    project.scans = {{"/scans/a.las", "/scans/b.las"}, {"/scans/c.las"}};
    auto scene = gi::parse_scene(R"({
        "cameras": [{"name": "view", "position": [1.1, 2.2, 3.3], "target": [0, 0, 0]}],
        "lights": [{"type": "spot", "position": [0, 0, 5], "target": [0, 0, 0], "intensity": [1, 2, 3], "angle": 40}],
        "exposure": {"white": [1.5, 1, 0.5]},
        "look": {"clip": {"boxes": [{"min": [0, 0, 0], "max": [1, 1, 1]}]}},
        "render": {"engine": "vpl", "preset": "interactive"}})",
                                 "scene");
    EXPECT_TRUE(scene) << scene.error().line();
    project.scene = std::move(*scene);
    project.mood = Mood::museum;
    ExactPoint a, b;
    a.position = {500000.123456, 5400000.1, 7};
    a.coordinates = {"500000.123456", "5400000.1", "7"};
    b.position = {500001, 5400002, 8};
    b.coordinates = {"500001", "5400002", "8"};
    project.measurements = {{MeasureKind::distance, "the door", {a, b}, 0}};
    auto path = parse_path(R"({"keys": [{"time": 0, "position": [0, 0, 1], "target": [1, 0, 1]},
                                             {"time": 2, "position": [3, 0, 1], "target": [4, 0, 1]}]})",
                           "path");
    EXPECT_TRUE(path) << path.error().line();
    project.flythrough = std::move(*path);
    return project;
}

class ProjectFile : public testing::Test {
 protected:
    void write(const std::string& text) const { std::ofstream(file_) << text; }
    const test::Folder folder_;
    const std::filesystem::path file_ = folder_ / "p.json";
};

TEST_F(ProjectFile, BringsAllWorkBack) {
    const Project before = work();
    const std::string text = project_text(before, 0.3048, folder_.path());
    write(text);
    const LoadedProject loaded = load_project(file_, 0.3048);
    ASSERT_TRUE(loaded.project) << loaded.problem;
    EXPECT_TRUE(loaded.problem.empty());
    EXPECT_TRUE(loaded.may_write);
    const Project& after = *loaded.project;
    EXPECT_EQ(after.scans, before.scans);
    EXPECT_EQ(after.scene.lights, before.scene.lights);
    EXPECT_EQ(after.scene.cameras, before.scene.cameras);
    EXPECT_EQ(after.scene.look, before.scene.look);
    EXPECT_EQ(after.scene.render, before.scene.render);
    EXPECT_EQ(after.scene.white, before.scene.white);
    EXPECT_EQ(after.mood, before.mood);
    ASSERT_EQ(after.measurements.size(), 1u);
    EXPECT_EQ(after.measurements[0].name, "the door");
    EXPECT_EQ(after.measurements[0].points[0].position, before.measurements[0].points[0].position);
    EXPECT_EQ(path_text(*after.flythrough), path_text(*before.flythrough));
    EXPECT_EQ(project_text(after, 0.3048, folder_.path()), text) << "nothing is written that is not read";
}

TEST_F(ProjectFile, ThatIsNotThereIsNoProblem) {
    for (const auto& file : {file_, std::filesystem::path()}) {
        const LoadedProject loaded = load_project(file, 1);
        EXPECT_FALSE(loaded.project);
        EXPECT_TRUE(loaded.problem.empty());
        EXPECT_TRUE(loaded.may_write);
    }
}

TEST_F(ProjectFile, ThatIsDamagedIsPutAsideAndNeverCrashes) {
    const std::string text = project_text(work(), 1, folder_.path());
    for (size_t length = 0; length + 1 < text.size(); length += 7) {
        write(text.substr(0, length));
        const LoadedProject loaded = load_project(file_, 1);
        ASSERT_FALSE(loaded.project) << length;
        EXPECT_THAT(loaded.problem, HasSubstr("broken"));
        EXPECT_TRUE(loaded.may_write);
        EXPECT_FALSE(std::filesystem::exists(file_));
        EXPECT_EQ(load_text(folder_ / "p.json.broken").value(), text.substr(0, length));
    }
    for (const char* bad : {"[]", "{}", R"({"version": 1})", R"({"version": 1, "scene": {}})",
                            R"({"version": 1, "scene": [], "mood": 3})", R"({"version": "1", "scene": {}})",
                            R"({"version": 1, "scene": {"lights": 7}})",
                            R"({"version": 1, "scene": {"cameras": [{}]}, "scans": [7]})",
                            R"({"version": 1, "scene": {"cameras": [{}]}, "scans": [[]]})"}) {
        write(bad);
        EXPECT_FALSE(load_project(file_, 1).project) << bad;
    }
}

TEST_F(ProjectFile, OfANewerProgramStaysAsItIs) {
    const std::string text = R"({"version": 2, "new": true})";
    write(text);
    const LoadedProject loaded = load_project(file_, 1);
    EXPECT_FALSE(loaded.project);
    EXPECT_FALSE(loaded.may_write);
    EXPECT_THAT(loaded.problem, HasSubstr("newer"));
    EXPECT_EQ(load_text(file_).value(), text);
}

TEST_F(ProjectFile, WithAMillionNestedArraysIsRefused) {
    const std::string deep(1'000'000, '[');
    for (const std::string& text :
         {deep + std::string(deep.size(), ']'), deep,
          R"({"version": 1, "scene": )" + deep + std::string(deep.size(), ']') + "}"}) {
        const auto project = parse_project(text, "deep.json", folder_.path(), std::nullopt);
        ASSERT_FALSE(project);
        EXPECT_THAT(project.error().line(), HasSubstr("nested"));
    }
}

TEST_F(ProjectFile, OfTheUserStaysAsItIsWhateverItHolds) {
    for (const char* text : {"\xff\xfe", R"({"version": 1, "scene": 3})", R"({"version": 9})"}) {
        write(text);
        const auto project = read_project(file_, std::nullopt);
        ASSERT_FALSE(project) << text;
        EXPECT_THAT(project.error().line(), HasSubstr("p.json"));
        EXPECT_EQ(load_text(file_).value(), text);
    }
}

TEST_F(ProjectFile, IsToldFromAScene) {
    write(project_text(work(), 1, folder_.path()));
    EXPECT_TRUE(is_project(file_));
    write(gi::write_scene(work().scene));
    EXPECT_FALSE(is_project(file_));
    write("[]");
    EXPECT_FALSE(is_project(file_));
    EXPECT_FALSE(is_project(folder_ / "none.json"));
}

TEST_F(ProjectFile, FindsItsScansWhereTheyWereOrBesideIt) {
    std::ofstream(folder_ / "moved.las") << "scan";
    std::filesystem::create_directory(folder_ / "old");
    std::ofstream(folder_ / "old/there.las") << "scan";
    std::ofstream(folder_ / "there.las") << "another scan";
    const std::string there = folder_ / "old/there.las";
    const auto scans = find_scans({{there, "/nowhere/moved.las"}, {"/nowhere/gone.las"}, {"/", "moved.las"}},
                                  folder_.path());
    const std::string moved = folder_ / "moved.las";
    EXPECT_EQ(scans.found, (ScanGroups{{there, moved}, {"/", moved}}));
    EXPECT_EQ(scans.missing, (std::vector<std::string>{"/nowhere/gone.las"}));
    EXPECT_THAT(missing_text("p.json", scans.missing),
                HasSubstr("p.json: scans not found: /nowhere/gone.las;"));
    EXPECT_THAT(missing_text("p.json", {"a", "b", "c", "d", "e"}), HasSubstr("a, b, c and 2 more"));
    EXPECT_EQ(missing_text("p.json", {}), "");
}

TEST_F(ProjectFile, CountsScansWithImpossiblePathsAsMissing) {
    const std::string here = folder_ / "a.las", zero = here + std::string(1, '\0') + "b", bell = "/a\x07.las";
    std::ofstream{here} << "scan";
    const FoundScans scans = find_scans({{zero, here}, {bell}}, folder_.path());
    EXPECT_EQ(scans.found, (ScanGroups{{here}}));
    EXPECT_EQ(scans.missing, (std::vector<std::string>{zero, bell}));
    Project project = work();
    project.scans = {{here}, {zero}};
    const auto read = parse_project(project_text(project, 1, folder_.path()), "p.json", folder_.path(), 1.0);
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(read->scans, project.scans) << "one path refuses no project";
    EXPECT_EQ(missing_text("p.json", scans.missing).find('\0'), std::string::npos);
}

TEST_F(ProjectFile, IsLockedByOneAtATime) {
    ProjectLock first, second;
    EXPECT_EQ(first.take(file_), "");
    EXPECT_THAT(second.take(file_), HasSubstr("process " + std::to_string(getpid()) + " on "));
    first.release();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "p.json.lock"));
    EXPECT_EQ(second.take(file_), "");
    ProjectLock third = std::move(second);
    EXPECT_NE(first.take(file_), "");
    std::ofstream(folder_ / "q.json.lock") << "left by a process that has ended";
    EXPECT_EQ(first.take(folder_ / "q.json"), "") << "nobody holds it";
    EXPECT_EQ(first.take(folder_ / "none/p.json"), "") << "there can be no lock";
}

TEST_F(ProjectFile, EachScanHasItsOwn) {
    EXPECT_NE(project_file("/c", "/a/x.las"), project_file("/c", "/b/x.las"));
    EXPECT_EQ(project_file("/c", "/a/x.las"), project_file("/c", "/a/x.las"));
    EXPECT_EQ(project_file("", "/a/x.las"), std::filesystem::path());
}

}  // namespace
}  // namespace lucarne::viewer
