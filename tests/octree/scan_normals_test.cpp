// Normals and orientation on virtual scans, whose true normals are known (io/synthetic).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/synthetic/synthetic.h"
#include "tests/octree/normal_clouds.h"

namespace lucarne::octree {
namespace {

using namespace testing;

struct Scan {
    Cloud cloud;
    std::vector<glm::dvec3> stations;
};

Scan scan_of(const std::string& scene, uint64_t points, bool even = false) {
    io::SyntheticOptions options;
    options.scene = scene;
    options.points = points;
    options.normals = true;
    options.even = even;
    Scan scan;
    const auto source = io::synthetic_source(options);
    EXPECT_TRUE(source) << (source ? "" : source.error().line());
    if (!source) return scan;
    const auto& schema = (*source)->schema();
    const auto* normal = schema.find(io::names::normal);
    const auto* station = schema.find(io::names::point_source_id);
    const auto& stations = (*source)->info().stations;
    for (const auto& s : stations) scan.stations.push_back(s.position);
    auto reader = (*source)->open();
    EXPECT_TRUE(reader && normal);
    if (!reader || !normal) return scan;
    io::PointBatch batch;
    for (auto read = (*reader)->read(batch, 65536); read && *read > 0; read = (*reader)->read(batch, 65536))
        for (size_t i = 0; i < batch.count; ++i) {
            const std::byte* record = &batch.bytes[i * schema.stride];
            scan.cloud.points.push_back(io::position_of(schema, record));
            const std::byte* n = record + normal->offset;
            scan.cloud.normals.push_back(
                {io::load<float>(n), io::load<float>(n + 4), io::load<float>(n + 8)});
            int32_t seen = -1;
            if (station)
                for (size_t s = 0; s < stations.size(); ++s)
                    if (stations[s].id == io::scalar_at(station->type, record + station->offset))
                        seen = static_cast<int32_t>(s);
            scan.cloud.stations.push_back(seen);
        }
    return scan;
}

Score print(const std::string& what, const Cloud& cloud, const NormalOptions& options, uint32_t parts) {
    const Score s = score(cloud, estimate(cloud, options, parts));
    std::printf("%-28s %7zu points: mean error %.2f degrees, oriented right %.4f, marked %.4f\n",
                what.c_str(), cloud.points.size(), s.angle, s.oriented, s.marked);
    return s;
}

TEST(ScanNormals, FollowTheTruthWhereStationsAreKnown) {
    const struct {
        const char* scene;
        double angle, oriented;
    } cases[] = {{"nave", 14, 0.98}, {"two-rooms", 4, 0.99}, {"statue", 2.5, 0.99}};
    for (const auto& c : cases) {
        const Scan scan = scan_of(c.scene, 100000);
        ASSERT_FALSE(scan.stations.empty());
        NormalOptions options;
        options.stations = scan.stations;
        const Score s = print(std::string(c.scene) + ", stations", scan.cloud, options, 2);
        EXPECT_LT(s.angle, c.angle) << c.scene;
        EXPECT_GT(s.oriented, c.oriented) << c.scene;
        EXPECT_LT(s.marked, 0.05) << c.scene;
    }
}

TEST(ScanNormals, FollowTheTruthOutsideWithoutStations) {
    Scan scan = scan_of("statue", 100000);
    for (const uint32_t parts : {1u, 3u}) {
        const Score s = print("statue, no stations", scan.cloud, {}, parts);
        EXPECT_GT(s.oriented, 0.95) << parts;
    }
}

TEST(ScanNormals, FollowTheTruthIndoorsWithoutStations) {
    for (const char* scene : {"nave", "two-rooms"}) {
        const Scan scan = scan_of(scene, 100000);
        for (const uint32_t parts : {1u, 3u}) {
            const Score s = print(std::string(scene) + ", no stations", scan.cloud, {}, parts);
            EXPECT_GT(s.oriented, 0.95) << scene << " " << parts;
        }
    }
}

}  // namespace
}  // namespace lucarne::octree
