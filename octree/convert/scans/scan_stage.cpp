#include "octree/convert/scans/scan_stage.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <glm/common.hpp>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/formats/common/color_depth.h"
#include "io/formats/common/divisible.h"
#include "octree/convert/chunks/record_bytes.h"
#include "octree/convert/scans/early_count.h"
#include "octree/stations/find_stations.h"
#include "octree/tree/point_normals.h"

namespace lucarne::octree {
namespace {

/// The contents of an input that are not among the points passed to `visit`.
struct LeftOut {
    uint64_t dropped = 0;
    io::Losses losses;
};
/// Starts a pass over the points of an input that are in the range.
Result<std::unique_ptr<io::PointReader>> open_input(const Unifier& inputs, size_t input,
                                                    const InputRange& range) {
    const io::PointSource& source = inputs.source(input);
    if (range.whole(input)) return source.open();
    const auto* divisible = dynamic_cast<const io::DivisibleSource*>(&source);
    if (!divisible) return failed(source.info().path, "cannot be read in parts");
    return divisible->open_part(range.begin_in(input),
                                std::min(range.end_in(input), source.info().declared_points));
}

Result<LeftOut> read_input(const Unifier& inputs, size_t input, const InputRange& range, uint64_t batch_bytes,
                           const Visit& visit) {
    LUCARNE_ASSIGN(const auto reader, open_input(inputs, input, range));
    const size_t most = std::clamp<size_t>(batch_bytes / inputs.schema().stride, 1, 1 << 16);
    io::PointBatch batch;
    std::vector<std::byte> storage;
    for (;;) {
        LUCARNE_ASSIGN(const size_t count, reader->read(batch, most));
        if (count == 0) {
            LeftOut left{reader->dropped(), {}};
            if (range.begin_in(input) == 0) left.losses = inputs.source(input).info().losses;
            io::add_losses(left.losses, reader->losses());
            return left;
        }
        LUCARNE_TRY(visit(inputs.convert(input, batch, storage)));
    }
}

/// The least edge of a root cube. Places in it are counted in 2^32ths, whose inverse must be a normal double.
constexpr double kLeastRoot = 1e-290;

void put_text(ByteWriter& writer, const std::string& text) {
    writer.put_all(std::vector<char>(text.begin(), text.end()));
}
std::string get_text(ByteReader& reader) {
    const auto text = reader.get_all<char>();
    return {text.begin(), text.end()};
}

/// Returns what keeps the runs of an input, of which a range may have a part.
Result<ScanRuns> runs_of(const Unifier& inputs, size_t input, const InputRange& range) {
    if (range.whole(input)) return ScanRuns();
    LUCARNE_ASSIGN(const auto reader, inputs.source(input).open());
    io::PointBatch batch;
    std::vector<std::byte> storage;
    LUCARNE_ASSIGN(const size_t count, reader->read(batch, 1));
    glm::dvec3 origin(0.0);
    if (count > 0) origin = io::position_of(inputs.schema(), inputs.convert(input, batch, storage).data());
    return ScanRuns(range.begin_in(input), inputs.source(input).info().declared_points, origin);
}

}  // namespace

void add_stations(ScanFacts& facts, const Unifier& inputs, size_t input, const ScanRuns& runs, size_t most) {
    const io::ScanInfo& info = inputs.source(input).info();
    auto found = find_stations(runs, info.metres_per_unit);
    found.resize(std::min(found.size(), most - facts.stations.size()));
    auto spans = station_spans(runs, found, info.metres_per_unit);
    const bool all = found.size() == 1 && saw_all(runs, spans);
    const auto scan = static_cast<uint32_t>(input), before = static_cast<uint32_t>(facts.stations.size());
    for (const glm::dvec3& position : found) facts.stations.push_back({scan, position, all});
    if (all) return;
    for (StationSpan& span : spans) {
        span.scan = scan;
        span.station += before;
        facts.spans.push_back(span);
    }
}

Result<Cube> root_cube(const glm::dvec3& min, const glm::dvec3& max) {
    const glm::dvec3 extent = max - min;
    double size = std::max({extent.x, extent.y, extent.z});
    if (!(size < 1e300))
        return rejected("points", "their coordinates span more than 1e300 units", "remove the outliers");
    if (size <= 0) size = 1;  // all points are at one place
    size = std::max(size, kLeastRoot);
    // Slightly wider, so that the farthest point is inside and not on the border.
    return Cube{min, size * (1 + 1e-9)};
}

std::vector<std::byte> ScanFacts::save() const {
    ByteWriter writer;
    writer.put(points);
    writer.put(dropped);
    writer.put(without_normal);
    writer.put(min);
    writer.put(max);
    writer.put(root);
    writer.put(uint64_t{inputs.size()});
    for (const auto& input : inputs) {
        writer.put(input.points);
        writer.put(input.min);
        writer.put(input.max);
        writer.put(input.color_bits);
        writer.put(uint64_t{input.losses.size()});
        for (const auto& loss : input.losses) {
            put_text(writer, loss.what);
            writer.put(loss.count);
        }
    }
    writer.put(uint64_t{stations.size()});
    for (const auto& station : stations) {
        writer.put(station.scan);
        writer.put(station.position);
        writer.put(uint8_t{station.saw_all});
    }
    writer.put_all(spans);
    return writer.take();
}
Result<ScanFacts> ScanFacts::restore(std::span<const std::byte> record) {
    ByteReader reader(record);
    ScanFacts facts;
    facts.points = reader.get<uint64_t>();
    facts.dropped = reader.get<uint64_t>();
    facts.without_normal = reader.get<uint64_t>();
    facts.min = reader.get<glm::dvec3>();
    facts.max = reader.get<glm::dvec3>();
    facts.root = reader.get<Cube>();
    for (auto left = reader.get<uint64_t>(); left > 0 && reader.sound(); --left) {
        io::Contents input;
        input.points = reader.get<uint64_t>();
        input.min = reader.get<glm::dvec3>();
        input.max = reader.get<glm::dvec3>();
        input.color_bits = reader.get<uint32_t>();
        for (auto losses = reader.get<uint64_t>(); losses > 0 && reader.sound(); --losses) {
            std::string what = get_text(reader);
            input.losses.push_back({std::move(what), reader.get<uint64_t>()});
        }
        facts.inputs.push_back(std::move(input));
    }
    for (auto left = reader.get<uint64_t>(); left > 0 && reader.sound(); --left) {
        const auto scan = reader.get<uint32_t>();
        const auto position = reader.get<glm::dvec3>();
        facts.stations.push_back({scan, position, reader.get<uint8_t>() != 0});
    }
    facts.spans = reader.get_all<StationSpan>();
    if (!reader.sound()) return failed("scan", "has an incomplete record");
    return facts;
}

void ScanFacts::join(ScanFacts later, bool continued) {
    if (continued && !inputs.empty() && !later.inputs.empty()) {
        io::Contents &all = inputs.back(), &part = later.inputs.front();
        all.points += part.points;
        all.min = glm::min(all.min, part.min);
        all.max = glm::max(all.max, part.max);
        all.color_bits = std::max(all.color_bits, part.color_bits);
        io::add_losses(all.losses, part.losses);
        later.inputs.erase(later.inputs.begin());
    }
    points += later.points;
    dropped += later.dropped;
    without_normal += later.without_normal;
    min = glm::min(min, later.min);
    max = glm::max(max, later.max);
    std::ranges::move(later.inputs, std::back_inserter(inputs));
    const auto before = static_cast<uint32_t>(stations.size());
    stations.insert(stations.end(), later.stations.begin(), later.stations.end());
    for (StationSpan& span : later.spans) {
        span.station += before;
        spans.push_back(span);
    }
}

Pass pass_over_inputs(const Unifier& inputs, InputRange range, uint64_t batch_bytes) {
    return [&inputs, range, batch_bytes](const Visit& visit) -> Result<void> {
        for (size_t input = range.first; input < range.end; ++input)
            LUCARNE_TRY(read_input(inputs, input, range, batch_bytes, visit));
        return {};
    };
}

Result<ScanFacts> scan_range(const Unifier& inputs, InputRange range, uint64_t batch_bytes,
                             size_t most_stations, EarlyCount* early, const Visit& seen_by, PartRuns* parts) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ScanFacts facts{.min = glm::dvec3(kInfinity), .max = glm::dvec3(-kInfinity)};
    const auto& schema = inputs.schema();
    const PointNormals normals(schema);
    for (size_t input = range.first; input < range.end; ++input) {
        io::Contents seen{.min = glm::dvec3(kInfinity), .max = glm::dvec3(-kInfinity)};
        io::ColorDepth depth(schema);
        const io::ScanInfo& info = inputs.source(input).info();
        const bool search = info.stations.empty();
        ScanRuns runs;
        if (search) {
            LUCARNE_ASSIGN(runs, runs_of(inputs, input, range));
        }
        LUCARNE_ASSIGN(LeftOut left,
                       read_input(inputs, input, range, batch_bytes,
                                  [&](std::span<const std::byte> records) -> Result<void> {
                                      for (size_t at = 0; at < records.size(); at += schema.stride) {
                                          const auto p = io::position_of(schema, &records[at]);
                                          seen.min = glm::min(seen.min, p);
                                          seen.max = glm::max(seen.max, p);
                                      }
                                      seen.points += records.size() / schema.stride;
                                      depth.add(records);
                                      facts.without_normal += normals.missing(records, schema.stride);
                                      if (search) runs.add(schema, records);
                                      if (early) early->add(schema, records, seen.min, seen.max);
                                      return seen_by ? seen_by(records) : Result<void>();
                                  }));
        if (search && range.whole(input))
            add_stations(facts, inputs, input, runs, most_stations);
        else if (search && parts)
            (range.begin_in(input) == 0 ? parts->first_part : parts->later_part) = std::move(runs);
        seen.color_bits = depth.bits();
        facts.min = glm::min(facts.min, seen.min);
        facts.max = glm::max(facts.max, seen.max);
        facts.points += seen.points;
        facts.dropped += left.dropped;
        seen.losses = std::move(left.losses);
        facts.inputs.push_back(std::move(seen));
    }
    return facts;
}

Result<void> complete_scan(const Unifier& inputs, size_t first, ScanFacts& facts) {
    for (size_t i = 0; i < facts.inputs.size(); ++i)
        for (const auto& loss : facts.inputs[i].losses)
            log::warn("{}: {}", inputs.source(first + i).info().path, counted(loss.count, loss.what));
    if (facts.points == 0) return rejected(inputs.source(first).info().path, "has no points");
    for (size_t i = 0; i < facts.inputs.size(); ++i)
        if (facts.inputs[i].points == 0) log::warn("{}: has no points", inputs.source(first + i).info().path);
    LUCARNE_ASSIGN(facts.root, root_cube(facts.min, facts.max));
    return {};
}

Result<ScanFacts> scan_inputs(const Unifier& inputs, uint64_t batch_bytes, size_t first, EarlyCount* early,
                              const Visit& seen_by) {
    LUCARNE_ASSIGN(ScanFacts facts, scan_range(inputs, {first, inputs.inputs()}, batch_bytes,
                                               kMostEstimatedStations, early, seen_by));
    LUCARNE_TRY(complete_scan(inputs, first, facts));
    return facts;
}

}  // namespace lucarne::octree
