#include "octree/cache/cache.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "io/core/random.h"
#include "octree/cache/file.h"
#include "octree/tree/filling.h"

namespace lucarne::octree {

using format::Entry;
using format::Superblock;

namespace {

constexpr const char* kAgain = "convert the scan again";

auto damaged(const ByteSource& file, std::string why) {
    return rejected(file.path().string(), std::move(why), kAgain);
}

/// Whether [offset, offset + bytes) lies after the superblocks and before `end`.
bool inside(uint64_t offset, uint64_t bytes, uint64_t end) {
    return offset >= format::kFirstPayload && offset <= end && bytes <= end - offset;
}

Result<Superblock> newest_superblock(const ByteSource& file) {
    LUCARNE_ASSIGN(const auto blocks, read_superblocks(file));
    const auto& [a, b] = blocks;
    if (!a && !b)
        return damaged(file, "is not a cache of this version, or both of its superblocks are damaged");
    const Superblock block = !b || (a && a->generation >= b->generation) ? *a : *b;
    if (block.file_bytes > file.size())
        return damaged(file, fmt::format("ends early: {} bytes of {}", file.size(), block.file_bytes));
    if (!inside(block.directory_offset, block.directory_bytes, block.file_bytes) ||
        !inside(block.metadata_offset, block.metadata_bytes, block.file_bytes) ||
        block.metadata_bytes > format::kMaxMetadata || block.directory_bytes % format::kEntryBytes != 0 ||
        block.directory_bytes / format::kEntryBytes >= kNoNode)
        return damaged(file, "its superblock points outside the file");
    return block;
}

/// Reads a range, checks it against the checksum `sum`, and appends `behind` zeros. The range must have been
/// checked against the file's size.
Result<std::vector<std::byte>> read_checked(const ByteSource& file, uint64_t offset, uint64_t bytes,
                                            uint64_t sum, const std::string& what, size_t behind = 0) {
    std::vector<std::byte> data(bytes + behind);
    const std::span read(data.data(), bytes);
    LUCARNE_TRY(file.read_at(offset, read));
    if (format::checksum(read) != sum) return damaged(file, what + " does not match its checksum");
    return data;
}

}  // namespace

Result<std::array<std::optional<Superblock>, 2>> read_superblocks(const ByteSource& file) {
    if (file.size() < format::kFirstPayload) return damaged(file, "is too short for a cache");
    std::array<std::byte, format::kFirstPayload> bytes;
    LUCARNE_TRY(file.read_at(0, bytes));
    const std::span all(bytes);
    return std::array{format::decode(all.first<format::kSuperblockBytes>()),
                      format::decode(all.last<format::kSuperblockBytes>())};
}

Result<std::unique_ptr<CacheFile>> CacheFile::open(std::shared_ptr<const ByteSource> file) {
    auto newest = newest_superblock(*file);
    if (!newest && !is_cache(*file))
        return rejected(file->path().string(), "is not a Lucarne cache",
                        "if it is a scan, convert it first: lucarne convert SCAN -o CACHE.luc");
    LUCARNE_ASSIGN(const Superblock block, std::move(newest));
    std::unique_ptr<CacheFile> cache(new CacheFile(std::move(file), block));
    LUCARNE_TRY(cache->read_directory());
    LUCARNE_TRY(cache->check_structure());
    LUCARNE_TRY(cache->check_payloads());
    return cache;
}

Result<std::unique_ptr<CacheFile>> CacheFile::open(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    return open(std::move(file));
}

Result<void> CacheFile::read_directory() {
    LUCARNE_ASSIGN(const auto metadata, read_checked(*file_, block_.metadata_offset, block_.metadata_bytes,
                                                     block_.metadata_checksum, "its metadata"));
    LUCARNE_ASSIGN(header_,
                   parse_metadata(file_->path().string(),
                                  {reinterpret_cast<const char*>(metadata.data()), metadata.size()}));
    LUCARNE_ASSIGN(const auto bytes, read_checked(*file_, block_.directory_offset, block_.directory_bytes,
                                                  block_.directory_checksum, "its directory"));
    const size_t count = bytes.size() / format::kEntryBytes;
    nodes_.reserve(count);
    payloads_.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const Entry entry = format::load_entry(&bytes[i * format::kEntryBytes]);
        if (entry.key.level > kMostLevel ||
            ((entry.key.x | entry.key.y | entry.key.z) >> entry.key.level) != 0)
            return damaged(*file_, fmt::format("node {} lies outside the root cube", i));
        if (entry.codec > format::kCodecColumns)
            return damaged(*file_, fmt::format("node {} uses the unknown codec {}", i, entry.codec));
        if (!std::all_of(entry.area_floor.begin(), entry.area_floor.end(),
                         [](float v) { return std::isfinite(v) && v >= 0; }))
            return damaged(*file_, fmt::format("node {} has an impossible area floor", i));
        nodes_.push_back({.key = entry.key,
                          .child_mask = entry.child_mask,
                          .count = entry.count,
                          .subtree_count = entry.subtree_count,
                          .payload_bytes = entry.payload_bytes,
                          .area_floor = entry.area_floor});
        if (entry.layout > header_.layouts.size())
            return damaged(*file_, fmt::format("node {} has the unknown layout {}", i, entry.layout));
        payloads_.push_back({entry.payload_offset, entry.checksum, entry.codec, entry.layout});
    }
    LUCARNE_ASSIGN(reader_, PayloadReader::create(file_->path().string(), header_));
    return {};
}

