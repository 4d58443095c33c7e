#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "io/core/parallel.h"
#include "io/formats/copc/copc.h"
#include "octree/convert/scans/unify.h"
#include "octree/copc/copc.h"
#include "octree/copc/node_normals.h"
#include "octree/copc/node_order.h"
#include "octree/copc/node_surface.h"
#include "octree/tree/attributes.h"
#include "octree/tree/point_normals.h"

namespace lucarne::octree {
namespace {

/// The number of points of the topmost nodes that are read to measure the surface.
constexpr uint64_t kMeasuredPoints = 200'000;
/// Bytes of loaded nodes that are kept. The coarsest ones are loaded several times before the first picture:
/// for the surface, the bounds, the site, the range of colours, and to be drawn.
constexpr uint64_t kMostKept = uint64_t{32} << 20;

class CopcSource final : public NodeSource {
 public:
    explicit CopcSource(io::copc::File file) : file_(std::move(file)) {}
    Result<void> open() {
        LUCARNE_TRY(describe());
        LUCARNE_TRY(link());
        return measure();
    }

    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return nodes_; }
    uint64_t directory_bytes() const override {
        return nodes_.size() * (sizeof(NodeInfo) + sizeof(io::copc::Node) + sizeof(io::laz::ChunkPlace) +
                                sizeof(uint32_t) + sizeof(kept_[0])) +
               std::min(kMostKept, header_.points * header_.schema.stride);
    }
    Result<NodeData> load(uint32_t node) const override;

 private:
    Result<void> describe();
    Result<void> link();
    Result<void> measure();
    Result<NodeData> decode(uint32_t node) const;
    Place place(const std::byte* record) const {
        return header_.root.place(io::position_of(header_.schema, record));
    }

