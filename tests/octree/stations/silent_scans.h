// Virtual scans that do not state their stations, and how good the surface of their caches is.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/synthetic/synthetic.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/normals/normals.h"
#include "octree/tree/attributes.h"
#include "octree/tree/stored_names.h"
#include "tests/octree/test_sources.h"

namespace lucarne::test {

/// A virtual scan with its true normals. Unless it `states` its stations, its points have the station's
/// number as an attribute that has no meaning to a conversion.
class StationScan final : public io::PointSource {
 public:
    static constexpr const char* kTrueStation = "true_station";

    StationScan(const std::string& scene, uint64_t points, bool states, uint32_t count = 0) {
        auto source =
            io::synthetic_source({.scene = scene, .points = points, .stations = count, .normals = true});
        EXPECT_TRUE(source) << (source ? "" : source.error().line());
        source_ = std::move(*source);
        schema_ = source_->schema();
        info_ = source_->info();
        for (const auto& station : info_.stations) stations.push_back(station.position);
        info_.path = scene + (states ? ", stated" : ", silent");
        if (states) return;
        info_.stations.clear();
        for (auto& attribute : schema_.attributes)
            if (attribute.name == io::names::point_source_id) attribute.name = kTrueStation;
    }
    const io::Schema& schema() const override { return schema_; }
    const io::ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override { return source_->open(); }

    std::vector<glm::dvec3> stations;

 private:
    std::unique_ptr<io::PointSource> source_;
    io::Schema schema_;
    io::ScanInfo info_;
};

/// How the normals of a cache compare with the true ones.
struct SurfaceScore {
    uint64_t with_normal = 0, flipped = 0;
    uint64_t strays = 0;  ///< points that are taken for outliers
    double flipped_share() const {
        return static_cast<double>(flipped) / static_cast<double>(std::max<uint64_t>(1, with_normal));
    }
};
/// `scan`: the one whose points count, of a cache with several.
inline SurfaceScore score_of(const octree::NodeSource& cache, uint16_t scan = 0) {
    SurfaceScore score;
    const auto& schema = cache.header().schema;
    const auto* truth = schema.find(octree::kReplacedNormals);
    const auto* found = schema.find(io::names::normal_oct);
    const auto* area = schema.find(io::names::area);
    const auto* of_scan = schema.find(io::names::scan);
    EXPECT_TRUE(truth && found && area);
    if (!truth || !found || !area) return score;
    for (uint32_t node = 0; node < cache.nodes().size(); ++node) {
        const auto data = cache.load(node);
        EXPECT_TRUE(data);
        for (size_t i = 0; data && i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            if (of_scan && io::load<uint16_t>(record + of_scan->offset) != scan) continue;
            const auto right = io::load<glm::vec3>(record + truth->offset);
            const auto normal = octree::decode_normal(io::load<octree::NormalCode>(record + found->offset));
            const bool least =
                io::load<uint16_t>(record + area->offset) == octree::encode_area(octree::kStrayArea, 1);
            score.with_normal += normal.has_value();
            score.flipped += normal && glm::dot(*normal, right) < 0;
            score.strays += !normal && least;
        }
    }
    return score;
}

/// The points of a scan in random order.
inline std::unique_ptr<io::PointSource> shuffled(const io::PointSource& scan) {
    const size_t stride = scan.schema().stride;
    std::vector<std::byte> records;
    auto reader = scan.open();
    io::PointBatch batch;
    while (reader && (*reader)->read(batch, 65536).value_or(0) > 0)
        records.insert(records.end(), batch.bytes.begin(),
                       batch.bytes.begin() + static_cast<ptrdiff_t>(batch.count * stride));
    const size_t count = records.size() / stride;
    std::vector<size_t> order(count);
    for (size_t i = 0; i < count; ++i) {
        const size_t other = Random(11, i).next() % (i + 1);
        order[i] = order[other];
        order[other] = i;
    }
    return std::make_unique<ComputedSource>(
        scan.schema(), count,
        [records = std::move(records), order = std::move(order), stride](uint64_t index, std::byte* record) {
            std::memcpy(record, &records[order[index] * stride], stride);
        });
}

/// Converts scans with estimated normals.
inline octree::BuildReport converted(std::vector<const io::PointSource*> inputs,
                                     const std::filesystem::path& output, unsigned threads = 2,
                                     uint64_t memory = 512 << 20) {
    octree::BuildOptions options;
    options.inputs = std::move(inputs);
    options.output = output;
    options.normals = octree::NormalsMode::estimate;
    options.threads = threads;
    options.memory = memory;
    const auto report = octree::build_cache(options);
    EXPECT_TRUE(report) << (report ? "" : report.error().line());
    return report ? *report : octree::BuildReport{};
}

}  // namespace lucarne::test
