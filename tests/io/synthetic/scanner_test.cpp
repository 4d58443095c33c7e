#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/core/parallel.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"

namespace lucarne::io {
namespace {

using glm::dvec3;
using testing::HasSubstr;

SyntheticOptions scan(const std::string& scene, uint64_t points) {
    SyntheticOptions options;
    options.scene = scene;
    options.points = points;
    return options;
}

struct ScannedPoint {
    dvec3 position, normal, color;
    double intensity;
    size_t station;
};

std::vector<ScannedPoint> read_points(const SyntheticOptions& options) {
    const auto source = synthetic_source(options).value();
    const auto reader = source->open().value();
    const Schema& schema = source->schema();
    const auto* color = schema.find(names::color);
    const auto* intensity = schema.find(names::intensity);
    const auto* station = schema.find(names::point_source_id);
    const auto* normal = schema.find(names::normal);
    std::vector<ScannedPoint> points;
    for (PointBatch batch; reader->read(batch, 10'000).value() > 0;)
        for (size_t i = 0; i < batch.count; ++i) {
            const std::byte* at = batch.bytes.data() + i * schema.stride;
            ScannedPoint& point = points.emplace_back();
            point.position = position_of(schema, at);
            point.intensity = load<uint16_t>(at + intensity->offset);
            point.station = load<uint16_t>(at + station->offset);
            for (int k = 0; k < 3; ++k) {
                point.color[k] = load<uint8_t>(at + color->offset + k);
                if (normal) point.normal[k] = load<float>(at + normal->offset + 4 * k);
            }
        }
    return points;
}

std::vector<std::byte> read_bytes(const PointSource& source, size_t batch_points) {
    std::vector<std::byte> all;
    const auto reader = source.open().value();
    for (PointBatch batch; reader->read(batch, batch_points).value() > 0;)
        all.insert(all.end(), batch.bytes.begin(), batch.bytes.end());
    return all;
}

TEST(SyntheticScan, BytesDependNeitherOnThreadsNorOnBatches) {
    const auto options = scan("nave", 60'000);
    const auto source = synthetic_source(options).value();
    const auto expected = read_bytes(*source, 1'000'000);
    EXPECT_EQ(read_bytes(*source, 9999), expected) << "opened again";
    for (const unsigned threads : {1u, 2u, 4u}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(read_bytes(*synthetic_source(options).value(), 1013), expected) << threads << " threads";
    }
    auto other = options;
    other.seed = 2;
    EXPECT_NE(read_bytes(*synthetic_source(other).value(), 1'000'000), expected);
}

TEST(SyntheticScan, ReturnsAboutAsManyPointsAsAskedFor) {
    for (const auto& scene : synthetic_scenes())
        for (const uint64_t wanted : {20'000u, 200'000u}) {
            const auto got = static_cast<double>(read_points(scan(scene.name, wanted)).size());
            EXPECT_NEAR(got / static_cast<double>(wanted), 1, .05) << scene.name;
        }
}

TEST(SyntheticScan, EachPointLiesOnTheBeamOfItsStationWithinTheNoise) {
    for (const auto& scene : synthetic_scenes()) {
        auto options = scan(scene.name, 40'000);
        options.noise = .003;
        options.normals = true;
        const auto source = synthetic_source(options).value();
        const auto geometry = SceneGeometry::create(scene.name).value();
        const auto& stations = source->info().stations;
        ASSERT_EQ(stations.size(), geometry->model().stations.size());
        double squares = 0, count = 0, far = 0, backwards = 0;
        for (const auto& point : read_points(options)) {
            ASSERT_GE(point.station, 1u);
            ASSERT_LE(point.station, stations.size());
            EXPECT_EQ(stations[point.station - 1].id, point.station);
            const dvec3 from = stations[point.station - 1].position;
            const double range = glm::length(point.position - from);
            const auto hit = geometry->cast(from, (point.position - from) / range);
            const double error = hit ? range - hit->distance : 1;
            // Rounding to 0.1 mm changes the beam's direction: on slanted surfaces and at edges the range
            // changes more.
            if (std::abs(error) > 6 * options.noise)
                far += 1;
            else
                squares += error * error, count += 1;
            backwards += dot(point.normal, from - point.position) < 0 ? 1 : 0;
        }
        EXPECT_NEAR(std::sqrt(squares / count), options.noise, .1 * options.noise) << scene.name;
        EXPECT_LT(far / count, .02) << scene.name;
        EXPECT_LT(backwards, 5) << scene.name << ": normals look at the scanner, but for mixed pixels";
    }
}

TEST(SyntheticScan, MixedPixelsExistAndOnlyAtEdges) {
    auto options = scan("cornell", 400'000);
    options.noise = 0;
    const auto geometry = SceneGeometry::create("cornell").value();
    const auto stations = synthetic_source(options).value()->info().stations;
    size_t mixed = 0, points = 0;
    for (const auto& point : read_points(options)) {
        ++points;
        if (geometry->closest(point.position, .005)) continue;
        ++mixed;
        // Around the beam of a mixed pixel, within its width, there must be surfaces at clearly different
        // ranges.
        const dvec3 from = stations[point.station - 1].position;
        const double range = glm::length(point.position - from);
        const dvec3 beam = (point.position - from) / range;
        const dvec3 side = glm::normalize(cross(beam, dvec3(.1, .2, 1))), up = cross(side, beam);
        double nearest = 1e9, farthest = 0;
        for (int i = 0; i < 400; ++i) {
            // 3 mm and 0.15 mrad wide; the centre of the beam may have hit nearer than the point lies.
            const double widest = 1.5 * (.003 / range + .00015);
            const double radius = widest * std::sqrt((i + .5) / 400), angle = 2.39996 * i;
            const auto hit = geometry->cast(from, glm::normalize(beam + side * (radius * std::cos(angle)) +
                                                                 up * (radius * std::sin(angle))));
            if (!hit) continue;
            nearest = std::min(nearest, hit->distance);
            farthest = std::max(farthest, hit->distance);
        }
        EXPECT_LT(nearest, range);
        EXPECT_GT(farthest, range);
        EXPECT_GT(farthest - nearest, .02);
    }
    EXPECT_GT(mixed, 20u);
    EXPECT_LT(mixed, points / 100) << "a small share";
}

TEST(SyntheticScan, DensityFallsWithTheDistance) {
    // From the middle of the furnace's side walls to their corners the range grows, and so does the slant.
    auto options = scan("furnace", 300'000);
    options.stations = 1;
    double near = 0, far = 0;
    for (const auto& point : read_points(options)) {
        if (std::abs(point.position.x) < .99) continue;
        const double y = std::abs(point.position.y), z = std::abs(point.position.z);
        near += y < .4 && z < .4 ? 1 : 0;
        far += y > .6 && z > .6 ? 1 : 0;
    }
    EXPECT_GT(near, 2 * far);  // for the same area
    EXPECT_GT(far, 0);
}

TEST(SyntheticScan, ColourAndIntensityFollowFromTheAlbedo) {
    double red = 0, green = 0;
    for (const auto& point : read_points(scan("cornell", 50'000))) {
        EXPECT_GT(point.intensity, 0);
        if (point.position.x < .01 && point.position.z > .1) red += point.color.x > 2 * point.color.y ? 1 : 0;
        if (point.position.x > 5.49 && point.position.z > .1)
            green += point.color.y > 1.5 * point.color.x ? 1 : 0;
    }
    EXPECT_GT(red, 1000);
    EXPECT_GT(green, 1000);
    // The sRGB code of linear .5, in both directions.
    for (const auto& point : read_points(scan("furnace", 1000))) EXPECT_EQ(point.color, dvec3(188));
}

TEST(SyntheticScan, MoreStationsStandWhereThereIsRoom) {
    auto options = scan("nave", 40'000);
    options.stations = 20;
    const auto source = synthetic_source(options).value();
    const auto geometry = SceneGeometry::create("nave").value();
    ASSERT_EQ(source->info().stations.size(), 20u);
    for (const auto& station : source->info().stations)
        EXPECT_FALSE(geometry->closest(station.position, .25)) << station.id;
    std::map<size_t, size_t> counts;
    for (const auto& point : read_points(options)) ++counts[point.station];
    EXPECT_EQ(counts.size(), 20u);
    for (const auto& [station, count] : counts) EXPECT_NEAR(static_cast<double>(count), 2000, 400) << station;
    options.stations = 1;
    EXPECT_EQ(synthetic_source(options).value()->info().stations.size(), 1u);
}

TEST(SyntheticScan, ImpossibleOptionsAreRefusedByName) {
    const auto message = [](auto change) {
        SyntheticOptions options;
        change(options);
        const auto source = synthetic_source(options);
        EXPECT_FALSE(source);
        if (source) return std::string();
        EXPECT_EQ(source.error().kind, ErrorKind::arguments);
        return source.error().line();
    };
    EXPECT_THAT(message([](auto& o) { o.scene = "moon"; }),
                HasSubstr("cornell, furnace, nave, two-rooms, house, statue, ring, paraboloid"));
    EXPECT_THAT(message([](auto& o) { o.points = 0; }), HasSubstr("--points"));
    EXPECT_THAT(message([](auto& o) { o.noise = -1; }), HasSubstr("--noise"));
    EXPECT_THAT(message([](auto& o) { o.noise = NAN; }), HasSubstr("--noise"));
    EXPECT_THAT(message([](auto& o) { o.stations = 1001; }), HasSubstr("--stations"));
    EXPECT_THAT(message([](auto& o) { o.even = true, o.stations = 2; }), HasSubstr("--stations"));
}

}  // namespace
}  // namespace lucarne::io
