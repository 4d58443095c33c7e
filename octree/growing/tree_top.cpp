// The top of an octree over finished subtrees and loose points. Taking the first point of each cell of a grid
// is the sampling of Schuetz et al., "SimLOD: Simultaneous LOD Generation and Rendering for Point Clouds",
// 2023, section 3.3 (a voxel keeps the first point that reaches it). Along the Morton curve it needs no grid:
// a point is the first one in its cells of the level at which its code differs from the previous point's, and
// of all deeper levels.
#include "octree/growing/tree_top.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <mutex>

#include "io/core/parallel.h"
#include "octree/cache/file.h"
#include "octree/convert/nodes/subtree.h"
#include "octree/tree/area_floor.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kGridLevels = 7;        ///< 2^7 cells a side of a node
constexpr size_t kWorthThreads = 100'000;  ///< points below which a cube's octants are built one by one

/// Where a node's points are: loose ones in memory, or in the file.
struct Content {
    bool loose = false;
    size_t first = 0;  ///< of the node's loose points
    StoredPayload stored;
};

class GrowingSource final : public NodeSource {
 public:
    explicit GrowingSource(const GrowingState& state)
        : header_(state.header),
          file_(state.file),
          sample_(state.sample),
          roots_(state.roots.begin(), state.roots.end()),
          decoders_(std::make_unique<codec::DecoderPool>(header_.schema)) {}

    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return nodes_; }
    Result<NodeData> load(uint32_t node) const override {
        const Content& content = contents_[node];
        const uint32_t stride = header_.schema.stride;
        if (!content.loose)
            return load_payload(*file_, node, nodes_[node], content.stored, *decoders_, stride);
        NodeData data;
        data.count = nodes_[node].count;
        data.records.resize(size_t{data.count} * stride);
        for (size_t i = 0; i < data.count; ++i)
            std::memcpy(&data.records[i * stride], loose_[content.first + i], stride);
        return data;
    }

    // Any thread may add nodes.
    void add(const NodeInfo& info, const StoredPayload& stored) {
        const std::lock_guard lock(adding_);
        nodes_.push_back(info);
        contents_.push_back({false, 0, stored});
    }
    /// Adds a node of loose points: records of the sample or of a root, which the source keeps.
    void add(const NodeInfo& info, std::span<const std::byte* const> records) {
        const std::lock_guard lock(adding_);
        nodes_.push_back(info);
        contents_.push_back({true, loose_.size(), {}});
        loose_.insert(loose_.end(), records.begin(), records.end());
    }
    /// Sorts the nodes into the order of a directory and links them.
    void link();

 private:
    SourceHeader header_;
    std::shared_ptr<const ByteSource> file_;
    std::shared_ptr<const LoosePoints> sample_;
    std::vector<std::shared_ptr<const LooseNode>> roots_;
    std::unique_ptr<codec::DecoderPool> decoders_;
    std::mutex adding_;
    std::vector<NodeInfo> nodes_;
    std::vector<const std::byte*> loose_;  ///< records of `sample_` and `roots_`, node after node
    std::vector<Content> contents_;
};

void GrowingSource::link() {
    std::vector<uint32_t> order(nodes_.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return nodes_[a].key < nodes_[b].key; });
    std::vector<NodeInfo> nodes;
    std::vector<Content> contents;
    for (const uint32_t i : order) {
        nodes.push_back(nodes_[i]);
        contents.push_back(contents_[i]);
    }
    uint32_t next = 1;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].child_mask == 0) continue;
        nodes[i].first_child = next;
        for (int child = std::popcount(nodes[i].child_mask); child > 0 && next < nodes.size(); --child)
            nodes[next++].parent = i;
    }
    nodes_ = std::move(nodes);
    contents_ = std::move(contents);
}

/// A loose point.
struct Item {
    uint64_t code = 0;
    float area = 0;           ///< in faces of the root cube
    uint8_t first_level = 0;  ///< the point is the first one in its cells of this level and deeper
    const std::byte* record = nullptr;
};

