#include "octree/edit/rewrite.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <thread>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <malloc.h>

#include "io/core/parallel.h"
#include "io/core/progress.h"
#include "octree/cluster/only_rank.h"
#include "octree/colours/colour_survey.h"
#include "octree/convert/nodes/assembler.h"
#include "octree/convert/nodes/in_order.h"
#include "octree/convert/nodes/join_ranks.h"
#include "octree/edit/edit_plan.h"
#include "octree/holes/hole_survey.h"
#include "octree/tree/attributes.h"
#include "octree/tree/radix_sort.h"
#include "octree/tree/station_ids.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kLeastLane = 8 << 10;  // least buffer per cube while points are distributed

/// The Morton codes of kMaxLevel in a cube, [first, end).
std::array<uint64_t, 2> codes_of(const NodeKey& key) {
    const NodeKey cell = key.cell();
    const uint32_t bits = 3 * (kMaxLevel - cell.level);
    return {cell.code() << bits, (cell.code() + 1) << bits};
}

std::vector<NodeKey> keys_of(std::span<const EditPlan::Item> items) {
    std::vector<NodeKey> keys;
    for (const auto& item : items) keys.push_back(item.key);
    return keys;
}

/// A cube that is built again, or a node that is kept.
struct Piece {
    NodeKey key;
    bool kept = false;
    size_t index = 0;
};

std::vector<Piece> in_morton_order(std::span<const NodeKey> rebuilt, std::span<const NodeKey> kept) {
    std::vector<Piece> pieces;
    for (size_t i = 0; i < rebuilt.size(); ++i) pieces.push_back({rebuilt[i], false, i});
    for (size_t i = 0; i < kept.size(); ++i) pieces.push_back({kept[i], true, i});
    std::ranges::stable_sort(pieces, {}, [](const Piece& piece) { return codes_of(piece.key)[0]; });
    return pieces;
}

