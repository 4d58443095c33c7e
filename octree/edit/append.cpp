#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "io/core/log.h"
#include "io/formats/scan.h"
#include "octree/cluster/only_rank.h"
#include "octree/convert/build_inputs.h"
#include "octree/convert/scans/scan_stage.h"
#include "octree/convert/together.h"
#include "octree/edit/edit_plan.h"
#include "octree/edit/rewrite.h"
#include "octree/tree/attributes.h"
#include "octree/tree/edge_line.h"
#include "octree/tree/scan_number.h"
#include "octree/tree/stored_names.h"

namespace lucarne::octree {
namespace {

/// Represents the cache among the inputs whose schemas are unified. It is the first input, and has no points,
/// because the cache's points stay where they are.
class CacheSchema final : public io::PointSource {
 public:
    explicit CacheSchema(const CacheFile& cache) {
        const auto& from = cache.header().schema;
        schema_.position = from.position;
        schema_.scale = from.scale;
        schema_.offset = from.offset;
        schema_.stride = static_cast<uint32_t>(io::position_bytes(from.position));
        for (const auto& a : from.attributes)
            if (a.name != io::names::scan && !is_estimate(a.name))
                schema_.add(name_in_file(a.name), a.type, a.components);
        info_.path = cache.file().path().string();
    }
    const io::Schema& schema() const override { return schema_; }
    const io::ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override { return std::make_unique<Nothing>(); }