/// Walks the nodes in order: because the directory is breadth-first and in Morton order, the nodes' children
/// must follow each other without a gap. This one rule checks that parents exist, that keys are consistent
/// and unique, and that the order is right.
Result<void> CacheFile::check_structure() {
    if (nodes_.empty() || nodes_[0].key != NodeKey{}) return damaged(*file_, "it has no root node");
    size_t next = 1;
    for (size_t i = 0; i < nodes_.size(); ++i) {
        auto& node = nodes_[i];
        if (node.child_mask == 0) continue;
        node.first_child = static_cast<uint32_t>(next);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (!(node.child_mask >> octant & 1)) continue;
            if (next >= nodes_.size() || next <= i || nodes_[next].key != node.key.child(octant))
                return damaged(*file_, fmt::format("the children of node {} are not where they belong", i));
            nodes_[next++].parent = static_cast<uint32_t>(i);
        }
    }
    if (next != nodes_.size()) return damaged(*file_, fmt::format("node {} has no parent", next));
    std::vector<uint64_t> below(nodes_.size(), 0);
    for (size_t i = nodes_.size(); i-- > 0;) {
        const auto& node = nodes_[i];
        if (node.subtree_count < node.count || node.subtree_count - node.count != below[i])
            return damaged(*file_, fmt::format("the counts below node {} do not add up", i));
        if (i > 0 && __builtin_add_overflow(below[node.parent], node.subtree_count, &below[node.parent]))
            return damaged(*file_, "its counts overflow");
    }
    if (nodes_[0].subtree_count != header_.points)
        return damaged(*file_, "metadata and directory disagree about the number of points");
    return {};
}

Result<void> CacheFile::check_payloads() {
    std::vector<std::pair<uint64_t, uint64_t>> ranges;  // begin, end
    ranges.reserve(nodes_.size() + 2);
    ranges.emplace_back(block_.directory_offset, block_.directory_offset + block_.directory_bytes);
    ranges.emplace_back(block_.metadata_offset, block_.metadata_offset + block_.metadata_bytes);
    if (header_.filling && header_.filling->points > 0) {
        const FillingSection& filling = *header_.filling;
        const uint64_t records = filling.points * filling.schema.stride;
        if (records > codec::kMostRecordBytes ||
            (filling.codec == format::kCodecRaw ? filling.bytes != records : filling.bytes >= records))
            return damaged(*file_, "it states a wrong size of its synthetic surfels");
        if (!inside(filling.offset, filling.bytes, block_.file_bytes))
            return damaged(*file_, "its synthetic surfels lie outside the file");
        ranges.emplace_back(filling.offset, filling.offset + filling.bytes);
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        const uint64_t bytes = nodes_[i].payload_bytes;
        const uint64_t records = uint64_t{nodes_[i].count} * reader_.stride(payloads_[i].layout);
        const bool fits = payloads_[i].codec == format::kCodecRaw
                              ? bytes == records
                              : bytes < records && records <= codec::kMostRecordBytes;
        if (!fits) return damaged(*file_, fmt::format("node {} states a wrong size of its points", i));
        if (!inside(payloads_[i].offset, bytes, block_.file_bytes))
            return damaged(*file_, fmt::format("the points of node {} lie outside the file", i));
        if (bytes) ranges.emplace_back(payloads_[i].offset, payloads_[i].offset + bytes);
    }
    std::sort(ranges.begin(), ranges.end());
    for (size_t i = 1; i < ranges.size(); ++i)
        if (ranges[i].first < ranges[i - 1].second) return damaged(*file_, "parts of it overlap");
    return {};
}

