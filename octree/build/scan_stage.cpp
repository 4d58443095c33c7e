#include "octree/build/scan_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "octree/build/record_bytes.h"

namespace lucarne::octree {
namespace {

/// Hands the points of one input to `visit`; returns how many the reader dropped.
Result<uint64_t> read_input(const Unifier& inputs, size_t input, uint64_t batch_bytes, const Visit& visit) {
    LUCARNE_ASSIGN(const auto reader, inputs.source(input).open());
    const size_t most = std::clamp<size_t>(batch_bytes / inputs.schema().stride, 1, 1 << 16);
    io::PointBatch batch;
    std::vector<std::byte> storage;
    for (;;) {
        LUCARNE_ASSIGN(const size_t count, reader->read(batch, most));
        if (count == 0) return reader->dropped();
        LUCARNE_TRY(visit(inputs.convert(input, batch, storage)));
    }
}

}  // namespace

Result<Cube> root_cube(const glm::dvec3& min, const glm::dvec3& max) {
    const glm::dvec3 extent = max - min;
    double size = std::max({extent.x, extent.y, extent.z});
    if (!(size < 1e300))
        return rejected("points", "their coordinates span more than 1e300 units", "remove the stray ones");
    if (size <= 0) size = 1;  // one place only
    // A hair wider, so that the farthest point is inside and not on the border.
    return Cube{min, size * (1 + 1e-9)};
}

std::vector<std::byte> ScanFacts::save() const {
    ByteWriter writer;
    writer.put(*this);
    return writer.take();
}
Result<ScanFacts> ScanFacts::restore(std::span<const std::byte> record) {
    ByteReader reader(record);
    const auto facts = reader.get<ScanFacts>();
    if (!reader.sound()) return failed("scan", "was not written down whole");
    return facts;
}

Pass pass_over_inputs(const Unifier& inputs, uint64_t batch_bytes) {
    return [&inputs, batch_bytes](const Visit& visit) -> Result<void> {
        for (size_t input = 0; input < inputs.inputs(); ++input)
            LUCARNE_TRY(read_input(inputs, input, batch_bytes, visit));
        return {};
    };
}

Result<ScanFacts> scan_inputs(const Unifier& inputs, uint64_t batch_bytes) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ScanFacts facts{.min = glm::dvec3(kInfinity), .max = glm::dvec3(-kInfinity)};
    const auto& schema = inputs.schema();
    for (size_t input = 0; input < inputs.inputs(); ++input) {
        LUCARNE_ASSIGN(
            const uint64_t dropped,
            read_input(inputs, input, batch_bytes, [&](std::span<const std::byte> records) -> Result<void> {
                for (size_t at = 0; at < records.size(); at += schema.stride) {
                    const auto p = io::position_of(schema, &records[at]);
                    facts.min = glm::min(facts.min, p);
                    facts.max = glm::max(facts.max, p);
                }
                facts.points += records.size() / schema.stride;
                return {};
            }));
        facts.dropped += dropped;
    }
    if (facts.points == 0) return rejected(inputs.source(0).info().path, "has no points");
    LUCARNE_ASSIGN(facts.root, root_cube(facts.min, facts.max));
    return facts;
}

}  // namespace lucarne::octree
