#include "gi/engines/paths/lamp_views.h"

#include <algorithm>
#include <numeric>

#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

/// A hall of 8 x 2 x 2 m, in one end of which lamps will be.
BakeInput hall(bool with_region) {
    std::vector<Surfel> surfels;
    const glm::vec3 x = 2.0f * kX, y = 2.0f * kY, z = 2.0f * kZ, grey(.5f);
    for (float at = 0; at < 8; at += 2) {
        scenes::add_rectangle(surfels, at * kX, x, y, 20, grey);
        scenes::add_rectangle(surfels, at * kX + z, y, x, 20, grey);
        scenes::add_rectangle(surfels, at * kX, z, x, 20, grey);
        scenes::add_rectangle(surfels, at * kX + y, x, z, 20, grey);
    }
    scenes::add_rectangle(surfels, kO, y, z, 20, grey);
    scenes::add_rectangle(surfels, 8.0f * kX, z, y, 20, grey);
    BakeInput input = input_of(std::move(surfels), 40, 256);
    if (with_region) input.lighting_region = {glm::vec3(.5f), {1.5f, 1.5f, 1.5f}};
    return input;
}

/// Returns how many entry points a lamp sees in the eighth of all directions where it sees fewest.
size_t fewest_seen(const PathsBake& bake, const tracing::SurfelTracer& tracer, const glm::vec3& lamp) {
    size_t seen[8] = {};
    for (const Entry& entry : bake.entries) {
        if (glm::dot(lamp - entry.position, entry.normal) <= 0 ||
            tracer.occluded(lamp, tracing::offset_origin(entry.position, entry.normal, entry.radius)))
            continue;
        const glm::vec3 to = entry.position - lamp;
        ++seen[(to.x > 0 ? 1 : 0) + (to.y > 0 ? 2 : 0) + (to.z > 0 ? 4 : 0)];
    }
    return *std::ranges::min_element(seen);
}

TEST(LampPositions, AreTheMiddlesOfARegularGrid) {
    const auto cube = lamp_positions({glm::vec3(0), glm::vec3(4)});
    ASSERT_EQ(cube.size(), 64u);
    EXPECT_EQ(cube.front(), glm::vec3(.5f));
    EXPECT_EQ(cube.back(), glm::vec3(3.5f));
    EXPECT_EQ(lamp_positions({glm::vec3(0), {4, 2, 0}}).size(), 8u) << "as far apart along each side";
    EXPECT_EQ(lamp_positions({glm::vec3(3), glm::vec3(3)}), std::vector{glm::vec3(3)}) << "one lamp's place";
}

TEST(AddSeen, RaisesWhatIsSeenMostUpToWhatIsAllowed) {
    const std::vector<float> seen = {.5f, .25f, 0, .25f};
    const std::vector<uint32_t> before = {1, 400, 3, 0}, limits = {1000, 1000, 1000, 1000};
    std::vector<uint32_t> counts = before;
    add_seen(counts, seen, limits, 1000, 1e9);
    EXPECT_EQ(counts, (std::vector<uint32_t>{500, 400, 3, 0})) << "the last one's light nothing asks for";
    counts = before;
    add_seen(counts, seen, limits, 1000, 100);
    EXPECT_NEAR(counts[0], 101, 1);
    EXPECT_LE(counts[0], 101u);
    counts = before;
    add_seen(counts, seen, std::vector<uint32_t>(4, 50), 1000, 1e9);
    EXPECT_EQ(counts, (std::vector<uint32_t>{50, 400, 3, 0})) << "none loses any";
}

TEST(LightingRegion, LampsThereSeeManyEntryPointsInAllDirections) {
    const BakeInput anywhere = hall(false), region = hall(true);
    const auto without = bake_of(anywhere), with = bake_of(region);
    ASSERT_TRUE(without && with);
    const auto tracer = tracer_of(region.cut.surfels);
    for (const glm::vec3 lamp : {glm::vec3(1), glm::vec3(.6f), glm::vec3(1.4f, .7f, 1.2f)})
        EXPECT_GT(fewest_seen(*with, *tracer, lamp), 2 * fewest_seen(*without, *tracer, lamp)) << lamp.x;
    EXPECT_LE(with->entries.size(), without->entries.size() + 50'000);
    EXPECT_EQ(with->paths.rays, without->paths.rays) << "only entry points and photons are others";
    EXPECT_EQ(with->paths.links, without->paths.links);
}

TEST(LightingRegion, EntryPointsStillStandForTheAreaOfTheirLeaf) {
    const auto with = bake_of(hall(true)), without = bake_of(hall(false));
    const EntryPoints &more = with->paths.entries, &entries = without->paths.entries;
    ASSERT_EQ(more.first.size(), entries.first.size());
    size_t raised = 0;
    for (size_t leaf = 0; leaf + 1 < entries.first.size(); ++leaf) {
        const uint32_t count = entries.first[leaf + 1] - entries.first[leaf];
        EXPECT_EQ(more.first[leaf + 1] - more.first[leaf] > 0, count > 0) << "only where something asks";
        raised += more.first[leaf + 1] - more.first[leaf] > count;
    }
    EXPECT_GT(raised, 0u);
}

TEST(LightingRegion, FromWhichNothingIsSeenChangesNothing) {
    BakeInput input = hall(true);
    input.lighting_region = {glm::vec3(100), glm::vec3(100)};
    const auto with = kPathsPrecomputes.make(), without = kPathsPrecomputes.make();
    finish(*with, input);
    finish(*without, hall(false));
    EXPECT_EQ(with->save(), without->save()) << "it sees the outside, whose light nothing asks for";
}

TEST(LightingRegion, IsPartOfWhatTheResultDependsOn) {
    BakeInput input = hall(false);
    const auto key = [&] { return bake_key("paths", kPathsPrecomputes, input); };
    const uint64_t anywhere = key();
    input.lighting_region = {glm::vec3(0), glm::vec3(1)};
    const uint64_t region = key();
    EXPECT_NE(region, anywhere);
    input.lighting_region->max.z = 2;
    EXPECT_NE(key(), region);
    Precomputes other = kPathsPrecomputes;
    other.lighting_region = false;
    EXPECT_EQ(bake_key("paths", other, input), anywhere);
}

}  // namespace
}  // namespace lucarne::gi::paths
