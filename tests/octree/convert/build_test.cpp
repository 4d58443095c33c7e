#include "octree/convert/build.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

/// A LAS-like schema: 12 bytes of position, colour, intensity.
io::Schema las_like() {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.offset = glm::dvec3(4.0e5, 5.0e6, 100.0);
    schema.stride = 12;
    schema.add("color", io::ScalarType::u16, 3);
    schema.add("intensity", io::ScalarType::u16);
    return schema;
}

/// A rough hemisphere over a floor, 20 m wide, of uneven density. Every attribute is different for every
/// point.
ComputedSource hall(uint64_t points, uint64_t seed = 1) {
    return {las_like(), points, [seed](uint64_t index, std::byte* record) {
                Random random(seed, index);
                glm::dvec3 p;
                const double angle = 6.283185307 * random.uniform(), r = random.uniform() * random.uniform();
                if (index % 3 == 0) {
                    p = {10 * r * std::cos(angle), 10 * r * std::sin(angle), 0.002 * random.uniform()};
                } else {
                    const double z = random.uniform();
                    p = 10.0 * glm::dvec3(std::sqrt(1 - z * z) * std::cos(angle),
                                          std::sqrt(1 - z * z) * std::sin(angle), z);
                }
                for (int axis = 0; axis < 3; ++axis)
                    io::store(record + 4 * axis, static_cast<int32_t>(std::lround(p[axis] * 1000)));
                io::store(record + 12, random.next());
            }};
}

Result<BuildReport> build(const io::PointSource& source, const std::filesystem::path& output,
                          uint64_t memory = uint64_t{1} << 30, unsigned threads = 2) {
    BuildOptions options;
    options.inputs = {&source};
    options.output = output;
    options.normals = NormalsMode::none;
    options.memory = memory;
    options.threads = threads;
    return build_cache(options);
}

