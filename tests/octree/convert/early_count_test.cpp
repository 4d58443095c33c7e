// Points are counted for the chunk plan in the pass that finds their bounds, if the headers state the right
// box. The cache must have the same bytes whatever they state.
#include "octree/convert/scans/early_count.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/convert/build.h"
#include "octree/convert/nodes/build_listener.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using io::PositionType;
using test::ComputedSource;
using test::TempFolder;
using Box = std::array<glm::dvec3, 2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity(),
                 kNan = std::numeric_limits<double>::quiet_NaN();

/// A scan whose description can be changed. Counts the passes over its points.
class WatchedSource final : public io::PointSource {
 public:
    explicit WatchedSource(const io::PointSource& points) : points_(points), info_(points.info()) {}
    const io::Schema& schema() const override { return points_.schema(); }
    const io::ScanInfo& info() const override { return info_; }
    io::ScanInfo& info() { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        ++passes_;
        return points_.open();
    }
    int passes() const { return passes_; }

 private:
    const io::PointSource& points_;
    io::ScanInfo info_;
    mutable int passes_ = 0;
};

/// A bumpy floor, longest in x, far from the origin. `scale` is only for integers.
ComputedSource floor_scan(PositionType position, uint64_t points, uint64_t seed = 1, double scale = 0.001) {
    io::Schema schema;
    schema.position = position;
    if (position == PositionType::i32_scaled) {
        schema.scale = glm::dvec3(scale);
        schema.offset = glm::dvec3(4.0e5 + 0.1, 5.0e6, 100.7);
    }
    schema.stride = static_cast<uint32_t>(io::position_bytes(position));
    schema.add("intensity", io::ScalarType::u16);
    return {schema, points, [schema, seed](uint64_t index, std::byte* record) {
                Random random(seed, index);
                const double x = 20 * random.uniform() * random.uniform(), y = 9 * random.uniform();
                const glm::dvec3 p(x, y, 0.3 * std::sin(x) * std::cos(2 * y));
                for (int axis = 0; axis < 3; ++axis) {
                    const auto at = static_cast<size_t>(axis);
                    if (schema.position == PositionType::i32_scaled)
                        io::store(record + 4 * at,
                                  static_cast<int32_t>(std::lround(p[axis] / schema.scale[axis])));
                    if (schema.position == PositionType::f32)
                        io::store(record + 4 * at, static_cast<float>(p[axis] + 50));
                    if (schema.position == PositionType::f64) io::store(record + 8 * at, p[axis] + 5.0e5);
                }
                io::store(record + io::position_bytes(schema.position), static_cast<uint16_t>(random.next()));
            }};
}

/// Returns the true box of a scan's points.
Box box_of(const io::PointSource& source) {
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    const auto all = io::testing::read_all(source).value();
    for (size_t i = 0; i < all.count; ++i) {
        const auto p = io::position_of(source.schema(), &all.bytes[i * source.schema().stride]);
        box = {glm::min(box[0], p), glm::max(box[1], p)};
    }
    return box;
}

/// Returns the bytes of the cache of these scans, built in the least memory. With normals there must be
/// several chunks, because estimates depend on them.
std::string cache_of(std::vector<const io::PointSource*> inputs, NormalsMode normals = NormalsMode::none,
                     BuildListener* listener = nullptr) {
    const TempFolder folder;
    const auto report = build_cache({.inputs = std::move(inputs),
                                     .output = folder / "a.luc",
                                     .normals = normals,
                                     .memory = uint64_t{16} << 20,
                                     .threads = 2,
                                     .listener = listener});
    EXPECT_TRUE(report) << report.error().line();
    EXPECT_TRUE(!report || normals == NormalsMode::none || report->chunks > 1);
    return io::testing::read_bytes(folder / "a.luc");
}

