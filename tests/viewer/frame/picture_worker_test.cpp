#include "viewer/frame/picture_worker.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <semaphore>
#include <vector>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "tests/viewer/frame/on_worker.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

class Worker : public test::OnWorker {
 protected:
    void SetUp() override {
        cache_ = test::make_cornell(folder_);
        const auto source = open_input(cache_);
        ASSERT_TRUE(source) << source.error().line();
        source_ = *source;
        header_ = (*source)->header();
        request_.method.engine = "direct";
        start(device(), *source);
    }
    /// Returns a device whose context is lost after this number of pictures.
    static WorkerDevice device(std::optional<uint32_t> lost_after = {}) {
        return {[lost_after] {
                    auto made = gi::Device::headless();
                    if (made && lost_after) (*made)->lose_after(*lost_after);
                    return made;
                },
                [] {}};
    }
    std::string cache_;
    std::shared_ptr<const octree::NodeSource> source_;
    octree::SourceHeader header_;
};

TEST_F(Worker, MakesThePictureOfTheNewestRequest) {
    // The worker goes on after its first picture only when all other requests are there.
    std::binary_semaphore all_there(0);
    const PictureWorker* worker = nullptr;
    std::vector<uint64_t> made;  // the requests of the pictures, in order
    auto started = PictureWorker::start(device(), source_, {}, [&] {
        const auto picture = worker->latest();
        made.push_back(picture ? picture->request : 0);
        published_.release();
        if (made.size() == 1) all_there.acquire();
    });
    ASSERT_TRUE(started) << started.error().line();
    worker_ = std::move(*started);
    worker = worker_.get();
    const uint64_t first = worker_->request(request_);
    published_.acquire();
    uint64_t newest = 0;
    for (uint32_t width = 40; width <= 88; width += 8) {
        request_.frame.size = {width, 64};
        newest = worker_->request(request_);
    }
    all_there.release();
    const auto picture = whole(newest);
    worker_.reset();  // `made` is complete
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->size.width, 88u);
    EXPECT_EQ(picture->rgba.size(), size_t{88} * 64 * 4);
    EXPECT_EQ(made.front(), first);
    EXPECT_EQ(std::ranges::count(made, newest), static_cast<ptrdiff_t>(made.size()) - 1)
        << "requests overtaken are not made";
}

TEST_F(Worker, ADeviceThatThrowsCountsAsOneThatCannotBeMade) {
    const WorkerDevice throwing{[]() -> Result<std::unique_ptr<gi::Device>> { throw std::bad_alloc(); },
                                [] {}};
    const auto never = PictureWorker::start(throwing, source_, {}, [] {});
    ASSERT_FALSE(never);
    EXPECT_THAT(never.error().line(), testing::HasSubstr("graphics device: there is not enough memory"));
    // Also as the replacement of a lost device.
    auto worker = PictureWorker::start(device(1), source_, {}, [this] { published_.release(); });
    ASSERT_TRUE(worker) << worker.error().line();
    worker_ = std::move(*worker);
    worker_->request(request_);
    ASSERT_TRUE(loss());
    worker_->set_device(throwing);
    const auto again = loss();
    ASSERT_TRUE(again);
    EXPECT_THAT(again->line(), testing::HasSubstr("there is not enough memory"));
    worker_->set_device(device());
    EXPECT_TRUE(whole(worker_->request(request_)));
}

TEST_F(Worker, PicksTheWorldPointUnderAPlace) {
    const auto picture = whole(worker_->request(request_));
    ASSERT_TRUE(picture);
    const auto point = picture->pick({0.5, 0.5});
    ASSERT_TRUE(point);
    // The point is on the camera's central ray, within the cloud.
    const glm::dvec3 ahead = glm::normalize(request_.frame.camera.target - request_.frame.camera.position);
    const glm::dvec3 offset = *point - request_.frame.camera.position;
    EXPECT_LT(glm::length(offset - ahead * glm::dot(offset, ahead)), 0.03 * glm::length(offset));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT((*point)[axis], header_.min[axis] - 0.1);
        EXPECT_LT((*point)[axis], header_.max[axis] + 0.1);
    }
    EXPECT_FALSE(picture->pick({-3, 9}));
}

TEST_F(Worker, APictureAtRestHoldsNothingOfTheOneBeforeTheMotion) {
    request_.frame.accumulate = true;
    ASSERT_TRUE(whole(worker_->request(request_)));
    request_.frame.camera.target.z += glm::distance(header_.min, header_.max) / 4;
    request_.frame.accumulate = false;
    request_.frame.moving = request_.moving = true;
    const auto moving = whole(worker_->request(request_));
    ASSERT_TRUE(moving);
    request_.frame.accumulate = true;  // the camera stops
    request_.pictures = 1;             // later ones are smoothed at edges
    request_.frame.moving = request_.moving = false;
    const auto still = whole(worker_->request(request_));
    ASSERT_TRUE(still);
    int largest = 0;
    for (size_t i = 0; i < still->rgba.size(); ++i)
        largest =
            std::max(largest, std::abs(static_cast<int>(still->rgba[i]) - static_cast<int>(moving->rgba[i])));
    EXPECT_LE(largest, 1) << "a spot's light is the same in every sample";
}

TEST_F(Worker, MotionDoesNotWaitForAPictureAtRest) {
    // A picture that would take hours is given up, also in favour of the end.
    request_.method.engine = "reference";
    request_.method.settings = gi::default_settings(gi::Effort::preview);
    gi::EngineSettings& settings = request_.method.settings;
    settings.set(*gi::find_option("samples"), int64_t{1} << 20);
    worker_->request(request_);
    PictureRequest motion = request_;
    motion.moving = motion.frame.moving = motion.frame.stand_in = true;
    motion.frame.light_budget = gi::StepBudget::timed(0);
    for (int i = 0; i < 3; ++i) {
        motion.frame.camera.target.z += 1e-3;
        const auto picture = whole(worker_->request(motion));
        ASSERT_TRUE(picture) << "the default engine stands in for the slow one";
        EXPECT_TRUE(picture->moving);
    }
    worker_->request(request_);
}

