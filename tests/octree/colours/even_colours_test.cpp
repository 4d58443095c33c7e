#include "octree/colours/even_colours.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "octree/edit/edit.h"
#include "tests/octree/colours/coloured_scans.h"

namespace lucarne::octree {
namespace {

constexpr int kSide = 128;          ///< points along the wall
constexpr float kSpacing = 0.001f;  ///< edges of the root cube

/// A wall of points with their colours, along the Morton curve.
template <class T>
struct Wall {
    using Paint = std::function<std::array<T, 3>(int x, int y)>;

    explicit Wall(io::ScalarType type, const Paint& paint, T full) : white(full) {
        schema.add(std::string(io::names::color), type, 3);
        schema.add(std::string(io::names::normal), io::ScalarType::f32, 3);
        schema.add(std::string(io::names::point_source_id), io::ScalarType::u16);
        schema.add(std::string(io::names::color_change), io::ScalarType::i8, 3);
        struct Point {
            Place place;
            int x, y;
        };
        std::vector<Point> points;
        const auto lattice = [](double place) { return static_cast<uint32_t>(std::ldexp(place, 32)); };
        Random random(7);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const auto at = [&](int i) {
                    return 0.25 + double{kSpacing} * (i + 0.6 * (random.uniform() - 0.5));
                };
                points.push_back({{lattice(at(x)), lattice(at(y)), lattice(0.5)}, x, y});
            }
        std::ranges::sort(points, {}, [](const Point& point) { return point.place.code(); });
        for (const Point& point : points) {
            places.push_back(point.place);
            records.resize(records.size() + schema.stride);
            std::byte* record = &records[records.size() - schema.stride];
            io::store(record + offset(io::names::color), paint(point.x, point.y));
            io::store(record + offset(io::names::normal), std::array<float, 3>{0, 0, 1});
        }
        areas.assign(places.size(), kSpacing * kSpacing);
    }
    uint32_t offset(std::string_view name) const { return schema.find(name)->offset; }
    std::byte* record(size_t i) { return &records[i * schema.stride]; }
    void even() {
        const std::array<double, 1> whites = {static_cast<double>(white)};
        ColourEvening(schema, whites).even(records, places, areas);
    }
    ColourChange change(size_t i) {
        return io::load<ColourChange>(record(i) + offset(io::names::color_change));
    }
    /// The green of a point as it is drawn, from 0 to 1.
    double drawn(size_t i) {
        const auto color = io::load<std::array<T, 3>>(record(i) + offset(io::names::color));
        const glm::dvec3 srgb(color[0], color[1], color[2]);
        return changed_colour(srgb / static_cast<double>(white), change(i)).y;
    }
    /// Paints half of the points, at random, and lets `change` change their records.
    template <class Change>
    void change_half(const std::array<T, 3>& color, const Change& change) {
        Random random(5);
        for (size_t i = 0; i < places.size(); ++i) {
            if (random.uniform() < 0.5) continue;
            io::store(record(i) + offset(io::names::color), color);
            change(record(i));
        }
    }
    size_t changed() {
        size_t sum = 0;
        for (size_t i = 0; i < places.size(); ++i)
            sum += std::ranges::any_of(change(i), [](int8_t step) { return step != 0; });
        return sum;
    }

