#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "io/core/progress.h"
#include "octree/edit/rewrite.h"
#include "octree/tree/scan_number.h"

namespace lucarne::octree {
namespace {

bool inside(const Box& box, const glm::dvec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
}

/// Decides for each record of the cache whether it is selected.
class Selector {
 public:
    Selector(const Selection& selection, const io::Schema& schema)
        : selection_(selection), schema_(schema), scan_(schema_) {}
    Selector(const Selector& other) : Selector(other.selection_, other.schema_) {}

    bool operator()(const std::byte* record) const {
        if (selection_.box && !inside(*selection_.box, io::position_of(schema_, record))) return false;
        return !selection_.scan || *selection_.scan == scan_.of(record);
    }

 private:
    Selection selection_;
    io::Schema schema_;
    ScanNumber scan_;
};

struct Found {
    std::vector<uint64_t> by_node;
    uint64_t removed = 0;
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};
};

/// Reads every point. Counts the selected ones and finds the bounds of the others.
Result<Found> find_points(const CacheFile& cache, const Selector& selected) {
    const auto& header = cache.header();
    Found found;
    found.by_node.resize(cache.nodes().size());
    Progress progress("looking for points", header.points, "points");
    for (uint32_t node = 0; node < cache.nodes().size(); ++node) {
        LUCARNE_ASSIGN(const NodeData data, cache.load(node));
        for (size_t i = 0; i < data.count; ++i) {
            const std::byte* record = &data.records[i * header.schema.stride];
            if (selected(record)) {
                ++found.by_node[node];
                ++found.removed;
                continue;
            }
            const auto p = io::position_of(header.schema, record);
            found.min = glm::min(found.min, p);
            found.max = glm::max(found.max, p);
        }
        progress.add(data.count);
    }
    return found;
}

}  // namespace

Result<EditReport> delete_from_cache(const Selection& selection, const EditOptions& options) {
    LUCARNE_ASSIGN(OpenedCache opened, OpenedCache::open(options.cache));
    const auto& before = opened.cache->header();
    if (selection.scan && *selection.scan >= before.scans.size())
        return bad_arguments(
            "--scan", fmt::format("{} is none of the cache's {} scans", *selection.scan, before.scans.size()),
            "lucarne info lists them, from 0");
    const Selector selected(selection, before.schema);
    LUCARNE_ASSIGN(Found found, find_points(*opened.cache, selected));
    if (found.removed == 0)
        return EditReport{.points = before.points,
                          .kept_nodes = opened.cache->nodes().size(),
                          .nodes = opened.cache->nodes().size(),
                          .bytes = opened.cache->superblock().file_bytes};
    if (found.removed == before.points)
        return bad_arguments(options.cache.string(), "would have no points left", "remove the file instead");
    Change change;
    change.header = before;
    change.header.points -= found.removed;
    change.header.min = found.min;
    change.header.max = found.max;
    change.changed = std::move(found.by_node);
    change.removed = selected;
    LUCARNE_ASSIGN(EditReport report, rewrite(std::move(opened), change, options));
    report.removed = found.removed;
    return report;
}

}  // namespace lucarne::octree