Result<NodeData> load_payload(const ByteSource& file, uint32_t node, const NodeInfo& info,
                              const StoredPayload& payload, codec::DecoderPool& decoders, uint32_t stride) {
    const bool raw = payload.codec == format::kCodecRaw;
    LUCARNE_ASSIGN(auto bytes,
                   read_checked(file, payload.offset, info.payload_bytes, payload.checksum,
                                node == kNoNode ? "its synthetic surfels" : fmt::format("node {}", node),
                                raw ? 0 : codec::kReadAhead));
    if (raw) return NodeData{info.count, std::move(bytes)};
    NodeData data{info.count, std::vector<std::byte>(size_t{info.count} * stride)};
    if (!decoders.decode(std::span(bytes).first(info.payload_bytes), data.records))
        return damaged(file, node == kNoNode ? "its synthetic surfels do not decode"
                                             : fmt::format("the points of node {} do not decode", node));
    return data;
}

Result<PayloadReader> PayloadReader::create(const std::string& name, const SourceHeader& header) {
    PayloadReader reader;
    reader.layouts_.push_back(
        {header.schema.stride, std::make_unique<codec::DecoderPool>(header.schema), {}});
    for (const auto& layout : header.layouts) {
        if (!RecordMap::fits(layout, header.schema))
            return rejected(name, "it has a layout that does not fit into its schema", kAgain);
        reader.layouts_.push_back(
            {layout.stride, std::make_unique<codec::DecoderPool>(layout), RecordMap(layout, header.schema)});
    }
    return reader;
}

Result<NodeData> PayloadReader::load(const ByteSource& file, uint32_t node, const NodeInfo& info,
                                     const StoredPayload& payload) const {
    const Layout& layout = layouts_[payload.layout];
    LUCARNE_ASSIGN(NodeData data, load_payload(file, node, info, payload, *layout.decoders, layout.stride));
    if (!layout.to_schema) return data;
    NodeData converted{data.count, {}};
    layout.to_schema->convert(data.records.data(), data.count, converted.records);
    return converted;
}

Result<NodeData> CacheFile::load(uint32_t node) const {
    return reader_.load(*file_, node, nodes_[node], payloads_[node]);
}

std::optional<SourceIdentity> CacheFile::identity() const {
    return SourceIdentity{mix64(block_.directory_checksum, block_.metadata_checksum), file_->path()};
}

Result<NodeData> CacheFile::load_filling() const {
    if (!header_.filling || header_.filling->points == 0) return NodeData{};
    const FillingSection& filling = *header_.filling;
    codec::DecoderPool decoders(filling.schema);
    const NodeInfo info{.count = static_cast<uint32_t>(filling.points),
                        .payload_bytes = static_cast<uint32_t>(filling.bytes)};
    return load_payload(*file_, kNoNode, info, {filling.offset, filling.checksum, filling.codec, 0}, decoders,
                        filling.schema.stride);
}

Result<std::vector<Filling>> CacheFile::fillings() const {
    LUCARNE_ASSIGN(NodeData data, load_filling());
    std::vector<Filling> fillings;
    if (data.count > 0) fillings.push_back(grouped_filling(header_, data));
    return fillings;
}

Entry CacheFile::entry(uint32_t node) const {
    const NodeInfo& info = nodes_[node];
    const StoredPayload& payload = payloads_[node];
    return {.key = info.key,
            .child_mask = info.child_mask,
            .codec = payload.codec,
            .layout = payload.layout,
            .count = info.count,
            .payload_bytes = info.payload_bytes,
            .payload_offset = payload.offset,
            .subtree_count = info.subtree_count,
            .checksum = payload.checksum,
            .area_floor = info.area_floor};
}

bool is_cache(const ByteSource& file) {
    std::array<std::byte, 8> start;
    return file.size() >= start.size() && file.read_at(0, start) &&
           std::memcmp(start.data(), format::kMagic.data(), start.size()) == 0;
}

Result<std::unique_ptr<NodeSource>> open_cache(std::shared_ptr<const ByteSource> file) {
    return CacheFile::open(std::move(file));
}

Result<std::unique_ptr<NodeSource>> open_cache(const std::filesystem::path& path) {
    return CacheFile::open(path);
}

}  // namespace lucarne::octree