    io::Schema schema;
    T white;
    std::vector<std::byte> records;
    std::vector<Place> places;
    std::vector<float> areas;
};
using Bytes = std::array<uint8_t, 3>;
using ByteWall = Wall<uint8_t>;

struct Spread {
    double mean = 0, deviation = 0;
};
template <class T>
Spread spread(Wall<T>& wall) {
    double sum = 0, sum2 = 0, count = 0;
    for (size_t i = 0; i < wall.places.size(); ++i) {
        const double value = wall.drawn(i);
        sum += value, sum2 += value * value, ++count;
    }
    return {sum / count, std::sqrt(sum2 / count - sum * sum / count / count)};
}

TEST(EvenColours, PointsOfTwoExposuresGetTheirMean) {
    for (const double part : {0.5, 0.1}) {
        Random random(3);
        const auto paint = [&](int, int) -> Bytes {
            return random.uniform() < part ? Bytes{200, 190, 180} : Bytes{100, 90, 80};
        };
        ByteWall wall(io::ScalarType::u8, paint, 255);
        const Spread before = spread(wall);
        wall.even();
        const Spread after = spread(wall);
        EXPECT_NEAR(after.mean, before.mean, 0.03 * before.mean) << part;
        EXPECT_LT(after.deviation, 0.55 * before.deviation) << part;
    }
}

TEST(EvenColours, SixteenBitsAndFloatsAreEvenedAlike) {
    Random random(3);
    const auto bright = [&] { return random.uniform() < 0.5; };
    Wall<uint16_t> wide(
        io::ScalarType::u16,
        [&](int, int) {
            return std::array<uint16_t, 3>{9, uint16_t(bright() ? 50'000 : 20'000), 9};
        },
        65'535);
    Wall<float> floats(
        io::ScalarType::f32,
        [&](int, int) {
            return std::array<float, 3>{0, bright() ? 0.8f : 0.3f, 0};
        },
        1);
    const double before[] = {spread(wide).deviation, spread(floats).deviation};
    wide.even();
    floats.even();
    EXPECT_LT(spread(wide).deviation, 0.55 * before[0]);
    EXPECT_LT(spread(floats).deviation, 0.55 * before[1]);
}

TEST(EvenColours, TextureStays) {
    const auto grey = [](int level) { return Bytes{uint8_t(level), uint8_t(level), uint8_t(level)}; };
    const ByteWall::Paint textures[] = {
        [&](int, int) { return grey(120); },
        [&](int x, int y) { return grey(x + y); },
        [&](int x, int) { return grey(x < kSide / 2 ? 60 : 200); },
        [&](int x, int) { return grey(x % 40 < 4 ? 60 : 200); },
        [&](int x, int) { return grey(x % 40 < 1 ? 60 : 200); },
        [&](int x, int y) { return grey((x / 8 + y / 8) % 2 ? 60 : 200); },
    };
    for (size_t i = 0; i < std::size(textures); ++i) {
        ByteWall wall(io::ScalarType::u8, textures[i], 255);
        wall.even();
        EXPECT_EQ(wall.changed(), 0u) << "texture " << i;
    }
}

Bytes grey_100(int, int) {
    return {100, 100, 100};
}

TEST(EvenColours, StationsAreNotMixed) {
    // Their exposures are what gains balance (octree/colours/gains.h).
    ByteWall wall(io::ScalarType::u8, grey_100, 255);
    wall.change_half({200, 200, 200}, [&](std::byte* record) {
        io::store(record + wall.offset(io::names::point_source_id), uint16_t{2});
    });
    wall.even();
    EXPECT_EQ(wall.changed(), 0u);
}

TEST(EvenColours, PointsWithoutAColourOrASurfaceTakeNoPart) {
    Random random(3);
    const auto paint = [&](int x, int) -> Bytes {
        if (x < kSide / 2 && random.uniform() < 0.5) return {0, 0, 0};
        return random.uniform() < 0.5 ? Bytes{200, 200, 200} : Bytes{100, 100, 100};
    };
    ByteWall wall(io::ScalarType::u8, paint, 255);
    for (size_t i = 0; i < wall.places.size(); i += 7) wall.areas[i] = 0;
    wall.even();
    for (size_t i = 0; i < wall.places.size(); ++i) {
        if (io::load<Bytes>(wall.record(i) + wall.offset(io::names::color)) == Bytes{0, 0, 0} || i % 7 == 0)
            EXPECT_EQ(wall.change(i), ColourChange{});
        else
            EXPECT_GE(wall.drawn(i), 99.0 / 255);  // no neighbour without a colour darkens it
    }
    EXPECT_GT(wall.changed(), wall.places.size() / 4);
}

TEST(EvenColours, TheTwoFacesOfADoorAreNotMixed) {
    ByteWall wall(io::ScalarType::u8, grey_100, 255);
    wall.change_half({200, 200, 200}, [&](std::byte* record) {
        io::store(record + wall.offset(io::names::normal), std::array<float, 3>{0, 0, -1});
    });
    wall.even();
    EXPECT_EQ(wall.changed(), 0u);
}

TEST(EvenColours, AnyBytesGiveADefinedChange) {
    Random random(11);
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(),
                         -1e30f,
                         3e38f,
                         0,
                         0.5f,
                         1};
    const auto any = [&] {  // one in four is odd
        const auto i = static_cast<size_t>(4 * std::size(odd) * random.uniform());
        return i < std::size(odd) ? odd[i] : static_cast<float>(random.uniform());
    };
    Wall<float> wall(
        io::ScalarType::f32,
        [&](int, int) {
            return std::array<float, 3>{any(), any(), any()};
        },
        1);
    for (size_t i = 0; i < wall.places.size(); ++i) {
        if (random.uniform() < 0.3) wall.areas[i] = std::abs(any());
        if (random.uniform() < 0.1) wall.areas[i] = 1e-42f;
        if (random.uniform() < 0.3)
            io::store(wall.record(i) + wall.offset(io::names::normal),
                      std::array<float, 3>{any(), any(), any()});
        if (random.uniform() < 0.3) wall.places[i] = wall.places[0];
    }
    wall.even();
    for (size_t i = 0; i < wall.places.size(); ++i)
        for (const int8_t step : wall.change(i)) EXPECT_LE(std::abs(int{step}), 2 * kColourChangeSteps);
    EXPECT_GT(wall.changed(), 0u);
}

TEST(EvenColours, SchemasWithoutTheAttributeAreLeftAlone) {
    io::Schema schema;
    schema.add(std::string(io::names::color), io::ScalarType::u8, 3);
    std::vector<std::byte> records(schema.stride);
    const std::vector<std::byte> before = records;
    const Place place{};
    const float area = 1;
    ColourEvening(schema, {}).even(records, {&place, 1}, {&area, 1});
    EXPECT_EQ(records, before);
}

/// Returns the share of a cache's points whose colours are changed.
double share_changed(const NodeSource& cache) {
    const auto* change = cache.header().schema.find(io::names::color_change);
    if (!change) return 0;
    size_t changed = 0, points = 0;
    for (uint32_t node = 0; node < cache.nodes().size(); ++node) {
        const NodeData data = cache.load(node).value();
        for (size_t at = 0; at < data.records.size(); at += cache.header().schema.stride, ++points)
            changed += io::load<ColourChange>(&data.records[at + change->offset]) != ColourChange{};
    }
    return static_cast<double>(changed) / static_cast<double>(points);
}

/// A square of 1 m, with a corner at (x, 0, 0), whose points have two colours at random.
test::ComputedSource mixed(double x) {
    io::Schema schema;
    schema.add("color", io::ScalarType::u8, 3);
    return {schema, 30'000, [=](uint64_t index, std::byte* record) {
                Random random(17, index);
                io::store(record, glm::dvec3(x + random.uniform(), random.uniform(), 0));
                io::store(record + 24, random.uniform() < 0.5 ? Bytes{200, 190, 180} : Bytes{100, 90, 80});
            }};
}

