// A catalogue of tiles that exist as headers only, and what a conversion plans from it before it reads
// points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "octree/cache/metadata.h"
#include "octree/cluster/only_rank.h"
#include "octree/convert/build_inputs.h"
#include "octree/convert/chunks/chunk_plan.h"
#include "octree/convert/identity.h"
#include "octree/convert/nodes/subtree.h"
#include "octree/convert/together.h"

namespace lucarne::test {

/// The header of a tile of a survey. Its points cannot be read.
class HeaderOnly final : public io::PointSource {
 public:
    HeaderOnly(const io::Schema& schema, io::ScanInfo info) : schema_(schema), info_(std::move(info)) {}
    const io::Schema& schema() const override { return schema_; }
    const io::ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        return failed(info_.path, "has only a header");
    }

 private:
    io::Schema schema_;  ///< each tile has its own, as those of files
    io::ScanInfo info_;
};

struct Catalogue {
    std::vector<std::unique_ptr<HeaderOnly>> tiles;
    uint64_t points = 0;

    /// Makes square tiles of 1 km, row by row, over hills.
    Catalogue(size_t count, uint64_t points_each) : points(count * points_each) {
        io::Schema schema;
        schema.position = io::PositionType::i32_scaled;
        schema.scale = glm::dvec3(0.01);
        schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
        for (const char* name : {"intensity", "point_source_id"}) schema.add(name, io::ScalarType::u16);
        for (const char* name : {"classification", "return_number", "number_of_returns"})
            schema.add(name, io::ScalarType::u8);
        schema.add("gps_time", io::ScalarType::f64);
        const auto row = static_cast<size_t>(std::ceil(std::sqrt(count)));
        for (size_t i = 0; i < count; ++i) {
            io::ScanInfo info;
            const double x = 1000.0 * static_cast<double>(i % row), y = 1000.0 * static_cast<double>(i / row);
            const double z = 300 * std::sin(1e-5 * x) * std::cos(2e-5 * y);
            info.path = fmt::format("/survey/tiles/tile_{:06}.laz", i);
            info.format = "LAS 1.4, point format 6, LAZ";
            info.declared_points = points_each;
            info.file_bytes = points_each * 5;
            info.modified = 1'700'000'000'000'000'000 + static_cast<int64_t>(i);
            info.unit_stated = true;
            info.coordinate_system = "ETRS89 / UTM zone 33N";
            info.epsg = 25833;
            info.stated_box = std::array{glm::dvec3(x, y, z), glm::dvec3(x + 999.99, y + 999.99, z + 80)};
            tiles.push_back(std::make_unique<HeaderOnly>(schema, std::move(info)));
        }
    }
};

struct Planned {
    size_t coarse_chunks = 0, chunks = 0;
    uint64_t points = 0, most_points_of_rank = 0, metadata_bytes = 0;
};

/// Does what every rank does before it sends points: joins the headers, compares them, counts in the grid
/// (the points of a tile at 64 places), plans the chunks, splits those that are too large, and divides both
/// tiles and chunks among the ranks; and makes the metadata of the cache.
inline Result<Planned> plan(const Catalogue& catalogue, size_t ranks, uint64_t memory_bytes) {
    octree::BuildOptions options;
    options.memory = memory_bytes;
    for (const auto& tile : catalogue.tiles) options.inputs.push_back(tile.get());
    LUCARNE_ASSIGN(const octree::Unifier inputs, octree::Unifier::create(options.inputs));
    LUCARNE_TRY(octree::check_units(inputs));
    octree::warn_of_differences(inputs);
    octree::OnlyRank alone;
    LUCARNE_TRY(octree::check_ranks(alone, options));
    LUCARNE_ASSIGN(const std::string identity, octree::build_identity(options, {}, alone));
    const octree::NodeLimits limits(inputs.schema().stride);
    LUCARNE_ASSIGN(const auto memory,
                   octree::MemoryPlan::create(memory_bytes, {inputs.schema().stride, limits.leaf, true, 1}));
    octree::ScanFacts facts;
    facts.min = glm::dvec3(1e300);
    facts.max = -facts.min;
    facts.points = catalogue.points;
    for (const auto& tile : catalogue.tiles) {
        facts.min = glm::min(facts.min, (*tile->info().stated_box)[0]);
        facts.max = glm::max(facts.max, (*tile->info().stated_box)[1]);
        facts.inputs.push_back({.points = tile->info().declared_points});
    }
    LUCARNE_ASSIGN(facts.root, octree::root_cube(facts.min, facts.max));
    Planned planned;
    std::vector<octree::Chunk> chunks;
    {
        octree::CountGrid grid({}, facts.points, memory.grid_bytes);
        for (const auto& tile : catalogue.tiles) {
            const auto& box = *tile->info().stated_box;
            const uint64_t points = tile->info().declared_points;
            for (uint64_t i = 0; i < 64; ++i) {
                const glm::dvec3 share((static_cast<double>(i % 8) + .5) / 8,
                                       (static_cast<double>(i / 8) + .5) / 8, .5);
                grid.count(facts.root.place(box[0] + share * (box[1] - box[0])),
                           points * (i + 1) / 64 - points * i / 64);
            }
        }
        const size_t most = memory.buffer_bytes / (8 << 10);
        for (const octree::Chunk& coarse : grid.plan(memory.chunk_points, most)) {
            ++planned.coarse_chunks;
            // Ranks split these by counting their points; terrain fills four of eight children.
            const uint64_t parts = (coarse.count + memory.chunk_points - 1) / memory.chunk_points;
            for (uint64_t i = 0; i < parts; ++i) {
                octree::Chunk part = coarse;
                part.count = coarse.count * (i + 1) / parts - coarse.count * i / parts;
                chunks.push_back(part);
            }
        }
    }
    planned.chunks = chunks.size();
    std::vector<uint64_t> weights;
    for (const octree::Chunk& chunk : chunks) weights.push_back(chunk.count);
    const auto first = octree::divide(weights, ranks);
    for (size_t rank = 0; rank < ranks; ++rank) {
        uint64_t points = 0;
        for (size_t i = first[rank]; i < first[rank + 1]; ++i) points += weights[i];
        planned.points += points;
        planned.most_points_of_rank = std::max(planned.most_points_of_rank, points);
    }
    planned.metadata_bytes = octree::metadata_text(octree::header_of(inputs, facts, inputs.schema())).size();
    return planned;
}

}  // namespace lucarne::test
