#include "gi/engines/paths/bake.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <utility>

#include "gi/engines/paths/interpolation.h"
#include "io/core/random.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

BakeInput small_box() {
    return input_of(scenes::closed_box(1, 24, glm::vec3(.5f)), 80, 64);
}

TEST(PathsBake, RestoredIsTheSameBitForBit) {
    const BakeInput input = small_box();
    const auto work = kPathsPrecomputes.make();
    EXPECT_EQ(work->share(), 0);
    ASSERT_NE(finish(*work, input), nullptr);
    EXPECT_EQ(work->share(), 1);
    const auto restored = kPathsPrecomputes.make();
    const auto done = restored->restore(input, work->save());
    ASSERT_TRUE(done) << done.error().line();
    EXPECT_EQ(restored->share(), 1);
    EXPECT_EQ(restored->save(), work->save());
}

TEST(PathsBake, AnInterruptedOneIsContinuedAsIfItHadNeverBeenStopped) {
    const BakeInput input = small_box();
    const auto whole = kPathsPrecomputes.make();
    finish(*whole, input);
    for (const int taken : {1, 4, 12, 18, 24, 30, 40, 60}) {
        const auto first = kPathsPrecomputes.make();
        StepRunner<const BakeInput> runner;
        runner.start(first->steps(input));
        for (int i = 0; i < taken; ++i) ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
        const auto second = kPathsPrecomputes.make();
        if (first->share() > 0) {
            const auto done = second->restore(input, first->save());
            ASSERT_TRUE(done) << done.error().line();
        }
        finish(*second, input);
        EXPECT_EQ(second->save(), whole->save()) << taken;
    }
}

TEST(PathsBake, OneThatWasBegunWithOtherPartsOfDiscsBeginsAgain) {
    // The same scene as two processors might see it: a wall cuts other discs of the floor.
    const auto with_wall_at = [](float x) {
        std::vector<Surfel> surfels = scenes::closed_box(1, 24, glm::vec3(.5f));
        scenes::add_rectangle(surfels, {x, 0, 0}, kY, .5f * kZ, 16, glm::vec3(.5f));
        return input_of(std::move(surfels), 80, 64);
    };
    const BakeInput before = with_wall_at(.517f), now = with_wall_at(.5f);
    const auto fresh = kPathsPrecomputes.make(), begun = kPathsPrecomputes.make();
    finish(*fresh, now);
    StepRunner<const BakeInput> runner;
    runner.start(begun->steps(before));
    while (begun->share() < .3) ASSERT_TRUE(runner.run(before, StepBudget::timed(0)));
    ASSERT_LT(begun->share(), 1);
    const auto continued = kPathsPrecomputes.make();
    ASSERT_TRUE(continued->restore(now, begun->save()));
    StepRunner<const BakeInput> second;
    second.start(continued->steps(now));
    while (!continued->snapshot() && second.running()) ASSERT_TRUE(second.run(now, StepBudget::timed(0)));
    EXPECT_LT(continued->share(), .1) << "coarse paths come first, as in a new one";
    ASSERT_TRUE(second.run(now, StepBudget{}));
    EXPECT_EQ(continued->save(), fresh->save());
}

TEST(PathsBake, LooksForHiddenNeighboursInStepsThatCanBeStopped) {
    const BakeInput input = input_of(scenes::closed_box(1, 50, glm::vec3(.5f)), 10, 64);
    const auto work = kPathsPrecomputes.make();
    StepRunner<const BakeInput> runner;
    runner.start(work->steps(input));
    const auto is_looking = [&] { return runner.step() == "hidden neighbours" && work->share() > .1; };
    while (runner.running() && !is_looking()) ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
    size_t steps = 0;
    double share = work->share();
    for (; is_looking(); ++steps) {
        const auto stopped = kPathsPrecomputes.make();
        ASSERT_TRUE(stopped->restore(input, work->save())) << "what is done by then is kept";
        ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
        EXPECT_GT(work->share(), std::exchange(share, work->share()));
    }
    EXPECT_GT(steps, 1u);
    ASSERT_TRUE(runner.run(input, StepBudget{}));
    EXPECT_EQ(work->share(), 1);
}

TEST(PathsBake, MakesGroupsAndEntryPointsInStepsThatCanBeStopped) {
    const BakeInput input = input_of(scenes::closed_box(1, 60, glm::vec3(.5f)), 40, 64);
    const auto work = kPathsPrecomputes.make();
    StepRunner<const BakeInput> runner;
    runner.start(work->steps(input));
    std::map<std::string, size_t> steps;
    while (runner.running()) {
        ++steps[std::string(runner.step())];
        ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
    }
    // Of the coarse paths and of all.
    for (const char* name : {"groups", "larger groups", "entry points"}) EXPECT_GT(steps[name], 4u) << name;
}