TEST(EvenColours, ConversionsAndUpdatesEvenAndKeepWhatFilesSay) {
    const test::TempFolder folder;
    const auto path = folder / "a.luc";
    const auto scan = mixed(0), far = mixed(5);  // the second one makes the root cube grow
    const auto cache = testing::converted({&scan}, path);
    ASSERT_TRUE(cache);
    EXPECT_GT(share_changed(*cache), 0.5);
    EXPECT_EQ(test::sorted_records(*cache, scan.schema().stride),
              test::sorted_records(scan, scan.schema().stride));
    ASSERT_TRUE(append_to_cache({&far}, {.cache = path}));
    EXPECT_GT(share_changed(**open_cache(path)), 0.5);
    ASSERT_TRUE(delete_from_cache({.box = {}, .scan = uint16_t{0}}, {.cache = path}));
    EXPECT_GT(share_changed(**open_cache(path)), 0.5);
}

TEST(EvenColours, NothingIsAddedWithoutEstimates) {
    const test::TempFolder folder;
    const auto scan = mixed(0);
    const auto cache = testing::converted({&scan}, folder / "a.luc", 2, NormalsMode::none);
    ASSERT_TRUE(cache);
    EXPECT_EQ(cache->header().schema.find(io::names::color_change), nullptr);
}

}  // namespace
}  // namespace lucarne::octree
