#include "octree/growing/growing_build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <numbers>
#include <semaphore>
#include <set>
#include <utility>

#include <gmock/gmock.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/growing/sample.h"
#include "octree/tree/attributes.h"
#include "octree/tree/footprint.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

constexpr double kSide = 20, kRadius = 3;  // m
constexpr double kSurface = kSide * kSide + 4 * std::numbers::pi * kRadius * kRadius;

/// A square and a sphere above it, line after line as from a scanner; each point has a number of its own.
std::unique_ptr<ComputedSource> scene(uint64_t points) {
    io::Schema schema;
    schema.position = io::PositionType::f64;
    schema.stride = 24;
    schema.add("number", io::ScalarType::u64);
    return std::make_unique<ComputedSource>(schema, points, [points](uint64_t index, std::byte* record) {
        Random random(7, index);
        const auto on_square = static_cast<uint64_t>(static_cast<double>(points) * kSide * kSide / kSurface);
        glm::dvec3 p;
        if (index < on_square) {
            const double row = static_cast<double>(index) / static_cast<double>(on_square);
            p = {kSide * random.uniform(), kSide * row, 0};
        } else {
            const double z =
                2 * static_cast<double>(index - on_square) / static_cast<double>(points - on_square) - 1;
            const double angle = 2 * std::numbers::pi * random.uniform(),
                         r = std::sqrt(std::max(0.0, 1 - z * z));
            p = glm::dvec3(10, 10, 8) + kRadius * glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
        }
        for (int axis = 0; axis < 3; ++axis) io::store(record + 8 * axis, p[axis]);
        io::store(record + 24, index);
    });
}

GrowingBuild::Inputs inputs_of(uint64_t points, bool seekable = true) {
    auto source = scene(points);
    if (seekable) source->make_seekable();
    GrowingBuild::Inputs inputs;
    inputs.push_back(std::move(source));
    return inputs;
}

GrowingOptions options_for(const std::filesystem::path& output, NormalsMode normals = NormalsMode::none) {
    GrowingOptions options;
    options.build.output = output;
    options.build.normals = normals;
    options.build.memory = uint64_t{32} << 20;  // small, so that there are many chunks
    options.sample_points = 20'000;
    // Every step of the build is shown, however long a source takes to make.
    options.seconds_between = 0;
    options.share_of_time = std::numeric_limits<double>::infinity();
    return options;
}

/// All sources of a build, including the first and the cache.
std::vector<std::shared_ptr<const NodeSource>> all_sources(GrowingBuild& build) {
    std::vector<std::shared_ptr<const NodeSource>> sources = {build.state().source};
    build.begin([&] {
        if (auto source = build.state().source; source != sources.back())
            sources.push_back(std::move(source));
    });
    build.wait();
    return sources;
}

std::vector<uint64_t> numbers_in(const NodeSource& source) {
    std::vector<uint64_t> numbers;
    const size_t stride = source.header().schema.stride;
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const auto data = source.load(node);
        if (!data || data->count != source.nodes()[node].count) return {};
        for (size_t i = 0; i < data->count; ++i)
            numbers.push_back(io::load<uint64_t>(&data->records[i * stride + 24]));
    }
    return numbers;
}

/// Checks the directory: parents before children, children in octant order, counts that add up.
::testing::AssertionResult is_directory(NodeTable nodes) {
    size_t next = 1;
    std::vector<uint64_t> below(nodes.size(), 0);
    if (nodes.empty() || nodes[0].key != NodeKey{}) return ::testing::AssertionFailure() << "no root";
    for (size_t i = 0; i < nodes.size(); ++i)
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (!(nodes[i].child_mask >> octant & 1)) continue;
            if (next >= nodes.size() || nodes[i].child(octant) != next || nodes[next].parent != i ||
                nodes[next].key != nodes[i].key.child(octant))
                return ::testing::AssertionFailure() << "node " << i << " lacks its child " << octant;
            ++next;
        }
    if (next != nodes.size()) return ::testing::AssertionFailure() << "nodes without parents";
    for (size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].subtree_count != nodes[i].count + below[i])
            return ::testing::AssertionFailure() << "the counts of node " << i;
        if (i > 0) below[nodes[i].parent] += nodes[i].subtree_count;
    }
    return ::testing::AssertionSuccess();
}

