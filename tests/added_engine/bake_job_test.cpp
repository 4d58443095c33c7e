// A precomputation's thread beside those of the worker and of the test.
#include "gi/bake/bake_job.h"

#include <cstdlib>
#include <filesystem>
#include <semaphore>

#include <glm/geometric.hpp>

#include "gi/bake/bake_file.h"
#include "gi/registry.h"
#include "io/files/file.h"
#include "octree/stream/cut.h"
#include "octree/tree/robust_bounds.h"
#include "tests/added_engine/paint/mean_colour.h"
#include "tests/added_engine/paint/paint.h"
#include "tests/viewer/frame/on_worker.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

class BakeJobTest : public test::OnWorker {
 protected:
    void SetUp() override {
        cache_ = test::make_cornell(folder_, "20k");
        place_ = cache_ + ".paint.bake";
        gi::paint_hooks().steps = 0;
    }
    void TearDown() override {
        worker_.reset();
        gi::paint_hooks().before = nullptr;
    }
    /// Computes all of it and keeps it.
    void compute() {
        gi::BakeJob job(order());
        job.wait();
        EXPECT_TRUE(job.status().error) << job.status().error.error().line();
    }
    Result<gi::BakeHeader> kept() const {
        LUCARNE_ASSIGN(const auto file, InputFile::open_shared(place_));
        return gi::read_bake_header(*file);
    }
    /// Returns the order for the whole scan with default settings.
    gi::BakeOrder order() const {
        const std::shared_ptr<const octree::NodeSource> source = *open_input(cache_);
        const auto bounds = octree::robust_bounds(*source);
        const glm::dvec3 middle = (bounds[0] + bounds[1]) / 2.0;
        const gi::Scene scene = gi::default_scene(bounds[0], bounds[1]);
        gi::BakeOrder made{
            .engine = &(*gi::find_engine("paint"))->info,
            .source = source,
            .preparation = std::make_shared<const gi::SurfelPreparation>(source, scene),
            .cut = octree::light_cut(*source, middle, find_preset(kDefaultPreset)->budgets.light, {},
                                     glm::distance(bounds[0], bounds[1])),
            .file = place_};
        made.input.source = source->identity()->content;
        made.input.cut.frame = gi::local_frame(middle, source->header().metres_per_unit);
        made.input.settings = gi::default_settings(gi::Effort::interactive);
        return made;
    }
    /// Holds the job before a step until release() is called.
    void hold_before(uint32_t step) {
        gi::paint_hooks().before = [this, step](uint32_t number) {
            if (number != step) return;
            reached_.release();
            go_on_.acquire();
        };
    }
    std::string cache_, place_;
    std::binary_semaphore reached_{0}, go_on_{0};
};

TEST_F(BakeJobTest, ACancelledOneIsContinuedAsIfItHadNeverBeenStopped) {
    compute();
    const std::string whole = test::bytes_of(place_);
    std::filesystem::remove(place_);
    hold_before(3);
    gi::BakeJob job(order());
    reached_.acquire();
    job.stop();
    go_on_.release();
    job.wait();
    EXPECT_TRUE(job.status().error) << job.status().error.error().line();
    const auto header = kept();
    ASSERT_TRUE(header) << header.error().line();
    EXPECT_EQ(header->share, 4.0 / gi::paint::kMeanSteps);
    gi::paint_hooks().before = nullptr;
    gi::paint_hooks().steps = 0;
    compute();
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps - 4);
    EXPECT_EQ(test::bytes_of(place_), whole);
}

TEST_F(BakeJobTest, PicturesShowWhatIsUsableMeanwhileAndFollow) {
    const auto source = open_input(cache_);
    ASSERT_TRUE(source) << source.error().line();
    request_.method.engine = "paint";
    request_.method.settings = gi::default_settings(gi::Effort::interactive);
    hold_before(2);
    start({[] { return gi::Device::headless(); }, [] {}}, *source);
    const uint64_t number = worker_->request(request_);
    reached_.acquire();
    const auto early = whole(number);
    ASSERT_TRUE(early) << worker_->error().error().line();
    ASSERT_TRUE(early->stats.prepared);
    EXPECT_LT(*early->stats.prepared, 1);
    go_on_.release();
    for (auto picture = early; *picture->stats.prepared < 1;) {
        picture = whole(number);
        ASSERT_TRUE(picture);
    }
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps);
}

TEST_F(BakeJobTest, AnEngineThatReadsLightStandsInForOneThatReadsNone) {
    const auto source = open_input(cache_);
    ASSERT_TRUE(source) << source.error().line();
    request_.method.engine = "paint";
    request_.method.settings = gi::default_settings(gi::Effort::interactive);
    request_.frame.stand_in_early = true;
    hold_before(0);
    start({[] { return gi::Device::headless(); }, [] {}}, *source);
    const uint64_t number = worker_->request(request_);
    reached_.acquire();
    auto picture = whole(number);
    ASSERT_TRUE(picture) << worker_->error().error().line();
    EXPECT_EQ(picture->stats.lit_by, gi::stand_in_engine().name);
    go_on_.release();
    while (picture && picture->stats.lit_by != "paint") picture = whole(number);
    EXPECT_TRUE(picture);
}

TEST_F(BakeJobTest, AnUnfinishedOneNeverReplacesAFinishedOne) {
    compute();
    const std::string whole = test::bytes_of(place_);
    hold_before(1);
    gi::BakeOrder other = order();
    other.input.settings.set(*gi::find_option("mean_scale"), 3.0);
    gi::BakeJob job(std::move(other));
    reached_.acquire();
    job.stop();
    go_on_.release();
    job.wait();
    EXPECT_LT(job.status().share, 1);
    EXPECT_EQ(test::bytes_of(place_), whole);
}

TEST_F(BakeJobTest, OneThatFailsSaysWhyAndKeepsNothing) {
    gi::paint_hooks().before = [](uint32_t) { throw std::bad_alloc(); };
    gi::BakeJob job(order());
    job.wait();
    EXPECT_FALSE(job.status().error);
    EXPECT_EQ(job.status().bake, nullptr);
    EXPECT_FALSE(std::filesystem::exists(place_));
}

}  // namespace
}  // namespace lucarne::viewer