TEST(EarlyCount, RightBoxesSaveAPassAndChangeNoByte) {
    for (const auto position : {PositionType::i32_scaled, PositionType::f32, PositionType::f64})
        for (const auto normals : {NormalsMode::none, NormalsMode::estimate}) {
            const auto points = floor_scan(position, 60'000);
            WatchedSource silent(points), stating(points);
            stating.info().stated_box = box_of(points);
            const std::string expected = cache_of({&silent}, normals);
            EXPECT_TRUE(cache_of({&stating}, normals) == expected) << static_cast<int>(position);
            EXPECT_EQ(silent.passes(), 3);
            EXPECT_EQ(stating.passes(), 2);
        }
}

TEST(EarlyCount, StatedBoxesMayBeRoundedInAnotherWayThanIntegersAre) {
    const auto points = floor_scan(PositionType::i32_scaled, 30'000);
    WatchedSource silent(points), stating(points);
    Box box = box_of(points);
    box[0] += glm::dvec3(1e-5, -2e-4, 3e-4);
    box[1] -= glm::dvec3(-4e-4, 1e-9, 2e-6);
    stating.info().stated_box = box;
    EXPECT_TRUE(cache_of({&stating}) == cache_of({&silent}));
    EXPECT_EQ(stating.passes(), 2);
}

TEST(EarlyCount, WrongBoxesCostAPassAndChangeNoByte) {
    const auto points = floor_scan(PositionType::f64, 20'000);
    WatchedSource silent(points);
    const std::string expected = cache_of({&silent});
    const auto [low, high] = box_of(points);
    const glm::dvec3 x(1, 0, 0), z(0, 0, 1);
    const double next = std::nextafter(low.y, -kInfinity) - low.y;
    const std::vector<std::pair<const char*, Box>> boxes = {
        {"large", {low - 5.0, high + 5.0}},
        {"longer", {low, high + x}},
        {"long", {low, high + 1e6 * x}},
        {"small", {low + 1.0, high - 1.0}},
        {"shorter", {low, high - x}},
        {"shifted", {low + 3.0, high + 3.0}},
        {"one step lower", {low + glm::dvec3(0, next, 0), high}},
        {"elsewhere", {-low, -low + x}},
        {"a point", {low, low}},
        {"zero", {glm::dvec3(0), glm::dvec3(0)}},
        {"reversed", {high, low}},
        {"reversed in z", {low + z, high - z}},
        {"NaN", {glm::dvec3(kNan), glm::dvec3(kNan)}},
        {"NaN in z", {low, {high.x, high.y, kNan}}},
        {"infinite", {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)}},
        {"infinite in z", {low, {high.x, high.y, kInfinity}}},
        {"infinitely far", {glm::dvec3(kInfinity), glm::dvec3(kInfinity)}},
        {"enormous", {glm::dvec3(-1e308), glm::dvec3(1e308)}},
        {"less enormous", {glm::dvec3(-1e299), glm::dvec3(1e299)}},
    };
    for (const auto& [what, box] : boxes) {
        WatchedSource stating(points);
        stating.info().stated_box = box;
        EXPECT_TRUE(cache_of({&stating}) == expected) << what;
        EXPECT_EQ(stating.passes(), 3) << what;
    }
    for (const auto position : {PositionType::i32_scaled, PositionType::f32}) {
        const auto other = floor_scan(position, 5'000);
        WatchedSource quiet(other);
        const std::string without = cache_of({&quiet});
        for (const auto& [what, box] : boxes) {
            WatchedSource stating(other);
            stating.info().stated_box = box;
            EXPECT_TRUE(cache_of({&stating}) == without) << what;
            EXPECT_EQ(stating.passes(), 3) << what;
        }
    }
}

TEST(EarlyCount, OnlyTheCubeOfTheStatedBoxHasToBeRight) {
    const auto points = floor_scan(PositionType::f64, 30'000);
    WatchedSource silent(points), stating(points);
    Box box = box_of(points);
    box[1].z += 2;  // the box is far longer in x
    stating.info().stated_box = box;
    EXPECT_TRUE(cache_of({&stating}) == cache_of({&silent}));
    EXPECT_EQ(stating.passes(), 2);
}

TEST(EarlyCount, StatedNumbersOfPointsMayBeTooLargeAndNotTooSmall) {
    const auto points = floor_scan(PositionType::i32_scaled, 150'000);
    for (const auto& [declared, passes] :
         {std::pair<uint64_t, int>{0, 3}, {1, 3}, {60'000, 3}, {140'000, 2}, {900'000, 2}, {UINT64_MAX, 2}}) {
        WatchedSource silent(points), stating(points);
        silent.info().declared_points = stating.info().declared_points = declared;
        stating.info().stated_box = box_of(points);
        EXPECT_TRUE(cache_of({&stating}, NormalsMode::estimate) == cache_of({&silent}, NormalsMode::estimate))
            << declared;
        EXPECT_EQ(stating.passes(), passes) << declared;
    }
}

TEST(EarlyCount, SeveralInputsAreCountedIfEachWithPointsStatesItsBox) {
    const auto fine = floor_scan(PositionType::i32_scaled, 30'000, 1),
               coarse = floor_scan(PositionType::i32_scaled, 20'000, 2, 0.01),
               floats = floor_scan(PositionType::f32, 10'000, 3), none = floor_scan(PositionType::f64, 0);
    const auto build = [&](bool all, int passes) {
        WatchedSource a(fine), b(coarse), c(floats), empty(none);
        if (passes == 2) {
            a.info().stated_box = box_of(fine);
            b.info().stated_box = box_of(coarse);
        }
        if (all) c.info().stated_box = box_of(floats);
        std::string cache = cache_of({&a, &empty, &b, &c});
        for (const WatchedSource* source : {&a, &b, &c, &empty})
            EXPECT_EQ(source->passes(), all ? passes : 3);
        return cache;
    };
    const std::string expected = build(false, 3);
    EXPECT_TRUE(build(true, 2) == expected);
    EXPECT_TRUE(build(false, 2) == expected);
}

/// A scan that has more points in each pass than in the one before.
class LengtheningSource final : public io::PointSource {
 public:
    explicit LengtheningSource(const ComputedSource& points) : points_(points) {}
    const io::Schema& schema() const override { return points_.schema(); }
    const io::ScanInfo& info() const override { return points_.info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        current_ = std::make_unique<ComputedSource>(
            floor_scan(PositionType::f64, points_.points() + static_cast<uint64_t>(passes_++)));
        return current_->open();
    }

 private:
    const ComputedSource& points_;
    mutable std::unique_ptr<ComputedSource> current_;
    mutable int passes_ = 0;
};

TEST(EarlyCount, ChangesAfterwardsAreNoticed) {
    auto points = floor_scan(PositionType::f64, 20'000);
    points.info().stated_box = box_of(points);
    const LengtheningSource growing(points);
    const TempFolder folder;
    const auto report = build_cache({.inputs = {&growing}, .output = folder / "a.luc"});
    ASSERT_FALSE(report);
    EXPECT_NE(report.error().line().find("changed while they were read"), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Notes how far the distribution of the points came.
class SortingProgress final : public BuildListener {
 public:
    void read(std::span<const std::byte>) override {}
    void scanned(const SourceHeader&, const io::Schema&) override {}
    void building(const io::Schema&) override {}
    void settled(std::span<const format::Entry>) override {}
    void pending(const Pending&, std::span<const std::byte>, const CacheWriter&) override {}
    void advanced(std::string_view stage, uint64_t done, uint64_t total) override {
        if (stage == "sorting into chunks") done_ = done, total_ = total;
    }
    bool stopped() const override { return false; }
    uint64_t done() const { return done_; }
    uint64_t total() const { return total_; }

 private:
    uint64_t done_ = 0, total_ = 0;
};

TEST(EarlyCount, ProgressReachesItsEndInEitherCase) {
    const auto points = floor_scan(PositionType::f64, 30'000);
    for (const bool states : {false, true}) {
        WatchedSource source(points);
        if (states) source.info().stated_box = box_of(points);
        SortingProgress progress;
        cache_of({&source}, NormalsMode::none, &progress);
        EXPECT_EQ(progress.total(), (states ? 1u : 2u) * 30'000u);
        EXPECT_EQ(progress.done(), progress.total());
    }
}

/// Six doubles of a LAS header: for each axis the highest and the lowest coordinate.
constexpr std::streamoff kLasBox = 179;
using LasBox = std::array<double, 6>;

/// Replaces the stated box of a LAS or LAZ file and nothing else.
void state(const std::filesystem::path& path, const LasBox& box) {
    const auto changed = std::filesystem::last_write_time(path);
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(kLasBox);
        file.write(reinterpret_cast<const char*>(box.data()), sizeof box);
        ASSERT_TRUE(file.good());
    }
    std::filesystem::last_write_time(path, changed);
}

TEST(EarlyCount, HeadersOfFilesThatLieChangeNoByte) {
    const TempFolder folder;
    const auto points = floor_scan(PositionType::i32_scaled, 40'000);
    for (const char* name : {"a.las", "a.laz"}) {
        const auto path = folder / name;
        const auto writer = io::create_scan(path, points.schema(), points.info(), {});
        ASSERT_TRUE(writer) << writer.error().line();
        ASSERT_TRUE((*writer)->write(io::testing::read_all(points).value().bytes));
        ASSERT_TRUE((*writer)->finish());

        LasBox right{};
        const std::string bytes = io::testing::read_bytes(path);
        std::memcpy(right.data(), &bytes[kLasBox], sizeof right);
        const auto convert = [&](const LasBox& box, int passes) {
            state(path, box);
            const auto scan = io::open_scan(path);
            EXPECT_TRUE(scan) << scan.error().line();
            const WatchedSource watched(**scan);
            std::string cache = cache_of({&watched});
            EXPECT_EQ(watched.passes(), passes) << name << fmt::format(" {}", fmt::join(box, " "));
            return cache;
        };
        const auto changed = [&](const std::function<double(double, bool high)>& change) {
            LasBox box = right;
            for (size_t i = 0; i < box.size(); ++i) box[i] = change(box[i], i % 2 == 0);
            return box;
        };
        const std::string expected = convert(right, 2);
        for (const LasBox& box : {
                 changed([](double at, bool high) { return high ? at + 7 : at - 7; }),
                 changed([](double at, bool high) { return high ? at - 0.1 : at + 0.1; }),
                 changed([](double at, bool) { return at + 100; }),
                 changed([](double, bool) { return kNan; }),
                 changed([](double, bool high) { return high ? kInfinity : -kInfinity; }),
                 changed([](double, bool high) { return high ? 1e308 : -1e308; }),
                 changed([](double, bool) { return 0.0; }),
             })
            EXPECT_TRUE(convert(box, 3) == expected) << name;
    }
}

TEST(CountGrid, CoarsensToTheGridOfFewerPoints) {
    const auto points = floor_scan(PositionType::f64, 100'000);
    const Box box = box_of(points);
    const Cube cube = root_cube(box[0], box[1]).value();
    const auto all = io::testing::read_all(points).value();
    const uint64_t bytes = uint64_t{4} << 20;
    const auto counted = [&](uint64_t declared) {
        CountGrid grid({}, declared, bytes);
        for (size_t i = 0; i < all.count; ++i)
            grid.count(cube.place(io::position_of(points.schema(), &all.bytes[i * points.schema().stride])));
        return grid;
    };
    CountGrid coarse = counted(100'000), fine = counted(40'000'000), coarser = counted(1000);
    ASSERT_TRUE(fine.coarsen_for(100'000, bytes));
    EXPECT_FALSE(coarser.coarsen_for(100'000, bytes));
    const auto expected = coarse.plan(1000, 1000), planned = fine.plan(1000, 1000);
    ASSERT_EQ(planned.size(), expected.size());
    EXPECT_GT(planned.size(), 50u);
    for (size_t i = 0; i < planned.size(); ++i) {
        EXPECT_EQ(planned[i].key, expected[i].key);
        EXPECT_EQ(planned[i].first, expected[i].first);
        EXPECT_EQ(planned[i].count, expected[i].count);
    }
}

}  // namespace
}  // namespace lucarne::octree
