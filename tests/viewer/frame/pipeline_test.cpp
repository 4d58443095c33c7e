#include "viewer/frame/pipeline.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <semaphore>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/paths/options.h"
#include "gi/registry.h"
#include "tests/viewer/frame/with_cornell.h"
#include "viewer/frame/engine_bake.h"
#include "viewer/frame/quality.h"

namespace lucarne::viewer {
namespace {

/// Pictures of a small cache in which the camera sees one wall from close by.
class PipelineTest : public test::WithCornell {
 protected:
    void SetUp() override {
        WithCornell::SetUp();
        if (HasFatalFailure()) return;
        auto pipeline = Pipeline::open(*device_, source_, {});
        ASSERT_TRUE(pipeline) << pipeline.error().line();
        pipeline_ = std::move(*pipeline);
        gi::Scene scene = pipeline_->scene();
        scene.lights.resize(1);
        const auto& header = source_->header();
        scene.lights[0].position = (header.min + header.max) / 2.0;
        ASSERT_TRUE(pipeline_->set_scene(scene));
        CutBudgets budgets;
        budgets.cap(20'000);
        pipeline_->set_budgets(budgets);
        request_.size = {96, 64};
        request_.wait = true;
        request_.camera.position = header.min + .9 * (header.max - header.min);
        request_.camera.target = header.max;
        request_.camera.vertical_fov = .5;
    }
    FrameStats frame(std::string_view engine) {
        EXPECT_TRUE(pipeline_->set_engine(engine));
        const auto stats = pipeline_->render(request_);
        EXPECT_TRUE(stats) << stats.error().line();
        return stats.value_or(FrameStats{});
    }
    std::unique_ptr<Pipeline> pipeline_;
    FrameRequest request_;
};

TEST_F(PipelineTest, LoadsAndUploadsOnlyWhatTheEngineNeeds) {
    const FrameStats plain = frame("unlit");
    EXPECT_GT(plain.view_points, 0u);
    EXPECT_EQ(plain.light_points, 0u);
    EXPECT_EQ(plain.light_view_points, 0u);
    const FrameStats traced = frame("reference");
    EXPECT_GT(traced.light_points, 0u);
    EXPECT_EQ(traced.light_view_points, 0u);
    EXPECT_GT(traced.bytes_loaded, plain.bytes_loaded) << "the light cut covers what the camera does not see";
    const FrameStats lit = frame("vpl");
    EXPECT_GT(lit.light_points, 0u);
    EXPECT_GT(lit.light_view_points, 0u);
    const FrameStats again = frame("unlit");
    EXPECT_EQ(again.light_points, 0u);
    EXPECT_EQ(again.light_view_points, 0u);
    EXPECT_EQ(again.wanted_points, plain.wanted_points);
}

TEST_F(PipelineTest, AComparedEngineGetsWhatItNeedsToo) {
    gi::Scene scene = pipeline_->scene();
    scene.comparison.emplace().engine = "vpl";
    ASSERT_TRUE(pipeline_->set_scene(scene));
    const FrameStats both = frame("unlit");
    EXPECT_GT(both.light_points, 0u);
    EXPECT_GT(both.light_view_points, 0u);
}

TEST_F(PipelineTest, ExposesALitHalfBesideColoursAsItIsExposedAlone) {
    const auto picture = [&] { return pipeline_->picture().download_all<uint32_t>(96 * 64); };
    gi::Scene scene = pipeline_->scene();
    scene.exposure_ev.reset();
    ASSERT_TRUE(pipeline_->set_scene(scene));
    frame("vpl");
    const double exposure = pipeline_->exposure_ev();
    const auto lit = picture();
    EXPECT_GT(std::abs(exposure), 0.5) << "or the test shows nothing";
    frame("unlit");
    const auto colours = picture();
    scene.comparison.emplace().engine = "vpl";
    ASSERT_TRUE(pipeline_->set_scene(scene));
    frame("unlit");
    EXPECT_DOUBLE_EQ(pipeline_->exposure_ev(), exposure);
    const auto both = picture();
    for (const size_t row : {size_t{10}, size_t{50}}) {
        EXPECT_EQ(both[row * 96 + 20], colours[row * 96 + 20]);
        EXPECT_EQ(both[row * 96 + 70], lit[row * 96 + 70]);
    }
}

TEST_F(PipelineTest, SaysWhichEnginesDrewThePictureAndLeavesASlowComparedOneOutOfMotion) {
    gi::Scene scene = pipeline_->scene();
    scene.comparison.emplace().engine = "reference";
    ASSERT_TRUE(pipeline_->set_scene(scene));
    const auto passes = [](const FrameStats& stats) {
        return std::ranges::count(stats.passes, "paths", &gi::PassTimes::Pass::name);
    };
    FrameStats stats = frame("unlit");
    EXPECT_EQ(stats.lit_by, "unlit");
    EXPECT_EQ(stats.compared_with, "reference");
    EXPECT_GT(passes(stats), 0);
    request_.moving = request_.stand_in = true;
    stats = frame("unlit");
    EXPECT_EQ(stats.lit_by, "unlit");
    EXPECT_EQ(stats.compared_with, "");
    EXPECT_EQ(passes(stats), 0);
    request_.wait = false;  // else nothing is loaded for an engine that stands in
    EXPECT_EQ(frame("reference").lit_by, gi::stand_in_engine().name);
    request_.wait = true;
    request_.moving = request_.stand_in = false;
    EXPECT_EQ(frame("unlit").compared_with, "reference");
}

TEST_F(PipelineTest, ACompletePictureWaitsForItsNodesSoThatNoEngineStandsIn) {
    request_.wait = false;
    request_.stand_in_early = request_.complete = true;
    const FrameStats stats = frame("reference");
    EXPECT_EQ(stats.nodes_pending, 0u);
    EXPECT_EQ(stats.ready_points, stats.wanted_points);
    EXPECT_EQ(stats.lit_by, "reference");
}

TEST_F(PipelineTest, ShowsTheColoursAloneInThePlaceOfAnyEngineWhenAsked) {
    const auto picture = [&] { return pipeline_->picture().download_all<uint32_t>(96 * 64); };
    frame("unlit");
    const auto colours = picture();
    request_.colours_only = true;
    for (const char* engine : {"vpl", "reference"}) {
        EXPECT_EQ(frame(engine).lit_by, "unlit");
        EXPECT_EQ(picture(), colours);
    }
    request_.colours_only = false;
    EXPECT_EQ(frame("vpl").lit_by, "vpl");
}

TEST_F(PipelineTest, TheNodesOfTheEngineThatStandsInInMotionAreThereBeforeTheMotion) {
    request_.wait = false;
    while (frame("reference").complete() < 1) {  // nodes arrive while frames are drawn
    }
    request_.moving = request_.stand_in = true;
    const FrameStats moving = frame("reference");
    EXPECT_GT(moving.light_view_points, 0u);
    EXPECT_EQ(moving.complete(), 1);
}

TEST_F(PipelineTest, ASlowEngineDrawsTheMotionItselfAsLongAsItKeepsTheLight) {
    if (!device_->opencl()) GTEST_SKIP() << "no OpenCL";
    const auto drawn = [&](bool moving) {
        request_.moving = request_.stand_in = moving;
        request_.light_budget = moving ? gi::StepBudget::timed(0.01) : gi::StepBudget{};
        const auto stats = pipeline_->render(request_);
        EXPECT_TRUE(stats) << stats.error().line();
        return stats.value_or(FrameStats{});
    };
    Method method;
    method.engine = "environment";
    ASSERT_TRUE(pipeline_->set_method(method));
    EXPECT_EQ(drawn(true).lit_by, gi::stand_in_engine().name) << "there is no light yet";
    EXPECT_EQ(drawn(false).lit_by, "environment");
    request_.camera.target += glm::dvec3(0.02, 0, 0);
    const FrameStats moved = drawn(true);
    EXPECT_EQ(moved.lit_by, "environment");
    EXPECT_FALSE(std::ranges::count(moved.passes, "surfel tree", &gi::PassTimes::Pass::name));
    gi::Scene scene = pipeline_->scene();
    scene.lights[0].position.x += 0.1;
    ASSERT_TRUE(pipeline_->set_scene(scene));
    EXPECT_EQ(drawn(true).lit_by, gi::stand_in_engine().name) << "other light";
}

TEST_F(PipelineTest, TheStandInDrawsUntilSomethingIsComputedInAdvance) {
    request_.wait = false;
    request_.stand_in_early = request_.complete = true;
    FrameStats stats = frame("paths");
    while (stats.lit_by != "paths") {
        EXPECT_EQ(stats.lit_by, gi::stand_in_engine().name);
        EXPECT_EQ(std::ranges::count(stats.passes, "surfels for tracing", &gi::PassTimes::Pass::name), 0)
            << "its shadows are maps";
        stats = frame("paths");
    }
    EXPECT_TRUE(stats.prepared);
}

TEST_F(PipelineTest, PreparesForOneEngineWhileAnotherDraws) {
    request_.wait = false;
    request_.stand_in_early = request_.complete = true;
    request_.prepares = "paths";
    FrameStats stats = frame("direct");
    while (stats.prepared < 1) {
        EXPECT_EQ(stats.lit_by, "direct");
        EXPECT_EQ(stats.prepared_for, "paths");
        stats = frame("direct");
    }
    EXPECT_EQ(stats.not_kept, "");
    EXPECT_EQ(stats.prepared_file, kept_bake((*gi::find_engine("paths"))->info, *source_));
    stats = frame("paths");
    EXPECT_EQ(stats.lit_by, "paths") << "it is there at once";
    EXPECT_EQ(stats.prepared, 1);
    request_.prepares.clear();
    EXPECT_EQ(frame("direct").prepared_for, "");
}

TEST_F(PipelineTest, AMotionWithReducedSettingsStartsNoPreparationAgain) {
    // The job's thread may tell news after this test has ended.
    struct News {
        std::atomic<int> begun = 0;
        std::counting_semaphore<> told{0};
    };
    const auto news = std::make_shared<News>();
    pipeline_->on_prepared([news](const gi::BakeJob::Status& status) {
        if (status.step.empty() && status.share == 0 && !status.ended) ++news->begun;
        news->told.release();
    });
    const std::atomic<int>& begun = news->begun;
    request_.wait = false;
    request_.stand_in_early = request_.complete = true;
    request_.prepares = "paths";
    const Preset high = *find_preset("high");
    Method rest{"direct", high.engine, high.budgets};
    rest.budgets.cap(20'000);
    rest.settings.set(gi::paths::kPointSpacing, 96);
    rest.settings.set(gi::paths::kGatherRays, 64u);
    Method moving = rest;
    MovingQuality().reduce(moving.settings, moving.budgets);
    moving.budgets.light = 10'000;
    ASSERT_FALSE(moving == rest);
    double share = 0;
    const auto draw = [&](bool moves) {
        request_.at_rest = rest;
        request_.moving = request_.stand_in = moves;
        ASSERT_TRUE(pipeline_->set_method(moves ? moving : rest));
        const auto stats = pipeline_->render(request_);
        ASSERT_TRUE(stats) << stats.error().line();
        ASSERT_TRUE(stats->prepared);
        ASSERT_GE(*stats->prepared, share);
        share = *stats->prepared;
    };
    for (bool moves = false; share < 1 && begun <= 1 && !HasFailure(); moves = !moves) {
        draw(moves);
        // Pictures without pause would take all the time from the job.
        (void)news->told.try_acquire_for(std::chrono::milliseconds(200));
    }
    ASSERT_EQ(share, 1) << "it has begun again";
    draw(true);
    EXPECT_EQ(begun, 1);
    rest.settings.set(gi::kSeed, uint64_t{2});
    share = 0;
    draw(false);
    EXPECT_EQ(begun, 2) << "nobody sees the share of the last one";
    request_.prepares.clear();
    frame("direct");
    EXPECT_EQ(begun, 3) << "none is left";
}

TEST_F(PipelineTest, APreparationTellsNothingOnceAnotherScanIsOpen) {
    struct News {
        std::atomic<double> share = 0;
        std::counting_semaphore<> told{0};
    };
    const auto news = std::make_shared<News>();
    pipeline_->on_prepared([news](const gi::BakeJob::Status& status) {
        news->share = status.share;
        news->told.release();
    });
    request_.wait = false;
    request_.prepares = "paths";
    frame("direct");
    while (news->share == 0) news->told.acquire();
    const test::TemporaryFolder folder;
    const auto other = open_input(test::make_cornell(folder, "30k"));
    ASSERT_TRUE(other) << other.error().line();
    ASSERT_TRUE(pipeline_->set_source(*other));
    EXPECT_EQ(news->share, 0) << "of the scan that was open";
}

TEST_F(PipelineTest, APreparationThatFailedBeginsAgainOnlyIfItIsAskedForAgain) {
    const auto cache = source_->identity()->file;
    const std::string copy = folder_ / "copy.luc";
    std::filesystem::copy_file(cache, copy);
    const auto size = static_cast<size_t>(std::filesystem::file_size(cache));
    const auto overwrite = [&](const std::string& bytes) {  // while the file is open
        std::fstream(cache, std::ios::in | std::ios::out | std::ios::binary) << bytes;
    };
    std::ostringstream kept;
    kept << std::ifstream(copy, std::ios::binary).rdbuf();
    request_.wait = false;
    request_.stand_in_early = true;
    request_.prepares = "paths";
    const auto ended = [&] {
        FrameStats stats = frame("direct");
        while (stats.not_prepared.empty() && stats.prepared < 1) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));  // pictures delay the job
            stats = frame("direct");
        }
        EXPECT_EQ(stats.prepares_again, request_.prepares_again);
        return stats.not_prepared;
    };
    std::string damaged = kept.str();
    std::fill(damaged.begin() + static_cast<ptrdiff_t>(size / 4),
              damaged.begin() + static_cast<ptrdiff_t>(size / 2), '\0');
    overwrite(damaged);
    EXPECT_NE(ended(), "");
    overwrite(kept.str());
    EXPECT_NE(ended(), "") << "nobody has asked again";
    request_.prepares_again = 1;
    EXPECT_EQ(ended(), "");
}

TEST_F(PipelineTest, KeptPreparationsAreFoundUnlessTheScanIsNewer) {
    const gi::EngineInfo& paths = (*gi::find_engine("paths"))->info;
    EXPECT_TRUE(kept_bake(paths, *source_).empty());
    EXPECT_TRUE(kept_bake((*gi::find_engine("vpl"))->info, *source_).empty());
    ASSERT_TRUE(pipeline_->set_engine("paths"));
    const auto file = pipeline_->prepare();
    ASSERT_TRUE(file) << file.error().line();
    EXPECT_EQ(kept_bake(paths, *source_), *file);
    const auto cache = source_->identity()->file;
    const auto kept_at = std::filesystem::last_write_time(*file);
    std::filesystem::last_write_time(cache, kept_at + std::chrono::hours(1));
    EXPECT_TRUE(kept_bake(paths, *source_).empty()) << "the scan was converted again";
    std::filesystem::last_write_time(cache, kept_at);
    EXPECT_EQ(kept_bake(paths, *source_), *file);
    std::ofstream(*file) << "damaged";
    EXPECT_TRUE(kept_bake(paths, *source_).empty());
}

TEST_F(PipelineTest, TheStandInDrawsUntilAllNodesAreThere) {
    request_.wait = false;
    request_.stand_in_early = true;
    const auto is_traced = [](const FrameStats& stats) {
        return std::ranges::any_of(stats.passes, [](const auto& pass) { return pass.name == "paths"; });
    };
    for (;;) {
        const FrameStats stats = frame("reference");
        if (!is_traced(stats)) continue;
        EXPECT_EQ(stats.complete(), 1);
        break;
    }
}

}  // namespace
}  // namespace lucarne::viewer