/// What build() returns to the node above.
struct Part {
    uint64_t points = 0;  ///< points in the cube that no ancestor shows; 0: there is no node
    double surface = 0;   ///< in the cube, in faces of the root cube
};

class Top {
 public:
    Top(const GrowingState& state, GrowingSource& source);
    void build() { build(NodeKey{}, 0, items_.size(), 0, roots_.size()); }

 private:
    Part build(const NodeKey& key, size_t first, size_t last, size_t first_root, size_t last_root);
    Part build_children(NodeInfo& info, size_t first, size_t last, size_t first_root, size_t last_root);
    void add_items(const LoosePoints& points, size_t first);
    void emit(const NodeInfo& info, size_t first, size_t last, double surface, bool all);
    /// The level of the node that contains a point, if nodes go that deep.
    static uint32_t level_of(const Item& item) {
        return item.first_level > kGridLevels ? item.first_level - kGridLevels : 0;
    }

    GrowingSource& source_;
    std::span<const std::shared_ptr<const LooseNode>> roots_;
    size_t stride_, leaf_;
    double root_size_;
    std::vector<Item> items_;
};

/// The end of the codes in a node's cube.
uint64_t codes_end(const NodeKey& node) {
    const NodeKey key = node.cell();
    return (key.code() + 1) << (3 * (kMaxLevel - key.level));
}

/// The end of the codes of the finished part.
uint64_t finished_end(const GrowingState& state) {
    return state.roots.empty() ? 0 : codes_end(state.roots.back()->node.key);
}

Top::Top(const GrowingState& state, GrowingSource& source)
    : source_(source),
      roots_(state.roots),
      stride_(state.header.schema.stride),
      leaf_(NodeLimits(state.header.schema.stride).leaf),
      root_size_(state.header.root.size) {
    for (const auto& root : roots_) add_items(root->points, 0);
    const uint64_t done = finished_end(state);
    const auto& codes = state.sample->codes;
    add_items(*state.sample,
              static_cast<size_t>(std::lower_bound(codes.begin(), codes.end(), done) - codes.begin()));
    for (size_t i = 0; i < items_.size(); ++i) {
        const uint64_t differs = i ? items_[i].code ^ items_[i - 1].code : uint64_t{1} << (3 * kMaxLevel);
        // The highest differing bit belongs to level kMaxLevel - bit / 3. Equal codes: no cell is small
        // enough.
        const int bit = std::bit_width(differs) - 1;
        items_[i].first_level = static_cast<uint8_t>(
            bit < 0 ? int{kMaxLevel} + 1 : int{kMaxLevel} - std::min(bit, 3 * int{kMaxLevel}) / 3);
    }
}

void Top::add_items(const LoosePoints& points, size_t first) {
    for (size_t i = first; i < points.codes.size(); ++i)
        items_.push_back({points.codes[i], points.areas[i], 0, &points.records[i * stride_]});
}

/// Adds the node with its own points, in prefix order, and its floors. `all`: the points of all levels from
/// its own on.
void Top::emit(const NodeInfo& node, size_t first, size_t last, double surface, bool all) {
    std::vector<float> inherited, own;
    std::vector<uint8_t> passes;
    std::vector<const Item*> mine;
    for (size_t i = first; i < last; ++i) {
        const uint32_t level = level_of(items_[i]);
        if (level < node.key.level) {
            inherited.push_back(items_[i].area);
        } else if (all || level == node.key.level) {
            mine.push_back(&items_[i]);
            const uint32_t base = node.key.level ? node.key.level + kGridLevels : 0;
            passes.push_back(static_cast<uint8_t>(items_[i].first_level -
                                                  std::min<uint32_t>(base, items_[i].first_level)));
        }
    }
    std::vector<uint32_t> order;
    append_prefix_order(passes, 0, order);
    std::vector<const std::byte*> records;
    for (const uint32_t i : order) {
        records.push_back(mine[i]->record);
        own.push_back(mine[i]->area);
    }
    NodeInfo info = node;
    info.count = static_cast<uint32_t>(records.size());
    info.payload_bytes = static_cast<uint32_t>(records.size() * stride_);
    info.area_floor = stored_floors(area_floors(inherited, own, surface), root_size_);
    source_.add(info, records);
}