/// Runs one update, stage by stage; of several ranks each does its part.
class Rewrite {
 public:
    Rewrite(const CacheFile& cache, const Change& change, const EditOptions& options)
        : cache_(cache),
          change_(change),
          options_(options),
          ranks_(options.ranks ? *options.ranks : alone_),
          folder_(scratch_folder(options.cache, options.temp_folder)),
          threads_(options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency())),
          limits_(change.header.schema.stride),
          shift_(cache.header().root, change.header.root),
          widen_(cache.header().schema, change.header.schema) {}

    /// `writer`: at rank 0.
    Result<EditReport> run(CacheWriter* writer);

 private:
    const io::Schema& schema() const { return change_.header.schema; }
    Result<void> plan();
    Result<void> deal();
    Result<void> share_out(std::span<const uint64_t> added);
    Result<void> find_surface();
    Result<void> align_normals();
    Result<void> write_nodes(CacheWriter* writer);
    Result<void> make_nodes(std::span<const Piece> pieces, const RecordLoader& loader, const NodeKey* next,
                            CacheWriter& writer, Assembler& assembler);
    Result<void> visit_node(uint32_t node, const Visit& visit) const;
    Result<void> visit_below(uint32_t node, const Visit& visit) const;
    Result<void> add_descendants(uint32_t node, CacheWriter& writer);
    bool shared() const { return ranks_.count() > 1; }
    /// The kept nodes of this rank.
    std::span<const EditPlan::Item> own_kept() const {
        const size_t first = first_kept_[ranks_.rank()];
        return std::span(plan_.kept).subspan(first, first_kept_[ranks_.rank() + 1] - first);
    }
    /// Whether a cube has a part in common with the pieces of this rank.
    bool touches_own(const NodeKey& key) const {
        const auto codes = codes_of(key);
        return codes[0] < own_codes_[1] && own_codes_[0] < codes[1];
    }
    Result<Subtree> kept_subtree(const RecordLoader& loader, size_t item) const;

    const CacheFile& cache_;
    const Change& change_;
    const EditOptions& options_;
    OnlyRank alone_;
    Ranks& ranks_;
    std::filesystem::path folder_;
    unsigned threads_;
    NodeLimits limits_;
    Shift shift_;
    RecordMap widen_;  ///< from the cache's schema to the new one
    MemoryPlan memory_;
    EditPlan plan_;
    std::vector<size_t> first_rebuilt_, first_kept_;  ///< of each rank, and the end
    std::array<uint64_t, 2> own_codes_{};             ///< Morton codes of this rank's pieces, [first, end)
    uint64_t own_points_ = 0;                         ///< in this rank's stores
    std::optional<ChunkStore> rebuilt_;
    std::optional<ChunkStore> kept_;  ///< of own_kept()
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
    const GivenCubes rebuilt(keys_of(plan_.rebuilt));
    LUCARNE_ASSIGN(ScratchFile rebuilt_file, ScratchFile::create(folder_));
    LUCARNE_ASSIGN(ScratchFile kept_file, ScratchFile::create(folder_));
    const bool stations = schema().find(io::names::area) && !change_.spans.empty();
    rebuilt_.emplace(std::move(rebuilt_file), schema(), change_.header.root, stations);
    kept_.emplace(std::move(kept_file), schema(), change_.header.root);
    const auto with_stations = [&](Pass pass, ScanPlace first) {
        return stations ? with_point_stations(std::move(pass), schema(), change_.spans, first) : pass;
    };
    const Pass added = change_.added ? with_stations(change_.added, change_.first_added)
                                     : [](const Visit&) { return Result<void>(); };
    LUCARNE_ASSIGN(const auto counts, rebuilt_->count_in(rebuilt, added));
    LUCARNE_TRY(share_out(counts));
    const ChunkRange own{first_rebuilt_[ranks_.rank()], first_rebuilt_[ranks_.rank() + 1]};
    const auto top = [this](const Visit& visit) -> Result<void> {
        for (const uint32_t node : plan_.top)
            if (touches_own(shift_(cache_.nodes()[node].key))) LUCARNE_TRY(visit_node(node, visit));
        return {};
    };
    const Pass present = [&](const Visit& visit) -> Result<void> {
        LUCARNE_TRY(top(visit));
        for (size_t i = own.first; i < own.end; ++i)
            if (plan_.rebuilt[i].node != kNoNode) LUCARNE_TRY(visit_below(plan_.rebuilt[i].node, visit));
        return {};
    };
    const Pass kept = [&](const Visit& visit) -> Result<void> {
        LUCARNE_TRY(top(visit));
        for (const auto& item : own_kept()) LUCARNE_TRY(visit_node(item.node, visit));
        return {};
    };
    LUCARNE_TRY(rebuilt_->fill({with_stations(present, {}), added, counts, first_rebuilt_}, rebuilt, memory_,
                               ranks_));
    LUCARNE_TRY(kept_->fill(kept, GivenCubes(keys_of(own_kept())), memory_));
    for (size_t i = rebuilt_->own().first; i < rebuilt_->own().end; ++i)
        own_points_ += rebuilt_->chunks()[i].count;
    for (const auto& chunk : kept_->chunks()) own_points_ += chunk.count;
    std::array<uint64_t, 2> points{own_points_, own_points_};
    for (const auto& item : own_kept()) {
        const auto& node = cache_.nodes()[item.node];
        points[1] += node.subtree_count - node.count;
    }
    LUCARNE_TRY(ranks_.sum(points));
    report_.rewritten_points = points[0];
    if (points[1] != change_.header.points)
        return rejected("inputs", "changed while they were read", "append again when they are complete");
    return {};
}

