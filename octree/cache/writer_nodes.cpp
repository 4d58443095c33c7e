// Reading nodes back while their cache is being written.
#include <algorithm>

#include "octree/cache/file.h"
#include "octree/cache/writer.h"
#include "octree/tree/footprint.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kMostVisited = 4096;  // nodes, where they have few points
constexpr uint64_t kMostEven = 16384;    // nodes of an even subsample

/// The file that is being written.
class Unfinished final : public ByteSource {
 public:
    using Read = std::function<Result<void>(uint64_t, std::span<std::byte>)>;
    Unfinished(uint64_t bytes, Read read) : ByteSource("the new cache", bytes, 0), read_(std::move(read)) {}
    Result<size_t> read_some(uint64_t offset, std::span<std::byte> out) const override {
        const size_t bytes = std::min<uint64_t>(out.size(), size() - std::min(offset, size()));
        LUCARNE_TRY(read_(offset, out.first(bytes)));
        return bytes;
    }

 private:
    Read read_;
};

}  // namespace

Result<void> CacheWriter::each_entry(const std::function<void(const format::Entry&)>& visit) {
    constexpr size_t kBlock = 1024 * format::kEntryBytes;
    LUCARNE_TRY(flush_entries());
    std::vector<std::byte> block(kBlock);
    for (uint64_t at = 0; at < entries_written_; at += kBlock) {
        const std::span part(block.data(), std::min<uint64_t>(kBlock, entries_written_ - at));
        LUCARNE_TRY(entries_.read_at(at, part));
        for (size_t i = 0; i < part.size(); i += format::kEntryBytes) visit(format::load_entry(&part[i]));
    }
    return {};
}

Result<std::vector<format::Entry>> CacheWriter::coarsest(uint64_t most) {
    std::array<uint64_t, kMostLevel + 1> points{}, nodes{}, wanted{}, seen{};
    LUCARNE_TRY(each_entry([&](const format::Entry& entry) {
        points[entry.key.level] += entry.count;
        ++nodes[entry.key.level];
    }));
    uint64_t left_points = std::max(most, points[0]), left_nodes = kMostVisited;
    for (size_t level = 0; level <= kMostLevel && nodes[level]; ++level) {
        const uint64_t mean = points[level] / nodes[level] + 1;
        const bool whole = points[level] <= left_points && nodes[level] <= left_nodes;
        wanted[level] = whole ? nodes[level] : std::min({nodes[level], left_points / mean, left_nodes});
        left_points -= std::min(left_points, points[level]);
        left_nodes -= wanted[level];
    }
    std::vector<format::Entry> chosen;
    LUCARNE_TRY(each_entry([&](const format::Entry& entry) {
        const size_t level = entry.key.level;
        const uint64_t i = seen[level]++;
        if (wanted[level] * (i + 1) / nodes[level] != wanted[level] * i / nodes[level])
            chosen.push_back(entry);
    }));
    std::ranges::stable_sort(chosen, {}, [](const format::Entry& entry) { return entry.key.level; });
    return chosen;
}

Result<void> CacheWriter::load_each(const SourceHeader& header, std::span<const format::Entry> entries,
                                    const LoadedVisit& visit) {
    const Unfinished file(end_,
                          [this](uint64_t offset, std::span<std::byte> out) { return read_at(offset, out); });
    LUCARNE_ASSIGN(const PayloadReader reader, PayloadReader::create(file.path().string(), header));
    for (const format::Entry& entry : entries) {
        const NodeInfo info{.key = entry.key, .count = entry.count, .payload_bytes = entry.payload_bytes};
        const StoredPayload payload{entry.payload_offset, entry.checksum, entry.codec, entry.layout};
        LUCARNE_ASSIGN(NodeData data, reader.load(file, 0, info, payload));
        if (!visit(entry, data)) break;
    }
    return {};
}

Result<void> CacheWriter::visit_coarsest(const SourceHeader& header, uint64_t most, const NodeVisit& visit) {
    LUCARNE_ASSIGN(const auto entries, coarsest(most));
    return load_each(header, entries, [&](const format::Entry& entry, NodeData& data) {
        return visit(header.root.of(entry.key), data);
    });
}

Result<void> CacheWriter::visit_even(const SourceHeader& header, uint64_t most, const EvenVisit& visit) {
    std::array<uint64_t, kMostLevel + 1> points{}, nodes{};
    LUCARNE_TRY(each_entry([&](const format::Entry& entry) {
        points[entry.key.level] += entry.count;
        ++nodes[entry.key.level];
    }));
    std::array<double, kMostLevel + 1> share{};
    uint64_t left_points = most, left_nodes = kMostEven;
    size_t last = 0;
    for (size_t level = 0; level <= kMostLevel && nodes[level] && nodes[level] <= left_nodes; ++level) {
        share[level] = std::min(1.0, static_cast<double>(left_points) / static_cast<double>(points[level]));
        last = level;
        if (points[level] > left_points) break;
        left_points -= points[level];
        left_nodes -= nodes[level];
    }
    std::vector<format::Entry> chosen;
    LUCARNE_TRY(each_entry([&](const format::Entry& entry) {
        if (share[entry.key.level] > 0 && entry.count > 0) chosen.push_back(entry);
    }));
    return load_each(header, chosen, [&](const format::Entry& entry, NodeData& data) {
        const double part = share[entry.key.level];
        data.count = static_cast<uint32_t>(part * data.count);
        data.records.resize(size_t{data.count} * header.schema.stride);
        const float floors[4] = {entry.area_floor[0], entry.area_floor[1], entry.area_floor[2],
                                 entry.area_floor[3]};
        const bool thinned = entry.key.level == last && (part < 1 || entry.child_mask != 0);
        visit(header.root.of(entry.key), data,
              thinned ? floor_at_prefix(floors, static_cast<float>(part)) : 0.0f);
        return true;
    });
}

}  // namespace lucarne::octree
