#include "octree/colours/colour_survey.h"

#include <fstream>
#include <limits>

#include "octree/edit/edit.h"
#include "tests/octree/colours/coloured_scans.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;
using namespace testing;

io::SyntheticOptions two_stations(uint64_t points = 100'000) {
    io::SyntheticOptions options;
    options.points = points;
    options.stations = 2;
    return options;
}
Recoloured::Change exposed(const glm::dvec3& second) {
    return [second](const glm::dvec3& colour, uint32_t station, const std::byte*) {
        return station == 2 ? colour * second : colour * 0.5;
    };
}
/// The gain of one entry divided by that of another, by channel.
glm::dvec3 ratio(const std::vector<StationColour>& colours, size_t a, size_t b) {
    return colours[a].gain / colours[b].gain;
}
void expect_near(const glm::dvec3& a, const glm::dvec3& b, double share) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c] / b[c], 1, share) << "channel " << c;
}
std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ColourSurvey, FindsTheGainsOfTwoStationsOfAVirtualScan) {
    const TempFolder folder;
    const Recoloured scan(two_stations(), exposed({0.9, 0.7, 0.35}));
    const auto cache = converted({&scan}, folder / "a.luc");
    ASSERT_TRUE(cache);
    const auto& colours = cache->header().station_colours;
    ASSERT_EQ(colours.size(), 2u);
    EXPECT_EQ(colours[0].station, 1u);
    EXPECT_EQ(colours[1].station, 2u);
    expect_near(ratio(colours, 0, 1), glm::dvec3(0.9, 0.7, 0.35) / 0.5, 0.02);
    expect_near(colours[0].gain * colours[1].gain, glm::dvec3(1), 0.001);
    EXPECT_FALSE(colours[0].unphotographed);
}

TEST(ColourSurvey, WithoutNormalsToo) {
    const TempFolder folder;
    const Recoloured scan(two_stations(), exposed({0.9, 0.7, 0.35}));
    const auto cache = converted({&scan}, folder / "a.luc", 2, NormalsMode::none);
    ASSERT_TRUE(cache);
    ASSERT_EQ(cache->header().station_colours.size(), 2u);
    expect_near(ratio(cache->header().station_colours, 0, 1), glm::dvec3(0.9, 0.7, 0.35) / 0.5, 0.02);
}

TEST(ColourSurvey, EqualStationsGetGainsOfAboutOne) {
    const TempFolder folder;
    const Recoloured scan(two_stations(), exposed(glm::dvec3(0.5)));
    const auto cache = converted({&scan}, folder / "a.luc");
    ASSERT_TRUE(cache);
    for (const auto& colour : cache->header().station_colours) expect_near(colour.gain, glm::dvec3(1), 0.01);
}

TEST(ColourSurvey, GainsPassAlongAChainOfScans) {
    const TempFolder folder;
    const std::array<glm::dvec3, 3> gains{glm::dvec3(1), glm::dvec3(2, 1.8, 1.5), glm::dvec3(0.5, 0.6, 0.8)};
    const auto a = strip(0, 2, gains[0]), b = strip(1, 4, gains[1]), c = strip(3, 5, gains[2]);
    const auto cache = converted({&a, &b, &c}, folder / "a.luc");
    ASSERT_TRUE(cache);
    const auto& colours = cache->header().station_colours;
    ASSERT_EQ(colours.size(), 3u);
    for (uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(colours[i].scan, i);
        EXPECT_FALSE(colours[i].station);
    }
    expect_near(ratio(colours, 0, 1), gains[1], 0.02);
    expect_near(ratio(colours, 0, 2), gains[2], 0.02);
    expect_near(colours[0].gain * colours[1].gain * colours[2].gain, glm::dvec3(1), 0.001);
}

TEST(ColourSurvey, ScansThatDoNotOverlapHaveNoGains) {
    const TempFolder folder;
    const auto a = strip(0, 1, glm::dvec3(1)), b = strip(2, 3, glm::dvec3(3));
    const auto cache = converted({&a, &b}, folder / "a.luc");
    ASSERT_TRUE(cache);
    EXPECT_TRUE(cache->header().station_colours.empty());
}

TEST(ColourSurvey, TheTwoSidesOfAThinWallAreNotCompared) {
    const TempFolder folder;
    const auto side = [](float up, double paint) {
        io::Schema schema;
        schema.add("normal", io::ScalarType::f32, 3);
        schema.add("color", io::ScalarType::u8, 3);
        return ComputedSource(schema, 30'000, [=](uint64_t index, std::byte* record) {
            Random random(7, index);
            const double x = random.uniform();
            io::store(record, glm::dvec3(x, random.uniform(), up * 0.001));
            io::store(record + 24, glm::vec3(0, 0, up));
            io::store(record + 36, code(glm::dvec3(paint)));
        });
    };
    const auto front = side(1, 0.1), back = side(-1, 0.6);
    const auto cache = converted({&front, &back}, folder / "a.luc");
    ASSERT_TRUE(cache);
    EXPECT_TRUE(cache->header().station_colours.empty());
}