/// Gives each rank consecutive cubes and kept nodes with about equally many points. `added`: how many points
/// of this rank are in each cube. A meeting.
Result<void> Rewrite::share_out(std::span<const uint64_t> added) {
    std::vector<uint64_t> points(added.begin(), added.end()), weights;
    LUCARNE_TRY(ranks_.sum(points));
    const auto pieces = in_morton_order(keys_of(plan_.rebuilt), keys_of(plan_.kept));
    for (const Piece& piece : pieces) {
        const uint32_t node = (piece.kept ? plan_.kept : plan_.rebuilt)[piece.index].node;
        uint64_t weight = piece.kept ? cache_.nodes()[node].count : points[piece.index];
        if (!piece.kept && node != kNoNode) weight += cache_.nodes()[node].subtree_count;
        weights.push_back(weight);
    }
    const auto first = divide(weights, ranks_.count());
    size_t kept = 0;
    for (size_t i = 0, rank = 0; i <= pieces.size(); ++i) {
        for (; rank < first.size() && first[rank] == i; ++rank) {
            first_rebuilt_.push_back(i - kept);
            first_kept_.push_back(kept);
        }
        if (i < pieces.size() && pieces[i].kept) ++kept;
    }
    const size_t own = first[ranks_.rank()], end = first[ranks_.rank() + 1];
    if (own < end) own_codes_ = {codes_of(pieces[own].key)[0], codes_of(pieces[end - 1].key)[1]};
    return {};
}

/// Estimates areas of all points that are built again, and normals of those that have none.
Result<void> Rewrite::find_surface() {
    if (!schema().find(io::names::area) || rebuilt_->chunks().empty()) return {};  // the same on all ranks
    const bool normals = schema().find(io::names::normal_oct) != nullptr;
    LUCARNE_ASSIGN(ScratchFile file, ScratchFile::create(folder_));
    const SurfaceStore::Settings settings{.normals = normals,
                                          .neighbours = options_.neighbours,
                                          .search = options_.neighbour_search,
                                          .threads = threads_,
                                          .memory = options_.memory,
                                          .estimated_stations = change_.header.estimated_stations,
                                          .ranks = shared() ? &ranks_ : nullptr,
                                          .folder = folder_};
    LUCARNE_ASSIGN(surface_,
                   SurfaceStore::estimate(*rebuilt_, change_.header.scans, std::move(file), settings));
    return normals ? align_normals() : Result<void>{};
}