 private:
    struct Nothing final : io::PointReader {
        Result<size_t> read(io::PointBatch&, size_t) override { return size_t{0}; }
        uint64_t dropped() const override { return 0; }
    };
    io::Schema schema_;
    io::ScanInfo info_;
};

/// Returns the unified schema with the attributes that the cache's build added. `scans`: of the cache with
/// the inputs, for the width of their numbers.
io::Schema whole_schema(const Unifier& inputs, const io::Schema& cache, size_t scans) {
    const io::Attribute* before = cache.find(io::names::scan);
    const bool wide = scans > kMostShortScans || (before && before->type == io::ScalarType::u32);
    io::Schema schema = inputs.schema();
    schema.attributes.clear();
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    for (const auto& a : inputs.schema().attributes)
        schema.add(a.name, wide && a.name == io::names::scan ? io::ScalarType::u32 : a.type, a.components);
    for (const auto name : kEstimates)
        if (const auto* added = cache.find(name)) schema.add(added->name, added->type, added->components);
    return schema;
}

/// Returns a pass over the new points of a range in the cache's schema. Normals, areas and lines are marked
/// as not yet estimated.
Pass added_points(const Unifier& inputs, InputRange range, const io::Schema& schema, size_t scans_before,
                  uint64_t batch_bytes) {
    const RecordMap map(inputs.schema(), schema);
    return [&inputs, range, schema, map, scans_before, batch_bytes](const Visit& visit) -> Result<void> {
        const auto* normal = schema.find(io::names::normal_oct);
        const auto* area = schema.find(io::names::area);
        const auto* edge = schema.find(io::names::edge_line);
        const ScanNumber scan(schema);
        std::vector<std::byte> records;
        const Pass pass = pass_over_inputs(inputs, range, batch_bytes);
        return pass([&](std::span<const std::byte> batch) -> Result<void> {
            map.convert(batch.data(), batch.size() / inputs.schema().stride, records);
            for (size_t at = 0; at < records.size(); at += schema.stride) {
                std::byte* record = &records[at];
                if (normal) io::store(record + normal->offset, kNoNormal);
                if (area) io::store(record + area->offset, kNoArea);
                if (edge) io::store(record + edge->offset, kNoEdge);
                // The unifier counts the cache as input 0.
                scan.store(record, static_cast<uint32_t>(scans_before + scan.of(record) - 1));
            }
            return visit(records);
        });
    };
}

/// Counts the added points by the deepest old node that contains them.
Result<std::vector<uint64_t>> count_by_node(const CacheFile& cache, const SourceHeader& header,
                                            const Pass& added) {
    const auto nodes = cache.nodes();
    const Shift shift(cache.header().root, header.root);
    std::vector<uint64_t> counts(nodes.size(), 0);
    LUCARNE_TRY(added([&](std::span<const std::byte> records) -> Result<void> {
        for (size_t at = 0; at < records.size(); at += header.schema.stride) {
            const Place place = header.root.place(io::position_of(header.schema, &records[at]));
            if (place.key(shift.levels()) != shift.root()) continue;  // outside the old root
            uint32_t node = 0;
            for (uint32_t level = shift.levels() + 1; level <= kMaxLevel; ++level) {
                const uint32_t child = nodes[node].child(place.key(level).octant());
                if (child == kNoNode) break;
                node = child;
            }
            ++counts[node];
        }
        return {};
    }));
    return counts;
}

/// Returns the header of the state with the new scans.
Result<SourceHeader> header_with(const CacheFile& cache, const Unifier& inputs, const ScanFacts& facts) {
    const auto& before = cache.header();
    SourceHeader header = before;
    const size_t scans = before.scans.size() + inputs.inputs() - 1;
    header.schema = whole_schema(inputs, before.schema, scans);
    if (header.schema != before.schema) header.layouts.push_back(before.schema);
    if (header.layouts.size() > kMostLayouts || scans > kMostScans)
        return rejected(cache.file().path().string(), "was appended to too often",
                        "convert all scans together");
    LUCARNE_ASSIGN(header.root, grown_root(before.root, facts.min, facts.max));
    header.min = glm::min(before.min, facts.min);
    header.max = glm::max(before.max, facts.max);
    header.points = before.points + facts.points;
    for (auto& scan : header.scans) widen_colour(scan, before.schema, header.schema);
    for (size_t i = 1; i < inputs.inputs(); ++i) {  // the cache is input 0
        header.scans.push_back(inputs.source(i).info());
        adjust_colour(header.scans.back(), inputs.source(i).schema(), header.schema, facts.inputs[i - 1]);
        if (!header.scans.back().unit_stated) header.scans.back().metres_per_unit = before.metres_per_unit;
        header.scans.back().losses = facts.inputs[i - 1].losses;
    }
    for (EstimatedStation station : facts.stations) {
        station.scan += static_cast<uint32_t>(before.scans.size() - 1);
        if (header.estimated_stations.size() < kMostEstimatedStations)
            header.estimated_stations.push_back(station);
    }
    return header;
}

/// Returns the parts of the new scans that estimated stations saw, counted as in `header`.
std::vector<StationSpan> added_spans(const SourceHeader& before, const SourceHeader& header,
                                     const ScanFacts& facts) {
    std::vector<StationSpan> spans;
    for (StationSpan span : facts.spans) {
        span.scan += static_cast<uint32_t>(before.scans.size() - 1);
        span.station += static_cast<uint32_t>(before.estimated_stations.size());
        if (span.station < header.estimated_stations.size()) spans.push_back(span);
    }
    return spans;
}

std::string file_name(const io::ScanInfo& scan) {
    return std::filesystem::path(scan.path).filename().string();
}

Result<bool> has_points_of(const CacheFile& cache, size_t scan) {
    const auto& schema = cache.header().schema;
    const ScanNumber number(schema);
    if (!number) return true;  // all points are of its only scan
    for (uint32_t node = 0; node < cache.nodes().size(); ++node) {
        LUCARNE_ASSIGN(const NodeData data, cache.load(node));
        for (size_t i = 0; i < data.count; ++i)
            if (number.of(&data.records[i * schema.stride]) == scan) return true;
    }
    return false;
}

/// Whether the cache already contains this file in this state. Logs that, and also if the cache may contain
/// another state of the file.
Result<bool> holds_already(const CacheFile& cache, const io::ScanInfo& scan) {
    const auto& scans = cache.header().scans;
    if (scan.file_bytes == 0) return false;  // not a file
    for (size_t i = 0; i < scans.size(); ++i) {
        if (file_name(scans[i]) != file_name(scan)) continue;
        const bool same = scans[i].file_bytes == scan.file_bytes && scans[i].modified == scan.modified;
        if (!same && scans[i].path != scan.path) continue;
        LUCARNE_ASSIGN(const bool there, has_points_of(cache, i));
        if (!there) continue;  // its points were deleted
        const std::string cache_name = cache.file().path().string();
        if (same) {
            log::warn("{}: is in {} already, as scan {}; it is left out", scan.path, cache_name, i);
            return true;
        }
        log::warn(
            "{}: another state of this file is in {} already, as scan {}; lucarne delete --scan {} {} "
            "removes it",
            scan.path, cache_name, i, i, cache_name);
    }
    return false;
}

/// Returns which of the scans the cache already contains, as rank 0 finds. A meeting.
Result<std::vector<bool>> held_already(const CacheFile& cache,
                                       const std::vector<const io::PointSource*>& scans, Ranks& ranks) {
    Ranks::Bytes there(scans.size());
    if (ranks.rank() == 0)
        for (size_t i = 0; i < scans.size(); ++i) {
            LUCARNE_ASSIGN(const bool held, holds_already(cache, scans[i]->info()));
            there[i] = std::byte{held};
        }
    LUCARNE_ASSIGN(there, hear_first(ranks, std::move(there)));
    std::vector<bool> result;
    for (const std::byte held : there) result.push_back(held != std::byte{0});
    return result;
}

/// Appends; of several ranks each does its part.
Result<EditReport> append(const std::vector<const io::PointSource*>& scans, const EditOptions& options,
                          Ranks& ranks) {
    constexpr uint64_t kBatchBytes = 1 << 20;
    const bool shared = ranks.count() > 1;
    if (shared) {
        LUCARNE_TRY(check_ranks(ranks,
                                fmt::format("{} {} {}", options.memory, options.neighbours,
                                            static_cast<int>(options.neighbour_search)),
                                scans));
    }
    LUCARNE_ASSIGN(OpenedCache opened, OpenedCache::open(options.cache, ranks));
    LUCARNE_ASSIGN(const auto held, held_already(*opened.cache, scans, ranks));
    const auto& before = opened.cache->header();
    const CacheSchema cache(*opened.cache);
    std::vector<const io::PointSource*> sources{&cache};
    std::vector<io::ScanInfo> all = before.scans;
    EditReport skipped;
    for (size_t i = 0; i < scans.size(); ++i) {
        const auto* scan = scans[i];
        if (held[i]) {
            skipped.already_in.push_back(scan->info().path);
            continue;
        }
        LUCARNE_TRY(check_unit(scan->info(), before.metres_per_unit, "the cache has"));
        sources.push_back(scan);
        all.push_back(scan->info());
    }
    if (sources.size() == 1) {
        skipped.points = before.points;
        skipped.kept_nodes = skipped.nodes = opened.cache->nodes().size();
        skipped.bytes = opened.cache->superblock().file_bytes;
        return skipped;
    }
    warn_of_differences(all);
    LUCARNE_ASSIGN(const Unifier inputs, Unifier::create(sources, replaces_normals(before.schema)));
    InputRange own{1, inputs.inputs()};
    if (shared) {
        LUCARNE_ASSIGN(own, inputs_of_rank(inputs, ranks, 1));
    }
    const auto go_on = [&](std::span<const std::byte>) -> Result<void> {
        if (ranks.stopped()) return failed("the update", "has failed on another rank");
        return {};
    };
    LUCARNE_ASSIGN(const ScanFacts facts,
                   shared ? scan_together(inputs, own, kBatchBytes, ranks, 1, nullptr, go_on)
                          : scan_inputs(inputs, kBatchBytes, 1));
    sources.erase(sources.begin());  // removes the cache
    for (const auto* scan : sources) warn_of_assumed_unit(scan->info(), before.metres_per_unit);
    const bool lit = before.schema.find(io::names::area) && !before.schema.find(io::names::normal_oct);
    if (lit && facts.without_normal > 0)
        log::warn(
            "{} of the new points have no normal, and the cache keeps those of its scans; they get no light "
            "until "
            "the scans are converted together",
            facts.without_normal);
    Change change;
    LUCARNE_ASSIGN(change.header, header_with(*opened.cache, inputs, facts));
    change.spans = added_spans(before, change.header, facts);
    change.added = added_points(inputs, own, change.header.schema, before.scans.size(), kBatchBytes);
    change.first_added = {static_cast<uint32_t>(before.scans.size() + own.first - 1), own.first_point};
    LUCARNE_ASSIGN(change.changed, count_by_node(*opened.cache, change.header, change.added));
    LUCARNE_TRY(ranks.sum(change.changed));
    LUCARNE_ASSIGN(EditReport report, rewrite(std::move(opened), change, options));
    report.added = facts.points;
    report.dropped = facts.dropped;
    report.appended = std::move(sources);
    report.inputs = facts.inputs;
    report.already_in = std::move(skipped.already_in);
    return report;
}

}  // namespace

Result<EditReport> append_to_cache(const std::vector<const io::PointSource*>& scans,
                                   const EditOptions& options) {
    OnlyRank alone;
    Ranks& ranks = options.ranks ? *options.ranks : alone;
    auto report = append(scans, options, ranks);
    LUCARNE_TRY(ranks.conclude(report ? Result<void>() : tl::make_unexpected(report.error())));
    return report;
}

}  // namespace lucarne::octree