TEST(GrowingBuild, ItsFirstSourceCoversTheWholeExtent) {
    const TempFolder folder;
    for (const bool seekable : {true, false}) {
        const auto build = GrowingBuild::open(inputs_of(500'000, seekable), options_for(folder / "a.luc"));
        ASSERT_TRUE(build) << build.error().line();
        const auto source = (*build)->state().source;
        ASSERT_TRUE(is_directory(source->nodes()));
        const auto numbers = numbers_in(*source);
        EXPECT_GT(numbers.size(), 15'000u);
        EXPECT_LT(numbers.size(), 45'000u);
        // Each hundredth of the file has the same number, within random variation.
        std::array<size_t, 100> parts{};
        for (const uint64_t number : numbers) ++parts[number / 5000];
        const size_t even = numbers.size() / parts.size();
        EXPECT_GE(*std::ranges::min_element(parts), even / 2);
        EXPECT_LE(*std::ranges::max_element(parts), even * 2);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is converted before it is begun";
}

TEST(GrowingBuild, EverySourceKnowsWhichPointsNoCameraSaw) {
    const TempFolder folder;
    io::Schema schema;
    schema.add("color", io::ScalarType::u8, 3);
    constexpr uint64_t kPoints = 100'000;
    auto scan = std::make_unique<ComputedSource>(schema, kPoints, [](uint64_t index, std::byte* record) {
        Random random(7, index);
        const glm::dvec3 p(random.uniform(), static_cast<double>(index) / kPoints, 0);
        const auto grey = static_cast<uint8_t>(p.x < 0.2 ? 0 : 40 + 160 * random.uniform());
        for (int axis = 0; axis < 3; ++axis) io::store(record + 8 * axis, p[axis]);
        io::store(record + 24, std::array<uint8_t, 3>{grey, grey, grey});
    });
    scan->make_seekable();
    GrowingBuild::Inputs inputs;
    inputs.push_back(std::move(scan));
    const auto build = GrowingBuild::open(std::move(inputs), options_for(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    const auto sources = all_sources(**build);
    EXPECT_GE(sources.size(), 3u);
    for (const auto& source : sources) {
        const auto& colours = source->header().station_colours;
        ASSERT_EQ(colours.size(), 1u);
        ASSERT_TRUE(colours[0].unphotographed);
        EXPECT_NEAR(colours[0].unphotographed->x, 0.22, 0.02);
    }
}

TEST(GrowingBuild, EndsWithTheCacheThatABuildAloneMakes) {
    const TempFolder folder;
    const auto build = GrowingBuild::open(inputs_of(200'000), options_for(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    const auto last = all_sources(**build).back();
    EXPECT_TRUE((*build)->state().finished);
    BuildOptions alone = options_for(folder / "b.luc").build;
    const auto inputs = inputs_of(200'000);
    alone.inputs = {inputs[0].get()};
    ASSERT_TRUE(build_cache(alone));
    EXPECT_EQ(io::testing::read_bytes(folder / "a.luc"), io::testing::read_bytes(folder / "b.luc"));
    const auto cache = open_cache(folder / "a.luc");
    ASSERT_TRUE(cache);
    EXPECT_EQ(last->nodes().size(), (*cache)->nodes().size());
}

/// The sum of the areas that a cut down to `level` shows, computed as gi/scene does.
double surface_at(const NodeSource& source, uint32_t level) {
    const auto& schema = source.header().schema;
    const auto* area = schema.find(io::names::area);
    const auto nodes = source.nodes();
    double sum = 0;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].key.level > level) continue;
        const auto data = source.load(i);
        if (!data) return 0;
        for (size_t p = 0; p < data->count; ++p) {
            const std::byte* record = &data->records[p * schema.stride];
            const auto own = static_cast<float>(
                decode_area(io::load<uint16_t>(record + area->offset), source.header().root.size));
            const Place place = source.header().root.place(io::position_of(schema, record));
            uint32_t node = i;
            bool whole = false;  // no deeper node: the point's own share applies
            while (nodes[node].key.level < level || nodes[node].child_mask == 0) {
                const uint32_t octant = place.key(nodes[node].key.level + 1).octant();
                if (whole = !(nodes[node].child_mask >> octant & 1); whole) break;
                node = nodes[node].child(octant);
            }
            sum += surfel_area(own, whole ? 0.0f : nodes[node].area_floor[0]);
        }
    }
    return sum;
}

TEST(GrowingBuild, TheSurfaceKeepsItsAreaWhileItIsReplaced) {
    const TempFolder folder;
    const auto build =
        GrowingBuild::open(inputs_of(150'000), options_for(folder / "a.luc", NormalsMode::estimate));
    ASSERT_TRUE(build) << build.error().line();
    const auto sources = all_sources(**build);
    ASSERT_TRUE((*build)->state().error) << (*build)->state().error.error().line();
    EXPECT_GT(sources.size(), 3u);
    for (size_t i = 0; i < sources.size(); ++i)
        for (uint32_t level = 0; level < 5; ++level)
            EXPECT_NEAR(surface_at(*sources[i], level) / kSurface, 1.0, 0.1)
                << "source " << i << ", level " << level;
}

TEST(GrowingBuild, EverySourceHasEachPointOnceAndMoreOfThemThanTheLast) {
    for (const uint64_t read_points : {0, 100'000}) {
        const TempFolder folder;
        GrowingOptions options = options_for(folder / "a.luc");
        options.read_points = read_points;
        const auto build = GrowingBuild::open(inputs_of(500'000), std::move(options));
        ASSERT_TRUE(build) << build.error().line();
        const auto sources = all_sources(**build);
        ASSERT_TRUE((*build)->state().error) << (*build)->state().error.error().line();
        EXPECT_GT(sources.size(), 3u) << "something comes between the first two and the cache";
        size_t last = 0;
        for (const auto& source : sources) {
            ASSERT_TRUE(is_directory(source->nodes()));
            auto numbers = numbers_in(*source);
            ASSERT_FALSE(numbers.empty());
            EXPECT_GE(numbers.size(), last);
            last = numbers.size();
            std::ranges::sort(numbers);
            EXPECT_EQ(std::ranges::adjacent_find(numbers), numbers.end()) << "a point is drawn twice";
        }
        EXPECT_EQ(last, 500'000u);
    }
}

TEST(GrowingBuild, ItsFirstPassOverASmallScanShowsTheWholeScan) {
    const TempFolder folder;
    GrowingOptions options = options_for(folder / "a.luc", NormalsMode::estimate);
    options.read_points = 200'000;
    const auto build = GrowingBuild::open(inputs_of(150'000, false), std::move(options));
    ASSERT_TRUE(build) << build.error().line();
    const auto sources = all_sources(**build);
    ASSERT_TRUE((*build)->state().error) << (*build)->state().error.error().line();
    ASSERT_GT(sources.size(), 3u);
    const auto some = numbers_in(*sources[1]);
    EXPECT_NEAR(static_cast<double>(some.size()), 20'000, 2'000) << "soon";
    auto numbers = numbers_in(*sources[2]);
    std::ranges::sort(numbers);
    ASSERT_EQ(numbers.size(), 150'000u) << "before any node was built";
    EXPECT_EQ(std::ranges::adjacent_find(numbers), numbers.end());
    for (size_t i = 1; i < sources.size(); ++i)
        for (uint32_t level = 0; level < 5; ++level)
            EXPECT_NEAR(surface_at(*sources[i], level) / kSurface, 1.0, 0.1)
                << "source " << i << ", level " << level;
}

/// Options of a build that waits for pictures of its first pass until the end of time.
GrowingOptions patient(const std::filesystem::path& output) {
    GrowingOptions options = options_for(output);
    options.read_points = 200'000;
    options.patience = 1e6;
    return options;
}

TEST(GrowingBuild, GoesOnOnceAPictureOfItsFirstPassHasBeenSeen) {
    const TempFolder folder;
    const auto build = GrowingBuild::open(inputs_of(150'000, false), patient(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    (*build)->begin([&] { (*build)->seen((*build)->state().source.get()); });
    (*build)->wait();
    EXPECT_TRUE((*build)->state().finished);
}

TEST(GrowingBuild, StopsWhileItWaitsForAPicture) {
    const TempFolder folder;
    const auto build = GrowingBuild::open(inputs_of(150'000, false), patient(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    std::counting_semaphore<> changes(0);
    (*build)->begin([&] { changes.release(); });
    changes.acquire();  // a sample of the first pass, of which no picture is made
    (*build)->seen(nullptr);
    EXPECT_FALSE((*build)->state().finished);
    (*build)->stop();
    (*build)->wait();
    EXPECT_TRUE((*build)->state().stopped);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(GrowingBuild, APointWithoutANormalThatTheSampleMissesGetsOne) {
    const TempFolder folder;
    io::Schema schema;
    schema.add(std::string(io::names::normal), io::ScalarType::f32, 3);
    // The sample has one point in two; the one without a normal is the last.
    constexpr uint64_t kPoints = 40'000;
    for (const bool all : {true, false}) {
        auto source =
            std::make_unique<ComputedSource>(schema, kPoints, [all](uint64_t index, std::byte* record) {
                Random random(3, index);
                io::store(record, glm::dvec3(20 * random.uniform(), 20 * random.uniform(), 0));
                io::store(record + 24, glm::vec3(0, 0, all || index + 1 < kPoints ? 1 : 0));
            });
        source->make_seekable();
        GrowingBuild::Inputs inputs;
        inputs.push_back(std::move(source));
        auto build =
            GrowingBuild::open(std::move(inputs), options_for(folder / "a.luc", NormalsMode::automatic));
        ASSERT_TRUE(build) << build.error().line();
        const auto sources = all_sources(**build);
        ASSERT_TRUE((*build)->state().error) << (*build)->state().error.error().line();
        EXPECT_EQ(sources.back()->header().schema.find(io::names::normal_oct) == nullptr, all);
        std::filesystem::remove(folder / "a.luc");
    }
}

/// Begins a build and stops it when it first has another source. It cannot go on before it is stopped.
void stop_at_its_first_change(GrowingBuild& build) {
    std::counting_semaphore<> changes(0);
    std::promise<void> stopped;
    build.begin([&, goes_on = stopped.get_future().share()] {
        changes.release();
        goes_on.wait();
    });
    changes.acquire();
    build.stop();
    stopped.set_value();
    build.wait();
}

TEST(GrowingBuild, StoppedInTheMiddleItLeavesNothing) {
    const TempFolder folder;
    const auto build = GrowingBuild::open(inputs_of(500'000), options_for(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    stop_at_its_first_change(**build);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(GrowingBuild, AFailedBuildSaysWhyAndItsLastSourceStays) {
    const TempFolder folder;
    auto build = GrowingBuild::open(inputs_of(50'000), options_for(folder / "none" / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    const auto first = (*build)->state().source;
    (*build)->begin([] {});
    (*build)->wait();
    EXPECT_FALSE((*build)->state().finished);
    ASSERT_FALSE((*build)->state().error);
    EXPECT_NE((*build)->state().error.error().line().find("does not exist"), std::string::npos);
    EXPECT_EQ((*build)->state().source, first);
    EXPECT_FALSE(numbers_in(*first).empty());
}

/// Wraps a scan whose points cannot be read.
class BrokenSource final : public io::PointSource {
 public:
    explicit BrokenSource(std::unique_ptr<io::PointSource> whole) : whole_(std::move(whole)) {}
    const io::Schema& schema() const override { return whole_->schema(); }
    const io::ScanInfo& info() const override { return whole_->info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        return rejected("broken", "has a chunk of compressed points that is damaged");
    }

 private:
    std::unique_ptr<io::PointSource> whole_;
};

GrowingOptions growing_options(const std::filesystem::path& output) {
    GrowingOptions options = options_for(output);
    options.first_points = 5'000;
    options.first_read = 20'000;
    options.sample_points = 40'000;
    return options;
}

/// Points in a cube, each with its number. The last one cannot be read before `ready`.
GrowingBuild::Inputs inputs_that_wait(uint64_t points, std::shared_future<void> ready) {
    io::Schema schema;
    schema.position = io::PositionType::f64;
    schema.stride = 24;
    schema.add("number", io::ScalarType::u64);
    GrowingBuild::Inputs inputs;
    inputs.push_back(std::make_unique<ComputedSource>(schema, points, [=](uint64_t index, std::byte* record) {
        if (index == points - 1) ready.wait_for(std::chrono::minutes(1));
        Random random(3, index);
        for (int axis = 0; axis < 3; ++axis) io::store(record + 8 * axis, 20 * random.uniform());
        io::store(record + 24, index);
    }));
    return inputs;
}

TEST(GrowingBuild, ItsSampleGrowsWhileTheBuildReads) {
    const TempFolder folder;
    constexpr uint64_t kPoints = 400'000;
    // The build cannot read the last point before the sample has grown. Samples do not read that far.
    std::promise<void> grown;
    const auto build = GrowingBuild::open(inputs_that_wait(kPoints, grown.get_future().share()),
                                          growing_options(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    std::vector<uint64_t> points = {(*build)->state().source->nodes()[0].subtree_count};
    EXPECT_EQ(points.front(), 5'000u);
    EXPECT_TRUE((*build)->state().source->header().has_gaps) << "only the file's front was read";
    bool told = false;
    (*build)->begin([&] {
        const auto source = (*build)->state().source;
        points.push_back(source->nodes()[0].subtree_count);
        EXPECT_TRUE(is_directory(source->nodes()));
        if (points.back() == 40'000 && !std::exchange(told, true)) grown.set_value();
    });
    (*build)->wait();
    EXPECT_TRUE((*build)->state().finished);
    EXPECT_FALSE((*build)->state().source->header().has_gaps);
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end())) << "a later source has fewer points";
    EXPECT_THAT(std::set<uint64_t>(points.begin(), points.end()),
                ::testing::IsSupersetOf({5'000u, 10'000u, 20'000u, 40'000u, unsigned{kPoints}}));
}

TEST(GrowingBuild, WhatItHasReadIsShownBeforeAllIsRead) {
    const TempFolder folder;
    constexpr uint64_t kPoints = 400'000, kFar = 200'000;  // no sketch reads as far
    std::promise<void> seen;
    GrowingOptions options = growing_options(folder / "a.luc");
    options.read_points = kPoints;
    const auto build =
        GrowingBuild::open(inputs_that_wait(kPoints, seen.get_future().share()), std::move(options));
    ASSERT_TRUE(build) << build.error().line();
    bool told = false;
    (*build)->begin([&] {
        const auto source = (*build)->state().source;
        if (told || !source->header().has_gaps) return;
        auto numbers = numbers_in(*source);
        std::ranges::sort(numbers);
        EXPECT_EQ(std::ranges::adjacent_find(numbers), numbers.end()) << "a point is drawn twice";
        if (numbers.back() < kFar || std::exchange(told, true)) return;
        // All points of the sketch, and one of ten of those that have been read.
        const auto far = std::ranges::count_if(numbers, [&](uint64_t number) { return number >= kFar; });
        EXPECT_LE(far, 21'000);
        EXPECT_GE(std::ranges::count_if(numbers, [&](uint64_t number) { return number < 20'000; }), 5'000);
        seen.set_value();
    });
    (*build)->wait();
    EXPECT_TRUE(told);
    EXPECT_TRUE((*build)->state().finished);
}

TEST(GrowingBuild, IsStoppedWhileItsSampleGrows) {
    const TempFolder folder;
    const auto build = GrowingBuild::open(inputs_of(500'000, false), growing_options(folder / "a.luc"));
    ASSERT_TRUE(build) << build.error().line();
    stop_at_its_first_change(**build);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.luc"));
}

TEST(Sketch, OneBrokenInputAmongManyIsLeftOut) {
    for (const bool all : {false, true}) {
        GrowingBuild::Inputs inputs;
        std::vector<const io::PointSource*> sources;
        for (int i = 0; i < 30; ++i) {
            inputs.push_back(scene(10'000));
            if (all || i == 7) inputs.back() = std::make_unique<BrokenSource>(std::move(inputs.back()));
            sources.push_back(inputs.back().get());
        }
        const auto unifier = Unifier::create(sources);
        ASSERT_TRUE(unifier);
        const auto sketch = take_sketch(*unifier, 3'000, 30'000);
        ASSERT_EQ(sketch.has_value(), !all);
        if (!sketch) continue;
        const io::Attribute* scan = unifier->schema().find(io::names::scan);
        ASSERT_TRUE(scan);
        std::set<int> seen;
        for (size_t i = 0; i < sketch->positions.size(); ++i)
            seen.insert(io::load<uint16_t>(&sketch->records[i * unifier->schema().stride + scan->offset]));
        EXPECT_EQ(seen.size(), 29u);
        EXPECT_FALSE(seen.contains(7));
        EXPECT_GE(sketch->positions.size(), 2'900u);
        EXPECT_LE(sketch->positions.size(), 3'600u);
    }
}

}  // namespace
}  // namespace lucarne::octree
