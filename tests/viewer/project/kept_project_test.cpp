#include "viewer/window/kept_project.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/processes.h"
#include "tests/temporary_folder.h"
#include "viewer/scans/scan_set.h"

namespace lucarne::viewer {
namespace {

TEST(KeptProject, TellsInTheWindowThatTheWorkCannotBeKept) {
    const test::Folder folder;
    std::ofstream(folder / "no-folder") << "a file";
    ViewModel model(10);
    ScanSet scans(
        {}, [](const octree::NodeSource&) { return failed("start", "is not asked for"); }, [] {});
    model.scans = &scans;
    KeptProject project(model, KeptProject::Mode::on);
    project.use(folder / "no-folder/p.json", {});
    ASSERT_TRUE(test::eventually([&] {
        project.follow(true);
        return !model.view.message.empty();
    }));
    EXPECT_THAT(model.view.message, testing::StartsWith("your work is not kept: "));
    EXPECT_THAT(model.view.message, testing::HasSubstr("no-folder"));
}

}  // namespace
}  // namespace lucarne::viewer