TEST_F(Worker, AnErrorIsShownAndTheNextRequestIsMadeAllTheSame) {
    request_.method.engine = "magic";
    EXPECT_EQ(whole(worker_->request(request_)), nullptr);
    EXPECT_FALSE(worker_->error());
    request_.method.engine = "direct";
    EXPECT_TRUE(whole(worker_->request(request_)));
    EXPECT_TRUE(worker_->error());
}

TEST_F(Worker, ALostDeviceIsReplacedAndTheSameRequestGoesOn) {
    request_.frame.accumulate = true;
    request_.pictures = 2;  // so that a second picture is always made
    const auto second = [&](uint64_t number) {
        auto picture = whole(number);
        while (picture && picture->stats.accumulated < 2) picture = whole(number);
        return picture;
    };
    const auto before = second(worker_->request(request_));
    ASSERT_TRUE(before);
    worker_.reset();
    auto worker = PictureWorker::start(device(1), source_, {}, [this] { published_.release(); });
    ASSERT_TRUE(worker);
    worker_ = std::move(*worker);
    const uint64_t again = worker_->request(request_);
    ASSERT_TRUE(loss());
    EXPECT_EQ(worker_->latest(), nullptr) << "what a lost device draws is nonsense";
    worker_->set_device(device(2));  // lost again, while a picture is shown
    ASSERT_TRUE(loss());
    worker_->set_device(device());
    const auto after = second(again);
    ASSERT_TRUE(after);
    EXPECT_FALSE(worker_->lost_device());
    EXPECT_EQ(after->rgba, before->rgba);
}

TEST_F(Worker, ADeviceThatCannotBeMadeAgainCountsAsLostAndTheWorkerStillEnds) {
    ASSERT_TRUE(whole(worker_->request(request_)));
    worker_.reset();
    auto worker = PictureWorker::start(device(1), source_, {}, [this] { published_.release(); });
    ASSERT_TRUE(worker);
    worker_ = std::move(*worker);
    worker_->request(request_);
    ASSERT_TRUE(loss());
    worker_->set_device(
        {[]() -> Result<std::unique_ptr<gi::Device>> { return failed("device", "is gone"); }, [] {}});
    const auto lost = loss();
    ASSERT_TRUE(lost);
    EXPECT_EQ(lost->why, "is gone");
}

TEST_F(Worker, TellsNothingOfThePreparationOfAScanThatIsClosed) {
    request_.frame.prepares = "paths";
    request_.method.budgets.cap(20'000);
    worker_->request(request_);
    while (!worker_->latest() || worker_->latest()->stats.prepared != 1) {
        published_.acquire();
        ASSERT_TRUE(worker_->error()) << worker_->error().error().line();
        const auto latest = worker_->latest();
        ASSERT_TRUE(!latest || latest->stats.not_prepared.empty()) << latest->stats.not_prepared;
    }
    EXPECT_TRUE(test::eventually([&] { return worker_->preparing().ended; }));
    EXPECT_EQ(worker_->preparing().share, 1);
    worker_->set_source(nullptr);
    EXPECT_TRUE(test::eventually([&] { return !worker_->latest(); }));
    EXPECT_EQ(worker_->preparing().share, 0);
}

/// Overwrites a part of a file with zeros; `from` and `to` are shares of its size.
void damage(const std::string& file, double from, double to) {
    const auto size = static_cast<double>(std::filesystem::file_size(file));
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(static_cast<std::streamoff>(size * from));
    bytes << std::string(static_cast<size_t>(size * (to - from)), '\0');
}

TEST_F(Worker, ANodeThatCannotBeReadIsNamedAndLeftOutAndTheOthersAreShown) {
    damage(cache_, 0.5, 0.55);  // while the file is open
    const uint64_t number = worker_->request(request_);
    const auto picture = whole(number);
    ASSERT_TRUE(picture) << worker_->error().error().line();
    EXPECT_GT(picture->stats.nodes_lost, 0u);
    EXPECT_THAT(picture->stats.lost_node, testing::HasSubstr("cornell.luc: node "));
    EXPECT_LT(picture->stats.ready_points, picture->stats.wanted_points);
    EXPECT_GT(picture->stats.view_points, 0u);
    EXPECT_TRUE(picture->pick({0.5, 0.5}));
}

TEST_F(Worker, ASourceThatLosesNodesTakesAnothersPlaceAllTheSame) {
    ASSERT_TRUE(whole(worker_->request(request_)));
    const std::string copy = folder_ / "copy.luc";
    std::filesystem::copy_file(cache_, copy);
    const auto other = open_input(copy);
    ASSERT_TRUE(other);
    std::filesystem::resize_file(copy, std::filesystem::file_size(copy) / 2);
    worker_->set_source(*other);
    std::shared_ptr<const Picture> picture;
    while (!picture || picture->source != *other) {
        published_.acquire();
        ASSERT_TRUE(worker_->error()) << worker_->error().error().line();
        picture = worker_->latest();
    }
    EXPECT_GT(picture->stats.nodes_lost, 0u);
    EXPECT_THAT(picture->stats.lost_node, testing::HasSubstr("copy.luc"));
    EXPECT_EQ(picture->size.width, 96u);
}

}  // namespace
}  // namespace lucarne::viewer