/// Aligns new normals with the old ones around them, which were oriented when more of the surface was known.
/// What of a connected surface is in a chunk is flipped as a whole if most of its old points say so; without
/// old points there it follows those of the surface in other chunks, else all old points. Components that a
/// station saw face it already, whatever old points that no station saw say.
Result<void> Rewrite::align_normals() {
    const auto* attribute = schema().find(io::names::normal_oct);
    const uint32_t stride = rebuilt_->schema().stride;
    const uint64_t piece = std::max<uint64_t>(1, memory_.batch_bytes / stride);
    struct Votes {
        std::map<uint32_t, int64_t> balance;  ///< by connected surface
        std::map<uint32_t, bool> seen;        ///< by component: whether a station saw points of it
    };
    const StationIds ids(change_.header.scans, rebuilt_->schema(), change_.header.estimated_stations);
    const ChunkRange own = rebuilt_->own();
    std::vector<Votes> votes(own.end - own.first);
    int64_t all = 0;
    for (size_t chunk = own.first; chunk < own.end; ++chunk) {
        const uint64_t count = rebuilt_->chunks()[chunk].count;
        for (uint64_t first = 0; first < count; first += piece) {
            const uint64_t part = std::min(piece, count - first);
            LUCARNE_ASSIGN(const auto records, rebuilt_->load(chunk, first, part));
            LUCARNE_ASSIGN(const auto found, surface_->load(chunk, first, part));
            for (size_t i = 0; i < part; ++i) {
                Votes& own_votes = votes[chunk - own.first];
                bool& seen = own_votes.seen[found[i].component];
                const std::byte* record = &records[i * stride];
                const auto old = decode_normal(io::load<NormalCode>(record + attribute->offset));
                if (found[i].normal != glm::vec3(0.0f) && !seen)
                    seen = ids.of(record) >= 0 || rebuilt_->estimated_station(record) >= 0;
                if (!old || found[i].normal == glm::vec3(0.0f)) continue;
                const int side = glm::dot(*old, found[i].normal) < 0 ? -1 : 1;
                own_votes.balance[surface_->surface(chunk, found[i].component)] += side;
                all += side;
            }
        }
    }
    // Sums of negative numbers are right modulo 2^64.
    uint64_t surfaces = 0;
    for (const Votes& vote : votes)
        if (!vote.balance.empty()) surfaces = std::max<uint64_t>(surfaces, vote.balance.rbegin()->first + 1);
    LUCARNE_TRY(ranks_.sum({&surfaces, 1}));  // at least as many as any rank knows
    std::vector<uint64_t> sums(surfaces + 1, 0);
    sums.back() = static_cast<uint64_t>(all);
    for (const Votes& vote : votes)
        for (const auto& [surface, balance] : vote.balance) sums[surface] += static_cast<uint64_t>(balance);
    LUCARNE_TRY(ranks_.sum(sums));
    for (size_t i = 0; i < votes.size(); ++i)
        for (const auto& [component, seen] : votes[i].seen) {
            const uint32_t surface = surface_->surface(own.first + i, component);
            int64_t balance = votes[i].balance[surface];
            if (balance == 0 && surface < surfaces) balance = static_cast<int64_t>(sums[surface]);
            if (balance == 0) balance = static_cast<int64_t>(sums.back());
            if (!seen && balance < 0) surface_->turn(own.first + i, component);
        }
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
            if (shared()) entry.payload_offset |= kStays;
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
    const NodeInfo& node = cache_.nodes()[own_kept()[item].node];
    const uint64_t count = kept_->chunks()[item].count;
    const size_t stride = schema().stride;
    LUCARNE_ASSIGN(const auto records, kept_->load(item, 0, count));
    std::vector<CodeIndex> sorted(count);
    for (uint32_t i = 0; i < count; ++i) sorted[i] = {loader.place(&records[i * stride]).code(), i};
    sort_by_code(sorted, 3 * kMaxLevel);
    Subtree tree;
    tree.root = {.key = own_kept()[item].key,
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

/// Makes the nodes of some pieces. `next`: the root of the piece after them, null at the end.
Result<void> Rewrite::make_nodes(std::span<const Piece> pieces, const RecordLoader& loader,
                                 const NodeKey* next, CacheWriter& writer, Assembler& assembler) {
    const RecordLoader same(*kept_, nullptr, false, {});
    const size_t first_kept = first_kept_[ranks_.rank()];
    Progress progress("building", own_points_, "points");
    const auto make = [&](size_t i) {
        return pieces[i].kept ? kept_subtree(same, pieces[i].index - first_kept)
                              : build_subtree(loader, pieces[i].index, limits_);
    };
    const auto take = [&](size_t i, Subtree&& tree) -> Result<void> {
        if (ranks_.stopped()) return failed("the update", "has failed on another rank");
        const auto& [key, is_kept, index] = pieces[i];
        progress.add(is_kept ? kept_->chunks()[index - first_kept].count : rebuilt_->chunks()[index].count);
        if (is_kept) LUCARNE_TRY(add_descendants(plan_.kept[index].node, writer));
        return assembler.add(std::move(tree), i + 1 < pieces.size() ? &pieces[i + 1].key : next);
    };
    return in_order(pieces.size(), memory_.workers, make, take);
}

/// Of several ranks each makes its nodes in scratch files, from which rank 0 gets them.
Result<void> Rewrite::write_nodes(CacheWriter* writer) {
    std::vector<NodeKey> chunks;
    for (const auto& chunk : rebuilt_->chunks()) chunks.push_back(chunk.key);
    const auto pieces = in_morton_order(chunks, keys_of(plan_.kept));
    const RecordLoader loader(*rebuilt_, surface_ ? &*surface_ : nullptr, false, change_.header.scans);
    if (!shared()) {
        LUCARNE_ASSIGN(Assembler assembler, Assembler::create(*writer, loader, limits_, folder_));
        return make_nodes(pieces, loader, nullptr, *writer, assembler);
    }
    const ChunkRange own_chunks = rebuilt_->own(),
                     kept{first_kept_[ranks_.rank()], first_kept_[ranks_.rank() + 1]};
    const auto is_own = [&](const Piece& piece) {
        return (piece.kept ? kept : own_chunks).contains(piece.index);
    };
    const auto begin = std::ranges::find_if(pieces, is_own),
               end = std::find_if_not(begin, pieces.end(), is_own);
    LUCARNE_ASSIGN(CacheWriter staged, CacheWriter::stage(folder_));
    LUCARNE_ASSIGN(Assembler own, Assembler::create(staged, loader, limits_, folder_));
    own.only_a_part(begin != pieces.begin() ? &std::prev(begin)->key : nullptr);
    LUCARNE_TRY(make_nodes({begin, end}, loader, end != pieces.end() ? &end->key : nullptr, staged, own));
    LUCARNE_TRY(ranks_.sum({&report_.kept_nodes, 1}));
    return join_at_first(ranks_, {loader, limits_, staged, own}, writer, folder_);
}

Result<EditReport> Rewrite::run(CacheWriter* writer) {
    const ThreadLimit threads(threads_);
    LUCARNE_TRY(plan());
    // Freed memory goes back to the system, or the next stage's is added to it (as in a build).
    LUCARNE_TRY(deal());
    ::malloc_trim(0);
    LUCARNE_TRY(find_surface());
    ::malloc_trim(0);
    LUCARNE_TRY(write_nodes(writer));
    ::malloc_trim(0);
    report_.points = change_.header.points;
    if (!writer) return report_;  // rank 0 does what is left
    SourceHeader header = change_.header;
    // Points that are deleted leave the others' colours as they were; new ones are compared with the old.
    if (change_.added) {
        LUCARNE_ASSIGN(header.station_colours, survey_colours(*writer, header));
    }
    // The holes are others now.
    if (header.filling) {
        LUCARNE_ASSIGN(const HoleSurvey survey, fill_holes(*writer, header, options_.memory));
        header.filling = survey.filling;
        if (survey.station) header.estimated_stations.push_back(*survey.station);
    }
    LUCARNE_TRY(writer->finish(header));
    report_.nodes = writer->nodes();
    report_.bytes = writer->bytes();
    return report_;
}

}  // namespace

Result<OpenedCache> OpenedCache::open(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(UpdateFile file, UpdateFile::open(path, "is being changed by another process"));
    LUCARNE_ASSIGN(auto cache, CacheFile::open(path, kWholeDirectory));
    LUCARNE_ASSIGN(const auto blocks, read_superblocks(cache->file()));
    const size_t newest = blocks[0] && *blocks[0] == cache->superblock() ? 0 : 1;
    return OpenedCache{std::move(file), std::move(cache), newest};
}

Result<OpenedCache> OpenedCache::open(const std::filesystem::path& path, Ranks& ranks) {
    std::optional<OpenedCache> opened;
    if (ranks.rank() == 0) {
        LUCARNE_ASSIGN(opened, open(path));
    }
    LUCARNE_TRY(meet(ranks));  // from now on nobody else changes it
    if (!opened) {
        LUCARNE_ASSIGN(auto cache, CacheFile::open(path, kWholeDirectory));
        opened.emplace(OpenedCache{{}, std::move(cache)});
    }
    const auto state = format::encode(opened->cache->superblock());
    LUCARNE_TRY(check_same(ranks, path.string(),
                           fmt::format("{:016x}", format::checksum(std::as_bytes(std::span(state))))));
    return std::move(*opened);
}

Result<EditReport> rewrite(OpenedCache opened, const Change& change, const EditOptions& options) {
    Rewrite update(*opened.cache, change, options);
    if (!opened.file) return update.run(nullptr);
    LUCARNE_ASSIGN(CacheWriter writer,
                   CacheWriter::update(std::move(*opened.file), opened.cache->superblock(), opened.newest,
                                       scratch_folder(options.cache, options.temp_folder)));
    auto report = update.run(&writer);
    if (!report) writer.abandon();
    return report;
}

std::filesystem::path scratch_folder(const std::filesystem::path& cache, const std::filesystem::path& given) {
    if (!given.empty()) return given;
    return cache.has_parent_path() ? cache.parent_path() : std::filesystem::path(".");
}

}  // namespace lucarne::octree