/// Splits the points [first, last) and the roots among the octants, which are built in parallel.
Part Top::build_children(NodeInfo& info, size_t first, size_t last, size_t first_root, size_t last_root) {
    std::array<size_t, 9> point{first}, root{first_root};  // where each octant begins
    for (uint32_t octant = 0; octant < 8; ++octant) {
        const uint64_t end = codes_end(info.key.child(octant));
        size_t& next = root[octant + 1] = root[octant];
        while (next < last_root && codes_end(roots_[next]->node.key) <= end) ++next;
        const auto points = std::span(items_).subspan(point[octant], last - point[octant]);
        const auto after =
            std::ranges::partition_point(points, [&](const Item& item) { return item.code < end; });
        point[octant + 1] = point[octant] + static_cast<size_t>(after - points.begin());
    }
    std::array<Part, 8> parts;
    const auto build_one = [&](size_t i) {
        if (point[i] < point[i + 1] || root[i] < root[i + 1])
            parts[i] =
                build(info.key.child(static_cast<uint32_t>(i)), point[i], point[i + 1], root[i], root[i + 1]);
    };
    parallel_ranges(8, last - first < kWorthThreads ? 8 : 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) build_one(i);
    });
    Part sum;
    for (uint32_t octant = 0; octant < 8; ++octant) {
        sum.points += parts[octant].points;
        sum.surface += parts[octant].surface;
        if (parts[octant].points > 0) info.child_mask |= static_cast<uint8_t>(1u << octant);
    }
    return sum;
}

Part Top::build(const NodeKey& key, size_t first, size_t last, size_t first_root, size_t last_root) {
    NodeInfo info;
    info.key = key;
    size_t above = 0, deeper = 0;  // points that ancestors or descendants show
    for (size_t i = first; i < last; ++i) {
        above += level_of(items_[i]) < key.level;
        deeper += level_of(items_[i]) > key.level;
    }
    Part part;
    bool whole = true;
    if (first_root < last_root && roots_[first_root]->node.key == key) {
        const Pending& node = roots_[first_root]->node;
        info.child_mask = node.child_mask;
        part = {node.points - above, node.surface};
    } else if (first_root == last_root && (last - first <= leaf_ || key.level == kMaxLevel)) {
        std::vector<float> areas;
        std::vector<uint64_t> codes;
        for (size_t i = first; i < last; ++i)
            areas.push_back(items_[i].area), codes.push_back(items_[i].code);
        part = {last - first - above, surface_of(areas, codes, key.level, 1)};
    } else {
        whole = false;
        part = build_children(info, first, last, first_root, last_root);
        part.points += last - first - above - deeper;
    }
    info.subtree_count = part.points;
    if (part.points > 0) emit(info, first, last, part.surface, whole);
    return part;
}

}  // namespace

std::shared_ptr<const NodeSource> make_growing_source(const GrowingState& state) {
    auto source = std::make_shared<GrowingSource>(state);
    Top(state, *source).build();
    const uint64_t done = finished_end(state);
    for (const format::Entry& entry : state.settled)
        if (codes_end(entry.key) <= done)
            source->add({.key = entry.key,
                         .child_mask = entry.child_mask,
                         .count = entry.count,
                         .subtree_count = entry.subtree_count,
                         .payload_bytes = entry.payload_bytes,
                         .area_floor = entry.area_floor},
                        StoredPayload{entry.payload_offset, entry.checksum, entry.codec, entry.layout});
    source->link();
    return source;
}

}  // namespace lucarne::octree
