#include "viewer/picture_worker.h"

#include <semaphore>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"
#include "viewer/input.h"

namespace lucarne::viewer {
namespace {

class Worker : public testing::Test {
 protected:
    void SetUp() override {
        const auto source = open_input(test::make_cornell(folder_));
        ASSERT_TRUE(source) << source.error().line();
        header_ = (*source)->header();
        auto worker = PictureWorker::start({[] { return gi::Device::headless(); }, [] {}}, *source, {},
                                           [this] { published_.release(); });
        ASSERT_TRUE(worker) << worker.error().line();
        worker_ = std::move(*worker);
        request_.engine = "direct";
        request_.scene = gi::default_scene(header_.min, header_.max);
        request_.frame.camera = request_.scene.cameras.front();
        request_.frame.size = {96, 64};
    }
    /// The first picture of a request that has all its nodes.
    std::shared_ptr<const Picture> whole(uint64_t number) {
        for (;;) {
            published_.acquire();
            if (!worker_->error()) return nullptr;
            const auto picture = worker_->latest();
            if (picture && picture->request == number && picture->stats.nodes_pending == 0) return picture;
        }
    }

    test::TemporaryFolder folder_;
    octree::SourceHeader header_;
    std::counting_semaphore<> published_{0};
    std::unique_ptr<PictureWorker> worker_;
    PictureRequest request_;
};

TEST_F(Worker, MakesThePictureOfTheNewestRequest) {
    uint64_t number = 0;
    for (uint32_t width = 40; width <= 96; width += 8) {
        request_.frame.size = {width, 64};
        number = worker_->request(request_);
    }
    const auto picture = whole(number);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->size.width, 96u);
    EXPECT_EQ(picture->rgba.size(), size_t{96} * 64 * 4);
    EXPECT_LE(picture->number, 9u) << "requests overtaken are not made";
}

TEST_F(Worker, PicksTheWorldPointUnderAPlace) {
    const auto picture = whole(worker_->request(request_));
    ASSERT_TRUE(picture);
    const auto point = picture->pick({0.5, 0.5});
    ASSERT_TRUE(point);
    // On the way of the camera's middle ray, within the cloud.
    const glm::dvec3 ahead = glm::normalize(request_.frame.camera.target - request_.frame.camera.position);
    const glm::dvec3 offset = *point - request_.frame.camera.position;
    EXPECT_LT(glm::length(offset - ahead * glm::dot(offset, ahead)), 0.03 * glm::length(offset));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT((*point)[axis], header_.min[axis] - 0.1);
        EXPECT_LT((*point)[axis], header_.max[axis] + 0.1);
    }
    EXPECT_FALSE(picture->pick({-3, 9}));
}

TEST_F(Worker, AnErrorIsShownAndTheNextRequestIsMadeAllTheSame) {
    request_.engine = "magic";
    EXPECT_EQ(whole(worker_->request(request_)), nullptr);
    EXPECT_FALSE(worker_->error());
    request_.engine = "direct";
    EXPECT_TRUE(whole(worker_->request(request_)));
    EXPECT_TRUE(worker_->error());
}

}  // namespace
}  // namespace lucarne::viewer
