#include "octree/edit/rewrite.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "io/core/progress.h"
#include "octree/colours/colour_survey.h"
#include "octree/convert/chunks/point_stations.h"
#include "octree/convert/nodes/assembler.h"
#include "octree/convert/nodes/in_order.h"
#include "octree/edit/edit_plan.h"
#include "octree/holes/hole_survey.h"
#include "octree/tree/attributes.h"
#include "octree/tree/radix_sort.h"
#include "octree/tree/station_ids.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kLeastLane = 8 << 10;  // least buffer per cube while points are distributed

/// Runs one update, stage by stage.
class Rewrite {
 public:
    Rewrite(const CacheFile& cache, const Change& change, const EditOptions& options)
        : cache_(cache),
          change_(change),
          options_(options),
          folder_(scratch_folder(options.cache, options.temp_folder)),
          threads_(options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency())),
          limits_(change.header.schema.stride),
          shift_(cache.header().root, change.header.root),
          widen_(cache.header().schema, change.header.schema) {}

    Result<EditReport> run(CacheWriter& writer);

 private:
    const io::Schema& schema() const { return change_.header.schema; }
    Result<void> plan();
    Result<void> deal();
    Result<void> find_surface();
    Result<void> align_normals();
    Result<void> write_nodes(CacheWriter& writer);
    Result<void> visit_node(uint32_t node, const Visit& visit) const;
    Result<void> visit_below(uint32_t node, const Visit& visit) const;
    Result<void> add_descendants(uint32_t node, CacheWriter& writer);
    Result<Subtree> kept_subtree(const RecordLoader& loader, size_t item) const;

    const CacheFile& cache_;
    const Change& change_;
    const EditOptions& options_;
    std::filesystem::path folder_;
    unsigned threads_;
    NodeLimits limits_;
    Shift shift_;
    RecordMap widen_;  ///< from the cache's schema to the new one
    MemoryPlan memory_;
    EditPlan plan_;
    std::optional<ChunkStore> rebuilt_, kept_;
    std::optional<SurfaceStore> surface_;
    EditReport report_;
};

Result<void> Rewrite::plan() {
    const bool normals = schema().find(io::names::area) != nullptr;
    LUCARNE_ASSIGN(memory_,
                   MemoryPlan::create(options_.memory, {schema().stride, limits_.leaf, normals, threads_}));
    const EditLimits limits{
        memory_.chunk_points, limits_.leaf,
        std::max<uint64_t>(64, memory_.buffer_bytes / std::max<uint64_t>(kLeastLane, schema().stride))};
    LUCARNE_ASSIGN(plan_, plan_edit(cache_.nodes(), shift_, change_.changed, change_.header.points, limits));
    return {};
}

/// Visits those records of a node that stay, in the new schema.
Result<void> Rewrite::visit_node(uint32_t node, const Visit& visit) const {
    LUCARNE_ASSIGN(NodeData data, cache_.load(node));
    std::vector<std::byte> records;
    if (widen_.identical())
        records = std::move(data.records);
    else
        widen_.convert(data.records.data(), data.count, records);
    if (!change_.removed) return visit(records);
    const size_t stride = schema().stride;
    size_t kept = 0;
    for (size_t at = 0; at < records.size(); at += stride) {
        if (change_.removed(&records[at])) continue;
        if (kept != at) std::memcpy(&records[kept], &records[at], stride);
        kept += stride;
    }
    return visit(std::span(records).first(kept));
}

Result<void> Rewrite::visit_below(uint32_t node, const Visit& visit) const {
    LUCARNE_TRY(visit_node(node, visit));
    for (uint32_t octant = 0; octant < 8; ++octant)
        if (const uint32_t child = cache_.nodes()[node].child(octant); child != kNoNode)
            LUCARNE_TRY(visit_below(child, visit));  // as deep as the tree
    return {};
}

/// Distributes points to the cubes that are built again, and to the samples of the kept nodes. A kept node's
/// own points and those of the nodes above it inside its cube are the sample that it showed before its parent
/// took some.
Result<void> Rewrite::deal() {
    const auto keys = [](const std::vector<EditPlan::Item>& items) {
        std::vector<NodeKey> result;
        for (const auto& item : items) result.push_back(item.key);
        return result;
    };
    const auto top = [this](const Visit& visit) -> Result<void> {
        for (const uint32_t node : plan_.top) LUCARNE_TRY(visit_node(node, visit));
        return {};
    };
    const Pass rebuilt = [&](const Visit& visit) -> Result<void> {
        LUCARNE_TRY(top(visit));
        for (const auto& item : plan_.rebuilt)
            if (item.node != kNoNode) LUCARNE_TRY(visit_below(item.node, visit));
        return change_.added ? change_.added(visit) : Result<void>{};
    };
    const Pass kept = [&](const Visit& visit) -> Result<void> {
        LUCARNE_TRY(top(visit));
        for (const auto& item : plan_.kept) LUCARNE_TRY(visit_node(item.node, visit));
        return {};
    };
    LUCARNE_ASSIGN(ScratchFile rebuilt_file, ScratchFile::create(folder_));
    LUCARNE_ASSIGN(ScratchFile kept_file, ScratchFile::create(folder_));
    const bool stations = schema().find(io::names::area) && !change_.spans.empty();
    rebuilt_.emplace(std::move(rebuilt_file), schema(), change_.header.root, stations);
    kept_.emplace(std::move(kept_file), schema(), change_.header.root);
    LUCARNE_TRY(rebuilt_->fill(stations ? with_point_stations(rebuilt, schema(), change_.spans) : rebuilt,
                               keys(plan_.rebuilt), true, memory_));
    LUCARNE_TRY(kept_->fill(kept, keys(plan_.kept), false, memory_));
    uint64_t points = 0;
    for (const auto& chunk : rebuilt_->chunks()) points += chunk.count;
    for (const auto& chunk : kept_->chunks()) points += chunk.count;
    report_.rewritten_points = points;
    for (const auto& item : plan_.kept) {
        const auto& node = cache_.nodes()[item.node];
        points += node.subtree_count - node.count;
    }
    if (points != change_.header.points)
        return rejected("inputs", "changed while they were read", "append again when they are complete");
    return {};
}

