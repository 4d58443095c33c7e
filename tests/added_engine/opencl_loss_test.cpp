// An engine whose OpenCL device is lost: the worker drops it with the OpenGL device and goes on with new
// ones.
#include <cstdlib>

#include <gmock/gmock.h>

#include "gi/registry.h"
#include "tests/added_engine/paint/paint.h"
#include "tests/viewer/frame/on_worker.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

class LostOpenClDevice : public test::OnWorker {
 protected:
    void SetUp() override {
        const auto source = open_input(test::make_cornell(folder_, "20k"));
        ASSERT_TRUE(source) << source.error().line();
        request_.method.engine = "paint";
        request_.method.settings = gi::default_settings(gi::Effort::high);
        start(device(), *source);
    }
    void TearDown() override { gi::paint_hooks().opencl_losses = gi::LossPlan(""); }
    static WorkerDevice device() {
        return {[] { return gi::Device::headless(); }, [] {}};
    }
};

TEST_F(LostOpenClDevice, IsReplacedTogetherWithTheOpenGlDeviceAndTheSameRequestGoesOn) {
    gi::paint_hooks().opencl_losses =
        gi::LossPlan("1,9");  // at the first run, then at the download after eight
    const uint64_t number = worker_->request(request_);
    for (int i = 0; i < 2; ++i) {
        const auto lost = loss();
        ASSERT_TRUE(lost) << worker_->error().error().line();
        EXPECT_THAT(lost->line(), testing::HasSubstr("OpenCL: the device"));
        EXPECT_EQ(worker_->latest(), nullptr);
        worker_->set_device(device());
    }
    const auto picture = whole(number);
    ASSERT_TRUE(picture) << worker_->error().error().line();
    EXPECT_FALSE(worker_->lost_device());
    const size_t middle = (size_t{32} * 96 + 48) * 4;
    EXPECT_GT(picture->rgba[middle + 2], picture->rgba[middle]) << "it is blue, as OpenCL painted it";
}

TEST(OpenClEngineDeathTest, IsRefusedWithTheNameOfThePackageWhereThereIsNoDevice) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";  // in a process that has not looked for devices yet
    EXPECT_EXIT(
        {
            ::setenv("OCL_ICD_VENDORS", "/nonexistent", 1);
            const auto made = gi::make_engine("paint");
            std::fputs(made ? "made" : made.error().line().c_str(), stderr);
            std::exit(made || !gi::make_engine("vpl"));
        },
        testing::ExitedWithCode(0), "OpenCL: no device was found.*pocl-opencl-icd");
}

}  // namespace
}  // namespace lucarne::viewer