TEST(Build, KeepsEveryPointExactlyOnce) {
    const TempFolder folder;
    const auto source = hall(200'000);
    const auto report = build(source, folder / "a.luc");
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->points, 200'000u);
    const auto verified = verify_cache(folder / "a.luc", [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    EXPECT_EQ(verified->points, 200'000u);
    EXPECT_GT(verified->nodes, 20u);
    const auto cache = open_cache(folder / "a.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ(test::sorted_records(**cache, 20), test::sorted_records(source, 20));
}

TEST(Build, IsTheSameFileForAnyThreadsBatchesAndMemory) {
    const TempFolder folder;
    auto source = hall(300'000);
    ASSERT_TRUE(build(source, folder / "reference.luc", uint64_t{1} << 30, 1));
    const std::string reference = io::testing::read_bytes(folder / "reference.luc");
    struct Case {
        uint64_t memory;
        unsigned threads;
        size_t batch;
    };
    for (const auto& [memory, threads, batch] :
         {Case{uint64_t{1} << 30, 2, 1000}, Case{uint64_t{1} << 30, 4, 77}, Case{uint64_t{16} << 20, 1, 5000},
          Case{uint64_t{64} << 20, 4, 100'000}}) {
        source.limit_batches(batch);
        const auto name = folder / (std::to_string(memory >> 20) + "-" + std::to_string(threads));
        const auto report = build(source, name, memory, threads);
        ASSERT_TRUE(report) << report.error().line();
        EXPECT_EQ(report->chunks > 1, memory < uint64_t{1} << 30);
        EXPECT_TRUE(io::testing::read_bytes(name) == reference)
            << memory << " bytes, " << threads << " threads, " << report->chunks << " chunks";
    }
}

/// Points at fixed positions, f64.
ComputedSource at_places(uint64_t points, std::function<glm::dvec3(uint64_t)> place) {
    return {io::Schema{}, points,
            [place](uint64_t index, std::byte* record) { io::store(record, place(index)); }};
}

void expect_sound(const io::PointSource& source, const std::filesystem::path& path,
                  uint64_t memory = uint64_t{1} << 30) {
    const auto report = build(source, path, memory);
    ASSERT_TRUE(report) << report.error().line();
    const auto verified = verify_cache(path, [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    const auto cache = open_cache(path);
    ASSERT_TRUE(cache);
    EXPECT_TRUE(test::sorted_records(**cache, 24) == test::sorted_records(source, 24));
}

TEST(Build, TakesOnePointAndTwo) {
    const TempFolder folder;
    expect_sound(at_places(1, [](uint64_t) { return glm::dvec3(1e7, -2, 3); }), folder / "one.luc");
    expect_sound(at_places(2, [](uint64_t i) { return glm::dvec3(static_cast<double>(i), 0, 0); }),
                 folder / "two.luc");
}

TEST(Build, EndsWithMoreDuplicatesOfOnePointThanMemoryHolds) {
    const TempFolder folder;
    // Every third point is elsewhere. The others share one place; they take 5 MB in a build that may use 16
    // MiB.
    const auto source = at_places(300'000, [](uint64_t i) {
        Random random(4, i);
        return i % 3 ? glm::dvec3(0.3) : glm::dvec3(random.uniform(), random.uniform(), 0.3);
    });
    expect_sound(source, folder / "mixed.luc", uint64_t{16} << 20);
    expect_sound(at_places(200'000, [](uint64_t) { return glm::dvec3(5); }), folder / "same.luc",
                 uint64_t{16} << 20);
}

TEST(Build, KeepsNodesBoundedInAVolume) {
    const TempFolder folder;
    const auto source = at_places(600'000, [](uint64_t i) {
        Random random(6, i);
        return glm::dvec3(random.uniform(), random.uniform(), random.uniform());
    });
    expect_sound(source, folder / "volume.luc");
    const auto cache = open_cache(folder / "volume.luc");
    for (const auto& node : (*cache)->nodes()) EXPECT_LE(node.count, 20'000u);
}

TEST(Build, ReachesAStrayPointFarAway) {
    const TempFolder folder;
    const auto source = at_places(100'000, [](uint64_t i) {
        Random random(8, i);
        return i == 777 ? glm::dvec3(1e6, 1e6, -1e6) : glm::dvec3(random.uniform(), random.uniform(), 0);
    });
    expect_sound(source, folder / "stray.luc", uint64_t{16} << 20);
}

TEST(Build, RefusesInputsWithoutPoints) {
    const TempFolder folder;
    const auto report = build(at_places(0, [](uint64_t) { return glm::dvec3(0); }), folder / "none.luc");
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::input_rejected);
    EXPECT_EQ(report.error().line(), "computed: has no points");
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Build, RefusesLessMemoryThanItNeeds) {
    const TempFolder folder;
    const auto report = build(hall(10), folder / "a.luc", uint64_t{15} << 20);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().line(), "--memory: 15.0 MiB is too little; give at least 16.0 MiB");
}

TEST(Build, KeepsIntegersOfInputsThatShareTheirScale) {
    const TempFolder folder;
    const auto a = hall(20'000, 1), b = hall(30'000, 2);
    BuildOptions options{.inputs = {&a, &b}, .output = folder / "two.luc", .normals = NormalsMode::none};
    ASSERT_TRUE(build_cache(options));
    const auto cache = open_cache(folder / "two.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    const auto& schema = (*cache)->header().schema;
    EXPECT_EQ(schema.position, io::PositionType::i32_scaled);
    ASSERT_TRUE(schema.find("scan"));
    auto expected = test::sorted_records(a, 20);
    const auto more = test::sorted_records(b, 20);
    expected.insert(expected.end(), more.begin(), more.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_TRUE(test::sorted_records(**cache, 20) == expected);
}

TEST(Build, UnifiesInputsOfDifferentKindsExactly) {
    const TempFolder folder;
    const auto scaled = hall(1000);
    io::Schema other;
    other.position = io::PositionType::f32;
    other.stride = 12;
    other.add("color", io::ScalarType::u8, 3);
    other.add("intensity", io::ScalarType::f32);
    other.add("area", io::ScalarType::f64);
    const ComputedSource floats(other, 500, [](uint64_t i, std::byte* record) {
        for (int axis = 0; axis < 3; ++axis)
            io::store(record + 4 * axis, 4.0e5f + 0.25f * static_cast<float>(i));
        io::store(record + 12, uint8_t{200});
        io::store(record + 15, 0.5f);
        io::store(record + 19, 1.0 / static_cast<double>(i + 1));
    });
    BuildOptions options{
        .inputs = {&scaled, &floats}, .output = folder / "both.luc", .normals = NormalsMode::none};
    const auto report = build_cache(options);
    ASSERT_TRUE(report) << report.error().line();
    const auto cache = open_cache(folder / "both.luc");
    const auto& schema = (*cache)->header().schema;
    EXPECT_EQ(schema.position, io::PositionType::f64);
    const auto *color = schema.find("color"), *intensity = schema.find("intensity"),
               *area = schema.find("area_in_file"), *scan = schema.find("scan");
    ASSERT_TRUE(color && intensity && area && scan);
    EXPECT_EQ(color->type, io::ScalarType::u16);
    EXPECT_EQ(intensity->type, io::ScalarType::f32);
    size_t from_floats = 0;
    double areas = 0;
    for (uint32_t node = 0; node < (*cache)->nodes().size(); ++node) {
        const auto data = (*cache)->load(node);
        for (size_t i = 0; i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            if (io::load<uint16_t>(record + scan->offset) == 0) continue;
            ++from_floats;
            EXPECT_EQ(io::load<uint16_t>(record + color->offset), 200 * 257);
            EXPECT_EQ(io::load<float>(record + intensity->offset), 0.5f);
            areas += 1 / io::load<double>(record + area->offset);
        }
    }
    EXPECT_EQ(from_floats, 500u);
    EXPECT_NEAR(areas, 500 * 501 / 2.0, 1e-6);
    const auto converted = test::sorted_records(**cache, 24);
    const auto reader = scaled.open();
    io::PointBatch batch;
    ASSERT_TRUE((*reader)->read(batch, 1000));
    for (size_t i = 0; i < batch.count; ++i) {
        const auto p = io::position_of(scaled.schema(), &batch.bytes[i * 20]);
        EXPECT_TRUE(std::binary_search(converted.begin(), converted.end(),
                                       std::string(reinterpret_cast<const char*>(&p), 24)));
    }
}

TEST(Build, RefusesAttributesThatNoTypeCanHold) {
    const TempFolder folder;
    io::Schema a, b;
    a.add("tag", io::ScalarType::u64);
    b.add("tag", io::ScalarType::f32);
    const auto nothing = [](uint64_t, std::byte*) {};
    const ComputedSource first(a, 1, nothing), second(b, 1, nothing);
    const auto report = build_cache({.inputs = {&first, &second}, .output = folder / "no.luc"});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().line(),
              "computed: its attribute 'tag' does not fit that of the other inputs; convert it on its own");
}

/// A source whose reading fails half way, as on a broken network mount.
class TornSource final : public io::PointSource {
 public:
    explicit TornSource(int passes) : passes_(passes), whole_(hall(10'000)) {}
    const io::Schema& schema() const override { return whole_.schema(); }
    const io::ScanInfo& info() const override { return whole_.info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        LUCARNE_ASSIGN(auto reader, whole_.open());
        return std::make_unique<Reader>(std::move(reader), passes_-- == 0);
    }

 private:
    class Reader final : public io::PointReader {
     public:
        Reader(std::unique_ptr<io::PointReader> whole, bool torn) : whole_(std::move(whole)), torn_(torn) {}
        Result<size_t> read(io::PointBatch& batch, size_t) override {
            if (torn_ && ++reads_ == 3) return rejected("torn.las", "cannot be read (Input/output error)");
            return whole_->read(batch, 1000);
        }
        uint64_t dropped() const override { return 0; }

     private:
        std::unique_ptr<io::PointReader> whole_;
        bool torn_;
        int reads_ = 0;
    };
    mutable int passes_;
    ComputedSource whole_;
};

TEST(Build, LeavesNothingBehindWhenAnInputTears) {
    for (const int passes : {0, 1, 2}) {
        const TempFolder folder;
        const auto report = build(TornSource(passes), folder / "a.luc");
        ASSERT_FALSE(report) << passes;
        EXPECT_EQ(report.error().line(), "torn.las: cannot be read (Input/output error)");
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
}

/// Every pass over it gives more (or fewer) points than the previous one, like a file that is being written.
class GrowingSource final : public io::PointSource {
 public:
    explicit GrowingSource(int64_t growth) : first_(hall(20'000)), growth_(growth) {}
    const io::Schema& schema() const override { return first_.schema(); }
    const io::ScanInfo& info() const override { return first_.info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        current_ =
            std::make_unique<ComputedSource>(hall(static_cast<uint64_t>(20'000 + growth_ * passes_++)));
        return current_->open();
    }

 private:
    ComputedSource first_;
    int64_t growth_;
    mutable int passes_ = 0;
    mutable std::unique_ptr<ComputedSource> current_;
};

TEST(Build, NoticesInputsThatChangeWhileTheyAreRead) {
    for (const int64_t growth : {1, -1, 5000, -10'000}) {
        const TempFolder folder;
        const auto report = build(GrowingSource(growth), folder / "a.luc");
        ASSERT_FALSE(report) << growth;
        EXPECT_NE(report.error().line().find("changed while they were read"), std::string::npos);
        EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
}

TEST(Build, NeverTouchesAnOutputThatExists) {
    const TempFolder folder;
    std::ofstream(folder / "a.luc") << "mine";
    const auto report = build(hall(100), folder / "a.luc");
    ASSERT_FALSE(report);
    EXPECT_NE(report.error().line().find("exists already"), std::string::npos);
    EXPECT_EQ(io::testing::read_bytes(folder / "a.luc"), "mine");
}

}  // namespace
}  // namespace lucarne::octree
