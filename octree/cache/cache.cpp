#include "octree/cache/cache.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include <fmt/format.h>

#include "io/core/random.h"
#include "octree/cache/checked_read.h"
#include "octree/cache/file.h"
#include "octree/tree/filling.h"

namespace lucarne::octree {

using format::Entry;
using format::Superblock;

namespace {

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

}  // namespace

Result<std::array<std::optional<Superblock>, 2>> read_superblocks(const ByteSource& file) {
    if (file.size() < format::kFirstPayload) return damaged(file, "is too short for a cache");
    std::array<std::byte, format::kFirstPayload> bytes;
    LUCARNE_TRY(file.read_at(0, bytes));
    const std::span all(bytes);
    return std::array{format::decode(all.first<format::kSuperblockBytes>()),
                      format::decode(all.last<format::kSuperblockBytes>())};
}

Result<std::unique_ptr<CacheFile>> CacheFile::open(std::shared_ptr<const ByteSource> file,
                                                   uint64_t directory_memory) {
    auto newest = newest_superblock(*file);
    if (!newest && !is_cache(*file))
        return rejected(file->path().string(), "is not a Lucarne cache",
                        "if it is a scan, convert it first: lucarne convert SCAN -o CACHE.luc");
    LUCARNE_ASSIGN(const Superblock block, std::move(newest));
    std::unique_ptr<CacheFile> cache(new CacheFile(std::move(file), block));
    LUCARNE_TRY(cache->read_header());
    const uint64_t nodes = block.directory_bytes / format::kEntryBytes;
    if (nodes * kNodeBytes > directory_memory && cache->header_.directory_pages) {
        LUCARNE_ASSIGN(cache->pages_, PagedDirectory::open(*cache->file_, block, cache->header_,
                                                           cache->reader_, directory_memory));
        return cache;
    }
    LUCARNE_TRY(cache->read_directory());
    LUCARNE_TRY(cache->check_structure());
    std::vector<FileRange> payloads;
    payloads.reserve(nodes + 4);
    for (size_t i = 0; i < cache->nodes_.size(); ++i)
        if (const uint64_t bytes = cache->nodes_[i].payload_bytes)
            payloads.push_back({cache->payloads_[i].offset, cache->payloads_[i].offset + bytes});
    LUCARNE_TRY(cache->check_overlaps(std::move(payloads)));
    return cache;
}

Result<std::unique_ptr<CacheFile>> CacheFile::open(const std::filesystem::path& path,
                                                   uint64_t directory_memory) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    return open(std::move(file), directory_memory);
}

Result<void> CacheFile::read_header() {
    LUCARNE_ASSIGN(const auto metadata, read_checked(*file_, block_.metadata_offset, block_.metadata_bytes,
                                                     block_.metadata_checksum, "its metadata"));
    LUCARNE_ASSIGN(header_,
                   parse_metadata(file_->path().string(),
                                  {reinterpret_cast<const char*>(metadata.data()), metadata.size()}));
    LUCARNE_ASSIGN(reader_, PayloadReader::create(file_->path().string(), header_));
    if (!header_.filling || header_.filling->points == 0) return {};
    const FillingSection& filling = *header_.filling;
    const uint64_t records = filling.points * filling.schema.stride;
    if (records > codec::kMostRecordBytes ||
        (filling.codec == format::kCodecRaw ? filling.bytes != records : filling.bytes >= records))
        return damaged(*file_, "it states a wrong size of its synthetic surfels");
    if (!inside(filling.offset, filling.bytes, block_.file_bytes))
        return damaged(*file_, "its synthetic surfels lie outside the file");
    return {};
}

Result<void> CacheFile::read_directory() {
    LUCARNE_ASSIGN(const auto bytes, read_checked(*file_, block_.directory_offset, block_.directory_bytes,
                                                  block_.directory_checksum, "its directory"));
    LUCARNE_TRY(check_pages(bytes));
    const EntryCheck check(*file_, block_, header_, reader_);
    const size_t count = bytes.size() / format::kEntryBytes;
    nodes_.reserve(count);
    payloads_.reserve(count);
    for (uint32_t i = 0; i < count; ++i) {
        LUCARNE_ASSIGN(const auto node, check.load(i, &bytes[i * format::kEntryBytes]));
        nodes_.push_back(node.info);
        payloads_.push_back(node.payload);
    }
    return {};
}

/// Checks that the directory's pages, if it has any, are those of its entries.
Result<void> CacheFile::check_pages(std::span<const std::byte> directory) const {
    if (!header_.directory_pages) return {};
    LUCARNE_ASSIGN(const auto stored, read_pages(*file_, block_, *header_.directory_pages));
    if (stored != pages_of(directory, header_.directory_pages->nodes))
        return damaged(*file_, "its directory and the pages of it differ");
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

Result<void> CacheFile::check_overlaps(std::vector<FileRange> ranges) const {
    const auto add = [&](uint64_t offset, uint64_t bytes) { ranges.push_back({offset, offset + bytes}); };
    add(block_.directory_offset, block_.directory_bytes);
    add(block_.metadata_offset, block_.metadata_bytes);
    if (const auto& pages = header_.directory_pages)
        add(pages->offset, pages_bytes(block_.directory_bytes / format::kEntryBytes, pages->nodes));
    if (header_.filling && header_.filling->points > 0) add(header_.filling->offset, header_.filling->bytes);
    std::ranges::sort(ranges);
    for (size_t i = 1; i < ranges.size(); ++i)
        if (ranges[i].begin < ranges[i - 1].end) return damaged(*file_, "parts of it overlap");
    return {};
}

Result<FileRange> CacheFile::payload(uint32_t node) const {
    if (!pages_)
        return FileRange{payloads_[node].offset, payloads_[node].offset + nodes_[node].payload_bytes};
    LUCARNE_ASSIGN(const CheckedNode found, pages_->find(node));
    return FileRange{found.payload.offset, found.payload.offset + found.info.payload_bytes};
}

Result<NodeData> CacheFile::load(uint32_t node) const {
    if (!pages_) return reader_.load(*file_, node, nodes_[node], payloads_[node]);
    LUCARNE_ASSIGN(const CheckedNode found, pages_->find(node));
    return reader_.load(*file_, node, found.info, found.payload);
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
    assert(!pages_);
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