TEST(ColourSurvey, ScansOfDifferentColourWidthsAreComparedInLight) {
    const TempFolder folder;
    const auto narrow = strip(0, 1, glm::dvec3(1));
    io::Schema schema;
    schema.add("color", io::ScalarType::u16, 3);
    ComputedSource wide(schema, 30'000, [](uint64_t index, std::byte* record) {
        Random random(77, index);
        const double x = random.uniform(), y = random.uniform();
        io::store(record, glm::dvec3(x, y, 0));
        const double paint = 2 * 0.1 * std::exp2(std::sin(40 * x) + std::cos(50 * y));
        const auto value = static_cast<uint16_t>(std::lround(65535 * to_srgb(paint)));
        for (size_t c = 0; c < 3; ++c) io::store(record + 24 + 2 * c, value);
    });
    wide.info().color_bits = 16;
    const auto cache = converted({&narrow, &wide}, folder / "a.luc");
    ASSERT_TRUE(cache);
    ASSERT_EQ(cache->header().station_colours.size(), 2u);
    expect_near(ratio(cache->header().station_colours, 0, 1), glm::dvec3(2), 0.02);
}

TEST(ColourSurvey, HostileColoursAreNoStations) {
    const TempFolder folder;
    io::Schema schema;
    schema.add("color", io::ScalarType::f32, 3);
    schema.add("point_source_id", io::ScalarType::u16);
    const auto computed = [&](uint64_t points, const std::function<float(uint64_t)>& value, bool one_place) {
        ComputedSource scan(schema, points, [=](uint64_t index, std::byte* record) {
            Random random(3, index);
            io::store(record, one_place ? glm::dvec3(1, 2, 3)
                                        : glm::dvec3(random.uniform(), random.uniform(), random.uniform()));
            for (size_t c = 0; c < 3; ++c) io::store(record + 24 + 4 * c, value(index + c));
            io::store(record + 36, static_cast<uint16_t>(index));
        });
        scan.info().color_bits = 0;
        return scan;
    };
    const std::vector<std::function<float(uint64_t)>> values{
        [](uint64_t) { return 0.0f; },
        [](uint64_t i) { return i % 2 ? std::numeric_limits<float>::quiet_NaN() : 0.4f; },
        [](uint64_t) { return std::numeric_limits<float>::infinity(); },
        [](uint64_t i) { return i % 3 ? -1e30f : 1e30f; },
        [](uint64_t i) { return static_cast<float>(i % 100) / 100; }};
    int number = 0;
    for (const auto& value : values)
        for (const uint64_t points : {uint64_t{1}, uint64_t{20'000}})
            for (const bool one_place : {false, true}) {
                const auto scan = computed(points, value, one_place);
                const auto cache = converted({&scan}, folder / ("a" + std::to_string(number++) + ".luc"), 2,
                                             NormalsMode::none);
                ASSERT_TRUE(cache);
                EXPECT_TRUE(cache->header().station_colours.empty()) << number;
            }
}

TEST(ColourSurvey, TheSameBytesForAnyNumberOfThreads) {
    const TempFolder folder;
    const Recoloured scan(two_stations(150'000), exposed({0.9, 0.7, 0.35}));
    ASSERT_TRUE(converted({&scan}, folder / "one.luc", 1));
    ASSERT_TRUE(converted({&scan}, folder / "many.luc", 5));
    EXPECT_EQ(bytes_of(folder / "one.luc"), bytes_of(folder / "many.luc"));
}

TEST(ColourSurvey, PointsKeepTheirColours) {
    const TempFolder folder;
    const Recoloured scan(
        two_stations(), [](const glm::dvec3& colour, uint32_t station, const std::byte* record) {
            return io::load<uint8_t>(record) % 8 == 0 ? glm::dvec3(0) : colour * (station == 2 ? 0.9 : 0.5);
        });
    const auto cache = converted({&scan}, folder / "a.luc");
    ASSERT_TRUE(cache);
    ASSERT_FALSE(cache->header().station_colours.empty());
    EXPECT_EQ(test::sorted_records(*cache, scan.schema().stride),
              test::sorted_records(scan, scan.schema().stride));
}

TEST(ColourSurvey, AppendingComparesAllScansAndDeletingKeepsTheGains) {
    const TempFolder folder;
    const auto a = strip(0, 2, glm::dvec3(1)), b = strip(1, 4, glm::dvec3(2)),
               c = strip(3, 5, glm::dvec3(0.5));
    const auto path = folder / "a.luc";
    ASSERT_TRUE(converted({&a, &b}, path));
    const EditOptions options{.cache = path};
    ASSERT_TRUE(append_to_cache({&c}, options));
    const auto appended = open_cache(path);
    ASSERT_TRUE(appended);
    const auto colours = (*appended)->header().station_colours;
    ASSERT_EQ(colours.size(), 3u);
    expect_near(ratio(colours, 0, 1), glm::dvec3(2), 0.02);
    expect_near(ratio(colours, 0, 2), glm::dvec3(0.5), 0.02);
    ASSERT_TRUE(delete_from_cache({.box = {}, .scan = uint16_t{1}}, options));
    const auto deleted = open_cache(path);
    ASSERT_TRUE(deleted);
    EXPECT_EQ((*deleted)->header().station_colours, colours);
    ASSERT_TRUE(compact_cache(path, {}));
    const auto compacted = open_cache(path);
    ASSERT_TRUE(compacted);
    EXPECT_EQ((*compacted)->header().station_colours, colours);
}

/// A plane whose grey levels are `level(random number, place)`, of 255.
template <class Level>
ComputedSource painted(const Level& level) {
    io::Schema schema;
    schema.add("color", io::ScalarType::u8, 3);
    return {schema, 40'000, [level](uint64_t index, std::byte* record) {
                Random random(5, index);
                const double x = random.uniform(), y = random.uniform();
                io::store(record, glm::dvec3(x, y, 0));
                const auto value = static_cast<uint8_t>(level(random.uniform(), x));
                io::store(record + 24, std::array<uint8_t, 3>{value, value, value});
            }};
}
std::optional<glm::dvec3> unphotographed(const io::PointSource& scan) {
    const TempFolder folder;
    const auto cache = converted({&scan}, folder / "a.luc", 2, NormalsMode::none);
    if (!cache || cache->header().station_colours.empty()) return std::nullopt;
    return cache->header().station_colours[0].unphotographed;
}

TEST(ColourSurvey, BlackApartFromTheOtherColoursIsNoColour) {
    const auto mean =
        unphotographed(painted([](double u, double x) { return x < 0.1 ? 0.0 : 40 + 160 * u; }));
    ASSERT_TRUE(mean);
    EXPECT_NEAR(mean->x, 0.22, 0.02) << "of the points that have colours";
}

TEST(ColourSurvey, BlackThatOtherColoursReachIsAColour) {
    // An underexposed picture, cut off at 0; a black wall; a drawing in black and white; nothing but black.
    EXPECT_FALSE(unphotographed(painted([](double u, double) { return std::max(0.0, 200 * u - 30); })));
    EXPECT_FALSE(unphotographed(
        painted([](double u, double x) { return x < 0.3 ? std::max(0.0, 6 * u - 1) : 40 + 160 * u; })));
    EXPECT_FALSE(unphotographed(painted([](double u, double) { return u < 0.3 ? 0.0 : 255.0; })));
    EXPECT_FALSE(unphotographed(painted([](double, double) { return 0.0; })));
}

TEST(SolveGains, StationsWithoutEnoughPatchesGetNone) {
    std::vector<PatchRatio> few(23, {0, 1, {1024, 1024, 1024}});
    EXPECT_EQ(solve_gains(few, 3)[0], (std::array<double, 3>{}));
    few.push_back(few[0]);
    const auto gains = solve_gains(few, 3);
    EXPECT_NEAR(gains[0][0], -0.5, 0.001);
    EXPECT_NEAR(gains[1][0], 0.5, 0.001);
    EXPECT_EQ(gains[2], (std::array<double, 3>{}));
}

TEST(SolveGains, OutliersDoNotMatter) {
    std::vector<PatchRatio> ratios(1000, {0, 1, {512, 512, 512}});
    for (size_t i = 0; i < 400; ++i) ratios[i].ratio = {8000, -8000, 6000};
    const auto gains = solve_gains(ratios, 2);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(gains[1][c] - gains[0][c], 0.5, 0.01);
}

TEST(SolveGains, ALongChainDoesNotDriftAway) {
    constexpr size_t kStations = 600;
    std::vector<PatchRatio> ratios;
    for (uint16_t i = 0; i + 1u < kStations; ++i)  // each seems 2 % brighter than the one before
        ratios.insert(ratios.end(), 30, {i, static_cast<uint16_t>(i + 1), {-29, -29, -29}});
    const auto gains = solve_gains(ratios, kStations);
    double sum = 0, most = 0;
    for (const auto& gain : gains) sum += gain[0], most = std::max(most, std::abs(gain[0]));
    EXPECT_NEAR(sum, 0, 1e-6);
    EXPECT_LT(most, 2.5) << "8.5 stops without the prior";
    EXPECT_GT(most, 0.5);
}

}  // namespace
}  // namespace lucarne::octree
