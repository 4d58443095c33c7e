// An engine whose OpenCL device is lost: the worker drops it with the OpenGL device and goes on with new
// ones.
#include <semaphore>

#include <gmock/gmock.h>

#include "tests/added_engine/opencl/opencl.h"
#include "tests/viewer/program.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

class LostOpenClDevice : public testing::Test {
 protected:
    void SetUp() override {
        const auto source = open_input(test::make_cornell(folder_, "20k"));
        ASSERT_TRUE(source) << source.error().line();
        auto worker = PictureWorker::start(device(), *source, {}, [this] { published_.release(); });
        ASSERT_TRUE(worker) << worker.error().line();
        worker_ = std::move(*worker);
        const octree::SourceHeader& header = (*source)->header();
        request_.method.engine = "opencl";
        request_.scene = gi::default_scene(header.min, header.max);
        request_.frame.camera = request_.scene.cameras.front();
        request_.frame.size = {96, 64};
    }
    void TearDown() override { gi::opencl_losses() = gi::LossPlan(""); }
    static WorkerDevice device() {
        return {[] { return gi::Device::headless(); }, [] {}};
    }
    /// Returns the next loss that the worker reports; none if another error comes first.
    std::optional<Error> loss() {
        for (;;) {
            if (auto lost = worker_->lost_device()) return lost;
            if (!worker_->error()) return std::nullopt;
            published_.acquire();
        }
    }
    /// Returns the first picture of a request that has all its nodes.
    std::shared_ptr<const Picture> whole(uint64_t number) {
        for (;;) {
            published_.acquire();
            if (!worker_->error()) return nullptr;
            const auto picture = worker_->latest();
            if (picture && picture->request == number && picture->stats.nodes_pending == 0) return picture;
        }
    }

    test::TemporaryFolder folder_;
    std::counting_semaphore<> published_{0};
    std::unique_ptr<PictureWorker> worker_;
    PictureRequest request_;
};

TEST_F(LostOpenClDevice, IsReplacedTogetherWithTheOpenGlDeviceAndTheSameRequestGoesOn) {
    gi::opencl_losses() = gi::LossPlan("1,2");  // at the first run, then at the first download
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

}  // namespace
}  // namespace lucarne::viewer