/// Estimates areas of all points that are built again, and normals of those that have none.
Result<void> Rewrite::find_surface() {
    if (!schema().find(io::names::area) || rebuilt_->chunks().empty()) return {};
    const bool normals = schema().find(io::names::normal_oct) != nullptr;
    LUCARNE_ASSIGN(ScratchFile file, ScratchFile::create(folder_));
    const SurfaceStore::Settings settings{.normals = normals,
                                          .neighbours = options_.neighbours,
                                          .search = options_.neighbour_search,
                                          .threads = threads_,
                                          .memory = options_.memory,
                                          .estimated_stations = change_.header.estimated_stations};
    LUCARNE_ASSIGN(surface_,
                   SurfaceStore::estimate(*rebuilt_, change_.header.scans, std::move(file), settings));
    return normals ? align_normals() : Result<void>{};
}

/// Aligns new normals with the old ones around them, which were oriented when more of the surface was known.
/// Each component is flipped if most of its old points say so; components without old points follow all of
/// them together. Those that a station saw face it already, whatever old points that no station saw say.
Result<void> Rewrite::align_normals() {
    const auto* attribute = schema().find(io::names::normal_oct);
    const uint32_t stride = rebuilt_->schema().stride;
    const uint64_t piece = std::max<uint64_t>(1, memory_.batch_bytes / stride);
    struct Vote {
        int64_t balance = 0;
        bool seen = false;  ///< a station saw points of it
    };
    const StationIds ids(change_.header.scans, rebuilt_->schema(), change_.header.estimated_stations);
    std::vector<std::map<uint32_t, Vote>> votes(rebuilt_->chunks().size());
    int64_t all = 0;
    for (size_t chunk = 0; chunk < votes.size(); ++chunk) {
        const uint64_t count = rebuilt_->chunks()[chunk].count;
        for (uint64_t first = 0; first < count; first += piece) {
            const uint64_t part = std::min(piece, count - first);
            LUCARNE_ASSIGN(const auto records, rebuilt_->load(chunk, first, part));
            LUCARNE_ASSIGN(const auto found, surface_->load(chunk, first, part));
            for (size_t i = 0; i < part; ++i) {
                auto& vote = votes[chunk][found[i].component];
                const std::byte* record = &records[i * stride];
                const auto old = decode_normal(io::load<NormalCode>(record + attribute->offset));
                if (found[i].normal != glm::vec3(0.0f) && !vote.seen)
                    vote.seen = ids.of(record) >= 0 || rebuilt_->estimated_station(record) >= 0;
                if (!old || found[i].normal == glm::vec3(0.0f)) continue;
                const int side = glm::dot(*old, found[i].normal) < 0 ? -1 : 1;
                vote.balance += side;
                all += side;
            }
        }
    }
    for (size_t chunk = 0; chunk < votes.size(); ++chunk)
        for (const auto& [component, vote] : votes[chunk])
            if (!vote.seen && (vote.balance < 0 || (vote.balance == 0 && all < 0)))
                surface_->turn(chunk, component);
    return {};
}

/// Adds the directory entries of a kept node's descendants, whose payloads stay where they are.
Result<void> Rewrite::add_descendants(uint32_t node, CacheWriter& writer) {
    const auto nodes = cache_.nodes();
    const bool old_layout = !widen_.identical();
    const auto layout = static_cast<uint8_t>(change_.header.layouts.size());
    std::vector<uint32_t> level{node}, next;
    while (!level.empty()) {
        next.clear();
        for (const uint32_t parent : level)
            for (uint32_t octant = 0; octant < 8; ++octant)
                if (const uint32_t child = nodes[parent].child(octant); child != kNoNode)
                    next.push_back(child);
        for (const uint32_t child : next) {
            auto entry = cache_.entry(child);
            entry.key = shift_(entry.key);
            if (old_layout && entry.layout == 0) entry.layout = layout;
            LUCARNE_TRY(writer.add(entry));
        }
        report_.kept_nodes += next.size();
        level.swap(next);
    }
    return {};
}