TEST(PathsBake, CoarsePathsAreUsableBeforeAllAreMade) {
    const BakeInput input = small_box();
    const auto work = kPathsPrecomputes.make();
    StepRunner<const BakeInput> runner;
    runner.start(work->steps(input));
    while (!work->snapshot() && runner.running()) ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
    const auto coarse = std::dynamic_pointer_cast<const PathsBake>(work->snapshot());
    ASSERT_NE(coarse, nullptr);
    EXPECT_GT(work->share(), 0);
    EXPECT_LT(work->share(), .1);
    EXPECT_GT(coarse->paths.points.size(), 6u);
    ASSERT_TRUE(runner.run(input, StepBudget{}));
    const auto all = std::dynamic_pointer_cast<const PathsBake>(work->snapshot());
    EXPECT_GT(all->paths.points.size(), 2 * coarse->paths.points.size());
    EXPECT_EQ(work->share(), 1);
}

TEST(PathsBake, TheFinishedShareNeverFalls) {
    const BakeInput input = small_box();
    const auto work = kPathsPrecomputes.make();
    StepRunner<const BakeInput> runner;
    runner.start(work->steps(input));
    double share = 0;
    while (runner.running()) {
        const std::string step(runner.step());
        ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
        EXPECT_GE(work->share(), share) << step;
        share = work->share();
    }
    EXPECT_EQ(share, 1);
}

TEST(PathsBake, NothingCoarseIsMadeThatNobodySees) {
    BakeInput input = small_box();
    const auto shown = kPathsPrecomputes.make(), unshown = kPathsPrecomputes.make();
    finish(*shown, input);
    input.is_shown = false;
    StepRunner<const BakeInput> runner;
    runner.start(unshown->steps(input));
    while (!unshown->snapshot() && runner.running()) ASSERT_TRUE(runner.run(input, StepBudget::timed(0)));
    EXPECT_EQ(unshown->share(), 1);
    EXPECT_EQ(unshown->save(), shown->save());
}

TEST(PathsBake, ChangedColoursAndMaterialsNeedNoRay) {
    BakeInput input = small_box();
    const auto old = kPathsPrecomputes.make();
    finish(*old, input);
    for (size_t i = 0; i < input.cut.surfels.size(); ++i) {
        input.cut.surfels[i].albedo = glm::vec3(static_cast<float>(i % 7) / 7);
        input.cut.surfels[i].material = static_cast<uint32_t>(i % 3);
    }
    EXPECT_FALSE(kPathsPrecomputes.colours || kPathsPrecomputes.materials || kPathsPrecomputes.lights ||
                 kPathsPrecomputes.environment);
    const auto edited = kPathsPrecomputes.make();
    ASSERT_TRUE(edited->restore(input, old->save()));
    const auto with_edit = std::dynamic_pointer_cast<const PathsBake>(edited->snapshot());
    const auto fresh = bake_of(input);
    ASSERT_EQ(with_edit->entries.size(), fresh->entries.size());
    for (size_t i = 0; i < fresh->entries.size(); ++i) {
        EXPECT_EQ(with_edit->entries[i].albedo, fresh->entries[i].albedo);
        EXPECT_EQ(with_edit->entries[i].material, fresh->entries[i].material);
        EXPECT_EQ(with_edit->entries[i].position, fresh->entries[i].position);
    }
    EXPECT_EQ(edited->save(), old->save());
}

TEST(PathsBake, DamagedSectionsAreRefusedOrHarmless) {
    const BakeInput input = small_box();
    const auto work = kPathsPrecomputes.make();
    finish(*work, input);
    const BakeSections whole = work->save();
    Random random(5);
    size_t refused = 0;
    for (const auto& [name, bytes] : whole) {
        BakeSections without = whole;
        without.erase(name);
        EXPECT_FALSE(kPathsPrecomputes.make()->restore(input, without)) << name;
        BakeSections shorter = whole;
        if (bytes.empty()) continue;  // nothing can be cut off
        shorter[name].resize(bytes.size() / 2 / 4 * 4);
        EXPECT_FALSE(kPathsPrecomputes.make()->restore(input, shorter)) << name;
        for (int i = 0; i < 8 && !bytes.empty(); ++i) {
            BakeSections wrong = whole;
            const size_t at = random.next() % (bytes.size() / 4) * 4;
            const uint32_t word = i % 2 ? 0x7fffffffu : static_cast<uint32_t>(random.next());
            std::memcpy(wrong[name].data() + at, &word, 4);
            refused += !kPathsPrecomputes.make()->restore(input, wrong);
        }
    }
    EXPECT_GT(refused, 50u);
}