    io::copc::File file_;
    SourceHeader header_;
    uint32_t file_stride_ = 0;
    /// Where estimated normals are stored; null: every point has its own.
    const io::Attribute* normal_ = nullptr;
    std::vector<NodeInfo> nodes_;
    std::vector<uint32_t> in_file_;                              ///< index of each node in the file
    mutable std::mutex mutex_;                                   ///< guards the members below
    mutable std::vector<std::shared_ptr<const NodeData>> kept_;  ///< of each node; null: is not kept
    mutable uint64_t kept_bytes_ = 0;
};

/// Returns whether the points have normals of their own, judged from the root node, which is spread over all.
Result<bool> has_all_normals(const io::PointSource& scan) {
    const PointNormals normals(scan.schema());
    io::PointBatch batch;
    LUCARNE_TRY(scan.front(0, size_t{1} << 16, batch));
    return normals.missing(std::span(batch.bytes).first(batch.count * scan.schema().stride),
                           scan.schema().stride) == 0;
}

Result<void> CopcSource::describe() {
    const io::PointSource& scan = file_.scan();
    // Renames attributes whose names are reserved.
    LUCARNE_ASSIGN(const Unifier names, Unifier::create({&scan}));
    header_.schema = names.schema();
    file_stride_ = header_.schema.stride;
    LUCARNE_ASSIGN(const bool complete, has_all_normals(scan));
    if (!names.has_normals(0) || !complete) {
        header_.schema.add(std::string(io::names::normal_oct), io::ScalarType::u8, 3);
        normal_ = &header_.schema.attributes.back();
    }
    const auto& info = file_.info();
    header_.root.min = info.centre - info.half_size;
    header_.root.size = 2 * info.half_size;
    header_.min = file_.min();
    header_.max = file_.max();
    header_.points = scan.info().declared_points;
    header_.metres_per_unit = scan.info().metres_per_unit;
    header_.scans = {scan.info()};
    return {};
}

/// Sorts the nodes into the order of a directory. In it the nodes of a level are in the order of their
/// parents, so one walk finds the links of both.
Result<void> CopcSource::link() {
    const auto all = file_.nodes();
    const auto key = [&](uint32_t i) {
        const io::copc::VoxelKey& k = all[i].key;
        return NodeKey{k.level, k.x, k.y, k.z};
    };
    const auto refused = [&](const NodeKey& k, const char* why) {
        return rejected(header_.scans[0].path,
                        fmt::format("its node {}-{}-{}-{} {}", k.level, k.x, k.y, k.z, why),
                        "convert it, which reads it as the LAZ that it is");
    };
    if (all.size() >= kNoNode) return rejected(header_.scans[0].path, "has more nodes than can be numbered");
    in_file_.resize(all.size());
    for (uint32_t i = 0; i < in_file_.size(); ++i) in_file_[i] = i;
    std::sort(in_file_.begin(), in_file_.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    nodes_.reserve(all.size());
    for (uint32_t i = 0, parent = 0; i < in_file_.size(); ++i) {
        const auto& chunk = all[in_file_[i]].chunk;
        NodeInfo node{.key = key(in_file_[i]),
                      .count = static_cast<uint32_t>(chunk.points),
                      .subtree_count = chunk.points,
                      .payload_bytes = static_cast<uint32_t>(chunk.bytes)};
        if (i > 0 && nodes_.back().key == node.key) return refused(node.key, "occurs twice");
        if (node.key.level > 0) {
            const NodeKey above = node.key.parent();
            while (parent < i && nodes_[parent].key < above) ++parent;
            if (parent == i || nodes_[parent].key != above) return refused(node.key, "has no parent");
            node.parent = parent;
            if (nodes_[parent].child_mask == 0) nodes_[parent].first_child = i;
            nodes_[parent].child_mask |= static_cast<uint8_t>(1u << node.key.octant());
        }
        nodes_.push_back(node);
    }
    for (size_t i = nodes_.size(); i-- > 1;)
        nodes_[nodes_[i].parent].subtree_count += nodes_[i].subtree_count;
    kept_.resize(nodes_.size());
    return {};
}

Result<void> CopcSource::measure() {
    size_t last = 0;
    for (uint64_t points = 0; last < nodes_.size(); ++last) {
        points += nodes_[last].count;
        if (last > 0 && points > kMeasuredPoints) break;
    }
    std::vector<std::vector<uint64_t>> codes(last);
    FirstError error;
    parallel_ranges(last, 1, [&](size_t i, size_t) {
        const auto data = load(static_cast<uint32_t>(i));
        if (!data) return error.report(i, data.error());
        for (size_t at = 0; at < data->records.size(); at += header_.schema.stride)
            codes[i].push_back(place(&data->records[at]).code());
    });
    LUCARNE_TRY(error.result());
    std::vector<uint64_t> all;
    for (const auto& some : codes) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    set_area_floors(nodes_, all, header_.root.size);
    return {};
}

Result<NodeData> CopcSource::load(uint32_t node) const {
    {
        std::unique_lock lock(mutex_);
        if (const auto kept = kept_[node]) {
            lock.unlock();
            return *kept;
        }
    }
    LUCARNE_ASSIGN(NodeData data, decode(node));
    const std::lock_guard lock(mutex_);
    if (!kept_[node] && kept_bytes_ + data.records.size() <= kMostKept) {
        kept_bytes_ += data.records.size();
        kept_[node] = std::make_shared<const NodeData>(data);
    }
    return data;
}

Result<NodeData> CopcSource::decode(uint32_t node) const {
    LUCARNE_ASSIGN(const auto records, file_.read(in_file_[node]));
    const size_t count = records.size() / file_stride_, stride = header_.schema.stride;
    std::vector<Place> places(count);
    std::vector<glm::dvec3> positions(count);
    for (size_t i = 0; i < count; ++i) {
        positions[i] = io::position_of(header_.schema, &records[i * file_stride_]);
        places[i] = header_.root.place(positions[i]);
    }
    const auto order = even_order(nodes_[node].key, places);
    std::vector<glm::vec3> normals;
    if (normal_) {
        LUCARNE_ASSIGN(normals, unsigned_normals(std::move(positions)));
    }
    NodeData data{static_cast<uint32_t>(count), std::vector<std::byte>(count * stride)};
    for (size_t i = 0; i < count; ++i) {
        std::byte* to = &data.records[i * stride];
        std::memcpy(to, &records[size_t{order[i]} * file_stride_], file_stride_);
        if (normal_) io::store(to + normal_->offset, encode_normal(normals[order[i]]));
    }
    return data;
}

}  // namespace

Result<std::unique_ptr<NodeSource>> open_copc(std::shared_ptr<const ByteSource> input) {
    LUCARNE_ASSIGN(auto file, io::copc::File::open(std::move(input)));
    auto source = std::make_unique<CopcSource>(std::move(file));
    LUCARNE_TRY(source->open());
    return source;
}

}  // namespace lucarne::octree