/// Returns a kept node as it was before its parent took its sample. Its surface follows from its floor
/// (octree/FORMAT.md: the sum of max(area, c) over the points it shows).
Result<Subtree> Rewrite::kept_subtree(const RecordLoader& loader, size_t item) const {
    const NodeInfo& node = cache_.nodes()[plan_.kept[item].node];
    const uint64_t count = kept_->chunks()[item].count;
    const size_t stride = schema().stride;
    LUCARNE_ASSIGN(const auto records, kept_->load(item, 0, count));
    std::vector<CodeIndex> sorted(count);
    for (uint32_t i = 0; i < count; ++i) sorted[i] = {loader.place(&records[i * stride]).code(), i};
    sort_by_code(sorted, 3 * kMaxLevel);
    Subtree tree;
    tree.root = {.key = plan_.kept[item].key,
                 .child_mask = node.child_mask,
                 .points = node.subtree_count - node.count + count};
    tree.sample.reserve(records.size());
    const double edge = loader.root().first_size(), floor = node.area_floor[0] / edge / edge;
    for (const auto& from : sorted) {
        const std::byte* record = &records[from.index * stride];
        tree.sample.insert(tree.sample.end(), record, record + stride);
        tree.root.surface += std::max<double>(loader.area(record), floor);
    }
    return tree;
}

Result<void> Rewrite::write_nodes(CacheWriter& writer) {
    struct Piece {
        NodeKey key;
        bool kept = false;
        size_t index = 0;
    };
    std::vector<Piece> pieces;
    for (size_t i = 0; i < rebuilt_->chunks().size(); ++i)
        pieces.push_back({rebuilt_->chunks()[i].key, false, i});
    for (size_t i = 0; i < plan_.kept.size(); ++i) pieces.push_back({plan_.kept[i].key, true, i});
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
        const auto begin = [](const NodeKey& key) {
            const NodeKey cell = key.cell();
            return cell.code() << 3 * (kMaxLevel - cell.level);
        };
        return begin(a.key) < begin(b.key);
    });
    const RecordLoader changed(*rebuilt_, surface_ ? &*surface_ : nullptr, false),
        same(*kept_, nullptr, false);
    LUCARNE_ASSIGN(Assembler assembler, Assembler::create(writer, changed, limits_, folder_));
    Progress progress("building", report_.rewritten_points, "points");
    const auto make = [&](size_t i) {
        return pieces[i].kept ? kept_subtree(same, pieces[i].index)
                              : build_subtree(changed, pieces[i].index, limits_);
    };
    const auto take = [&](size_t i, Subtree&& tree) -> Result<void> {
        const auto& [key, is_kept, index] = pieces[i];
        progress.add((is_kept ? *kept_ : *rebuilt_).chunks()[index].count);
        if (is_kept) LUCARNE_TRY(add_descendants(plan_.kept[index].node, writer));
        return assembler.add(std::move(tree), i + 1 < pieces.size() ? &pieces[i + 1].key : nullptr);
    };
    return in_order(pieces.size(), memory_.workers, make, take);
}

Result<EditReport> Rewrite::run(CacheWriter& writer) {
    const ThreadLimit threads(threads_);
    LUCARNE_TRY(plan());
    LUCARNE_TRY(deal());
    LUCARNE_TRY(find_surface());
    LUCARNE_TRY(write_nodes(writer));
    SourceHeader header = change_.header;
    // Points that are deleted leave the others' colours as they were; new ones are compared with the old.
    if (change_.added) {
        LUCARNE_ASSIGN(header.station_colours, survey_colours(writer, header));
    }
    // The holes are others now.
    if (header.filling) {
        LUCARNE_ASSIGN(header.filling, fill_holes(writer, header, options_.memory));
    }
    LUCARNE_TRY(writer.finish(header));
    report_.points = change_.header.points;
    report_.nodes = writer.nodes();
    report_.bytes = writer.bytes();
    return report_;
}

}  // namespace

Result<OpenedCache> OpenedCache::open(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(UpdateFile file, UpdateFile::open(path, "is being changed by another process"));
    LUCARNE_ASSIGN(auto cache, CacheFile::open(path));
    LUCARNE_ASSIGN(const auto blocks, read_superblocks(cache->file()));
    const size_t newest = blocks[0] && *blocks[0] == cache->superblock() ? 0 : 1;
    return OpenedCache{std::move(file), std::move(cache), newest};
}

Result<EditReport> rewrite(OpenedCache opened, const Change& change, const EditOptions& options) {
    LUCARNE_ASSIGN(CacheWriter writer,
                   CacheWriter::update(std::move(opened.file), opened.cache->superblock(), opened.newest,
                                       scratch_folder(options.cache, options.temp_folder)));
    Rewrite update(*opened.cache, change, options);
    auto report = update.run(writer);
    if (!report) writer.abandon();
    return report;
}

std::filesystem::path scratch_folder(const std::filesystem::path& cache, const std::filesystem::path& given) {
    if (!given.empty()) return given;
    return cache.has_parent_path() ? cache.parent_path() : std::filesystem::path(".");
}

}  // namespace lucarne::octree