TEST(PathsBake, EntryPointsStandForEqualPartsOfTheirGroup) {
    const auto bake = bake_of(small_box());
    const EntryPoints& entries = bake->paths.entries;
    double covered = 0;
    for (uint32_t leaf = 0; leaf < bake->paths.groups.leaves; ++leaf) {
        if (entries.first[leaf] == entries.first[leaf + 1]) continue;
        covered += bake->paths.groups.area[leaf];
    }
    EXPECT_NEAR(covered, 6, 1e-3) << "the inner sides; no ray meets the outer ones";
    for (const Side side : entries.sides) EXPECT_EQ(side % 2, 0u);
}

TEST(PathsBake, SliversOfSurfacesHaveFewerLinks) {
    // A surfel outside, so that the last cells along each edge of the box hold a quarter of what others do.
    std::vector<Surfel> surfels = scenes::closed_box(1, 60, glm::vec3(.5f));
    surfels.push_back({glm::vec3(1.306f), kZ, glm::vec3(.5f), .01f, 1e-4f, 0});
    const auto bake = bake_of(input_of(surfels, 80));
    ASSERT_NE(bake, nullptr);
    const Links& links = bake->paths.links;
    std::map<size_t, float> largest;  // leaf whose surface has so many links, m^2
    for (uint32_t leaf = 0; leaf < bake->paths.groups.leaves; ++leaf) {
        const uint32_t origin = links.origin_of[leaf];
        if (origin == kNone) continue;
        const size_t count = links.groups_of(origin).size() + links.open_of(origin).size();
        EXPECT_FLOAT_EQ(links.share_of_one(origin), 1 / static_cast<float>(count));
        largest[count] = std::max(largest[count], bake->paths.groups.area[leaf]);
    }
    ASSERT_TRUE(largest.contains(kFewestLinks) && largest.contains(kLinks));
    for (const auto& [count, area] : largest) {
        EXPECT_TRUE(count == kLinks || count == kLinks / 2 || count == kFewestLinks) << count;
        if (count < kLinks) {
            EXPECT_LT(area, largest[kLinks] / 2);
        }
    }
    EXPECT_LT(largest[kFewestLinks], largest[kLinks] / 4);
}

TEST(PathsBake, PointsDoNotShareLightThroughWhatStandsBetweenThem) {
    std::vector<Surfel> surfels = scenes::closed_box(1, 40, glm::vec3(.5f));
    // A fence, whose boards are too narrow for the walls of points.
    for (float y = .05f; y < 1; y += .1f)
        scenes::add_rectangle(surfels, {.5f, y, 0}, .05f * kY, .3f * kZ, 8, glm::vec3(.5f));
    const auto tracer = tracer_of(surfels);
    const auto bake = bake_of(input_of(std::move(surfels), 80, 64));
    const auto above = [&](uint32_t i) {
        const GatheringPoint& point = bake->paths.points[i];
        return tracing::offset_origin(point.position, point.normal, point.radius);
    };
    size_t shares = 0;
    for (uint32_t i = 0; i < bake->paths.points.size(); ++i) {
        float sum = 0;
        for (const PointShare& share : bake->sharing.of(i)) {
            if (share.point != i) {
                EXPECT_FALSE(tracer->occluded(above(i), above(share.point))) << i << " " << share.point;
                ++shares;
            }
            sum += share.share;
        }
        EXPECT_NEAR(sum, 1, 1e-5);
    }
    EXPECT_GT(shares, 100u);
    EXPECT_GT(bake->paths.hidden.size(), 0u);
}

TEST(PathsBake, OfScenesWithoutSurfacesIsEmpty) {
    for (const auto& surfels : {std::vector<Surfel>{}, std::vector<Surfel>(3, Surfel{}),
                                std::vector<Surfel>{{kO, kZ, glm::vec3(.5f), .1f, .01f, 0}}}) {
        const auto bake = bake_of(input_of(surfels));
        ASSERT_NE(bake, nullptr);
        EXPECT_TRUE(bake->entries.empty());
        const std::vector<glm::vec3> light(bake->paths.points.size(), kO);
        PointFinder finder(*bake);
        finder.find(kO, kZ);
        EXPECT_EQ(irradiance_of(finder.shares(), light), kO);
    }
}

TEST(Interpolation, KeepsEvenLightAndStaysOnItsSide) {
    const auto bake = bake_of(input_of(scenes::closed_box(1, 40, glm::vec3(.5f)), 60, 64));
    std::vector<glm::vec3> light;
    for (const GatheringPoint& point : bake->paths.points)
        light.push_back(point.side % 2 ? kO : glm::vec3(1, 2, 3));
    PointFinder finder(*bake);
    for (const Surfel& s : scenes::closed_box(1, 23, glm::vec3(.5f))) {
        EXPECT_TRUE(finder.find(s.position, s.normal));
        const glm::vec3 inside = irradiance_of(finder.shares(), light);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(inside[i], 1.0f + static_cast<float>(i), 1e-4f);
        finder.find(s.position, -s.normal);
        EXPECT_EQ(irradiance_of(finder.shares(), light), kO);
    }
}

}  // namespace
}  // namespace lucarne::gi::paths
