// Virtual scans (io/synthetic) with their true normals, as clouds.
#pragma once

#include <string>

#include "io/synthetic/synthetic.h"
#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree::testing {

struct Scan {
    Cloud cloud;
    std::vector<glm::dvec3> stations;
};

inline Scan scan_of(const std::string& scene, uint64_t points, bool even = false) {
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

}  // namespace lucarne::octree::testing
