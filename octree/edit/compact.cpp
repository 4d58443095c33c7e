#include "octree/cache/writer.h"
#include "octree/edit/rewrite.h"

namespace lucarne::octree {
namespace {

/// Copies nodes as they are stored, in the order of a build: the children of a node after all of their
/// descendants.
class Copier {
 public:
    Copier(const CacheFile& cache, CacheWriter& writer) : cache_(cache), writer_(writer) {}

    Result<void> below(uint32_t node) {
        const auto nodes = cache_.nodes();
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[node].child(octant); child != kNoNode) LUCARNE_TRY(below(child));
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[node].child(octant); child != kNoNode) LUCARNE_TRY(copy(child));
        return {};
    }
    Result<void> copy(uint32_t node) {
        auto entry = cache_.entry(node);
        payload_.resize(entry.payload_bytes);
        LUCARNE_TRY(cache_.file().read_at(entry.payload_offset, payload_));
        if (format::checksum(payload_) != entry.checksum)
            return rejected(cache_.file().path().string(),
                            "node " + std::to_string(node) + " does not match its checksum",
                            "convert the scan again");
        LUCARNE_ASSIGN(entry.payload_offset, writer_.append(payload_));
        return writer_.add(entry);
    }
    /// Copies the synthetic surfels and updates where they are.
    Result<void> copy(FillingSection& filling) {
        payload_.resize(filling.bytes);
        if (filling.points == 0) return {};
        LUCARNE_TRY(cache_.file().read_at(filling.offset, payload_));
        if (format::checksum(payload_) != filling.checksum)
            return rejected(cache_.file().path().string(),
                            "its synthetic surfels do not match their checksum", "convert the scan again");
        LUCARNE_ASSIGN(filling.offset, writer_.append(payload_));
        return {};
    }

 private:
    const CacheFile& cache_;
    CacheWriter& writer_;
    std::vector<std::byte> payload_;
};

/// Returns how many bytes of the file the newest state needs.
uint64_t live_bytes(const CacheFile& cache) {
    const auto& block = cache.superblock();
    uint64_t bytes = format::kFirstPayload + block.metadata_bytes + block.directory_bytes;
    if (cache.header().filling) bytes += cache.header().filling->bytes;
    for (const NodeInfo& node : cache.nodes()) bytes += node.payload_bytes;
    return bytes;
}

Result<CompactReport> compact(const OpenedCache& opened, const std::filesystem::path& temp_folder) {
    const auto& path = opened.file->path();
    LUCARNE_ASSIGN(CacheWriter writer, CacheWriter::create(path, true, scratch_folder(path, temp_folder)));
    Copier copier(*opened.cache, writer);
    LUCARNE_TRY(copier.below(0));
    LUCARNE_TRY(copier.copy(0));
    SourceHeader header = opened.cache->header();
    if (header.filling) LUCARNE_TRY(copier.copy(*header.filling));
    LUCARNE_TRY(writer.finish(header));
    return CompactReport{opened.cache->file().size(), writer.bytes()};
}

}  // namespace

Result<CompactReport> compact_cache(const std::filesystem::path& path,
                                    const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(const OpenedCache opened, OpenedCache::open(path));  // holds the lock
    return compact(opened, temp_folder);
}

Result<CompactReport> compact_if_half_unused(const std::filesystem::path& path,
                                             const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(const OpenedCache opened, OpenedCache::open(path));
    const uint64_t bytes = opened.cache->file().size();
    if (live_bytes(*opened.cache) >= bytes / 2) return CompactReport{bytes, bytes, false};
    return compact(opened, temp_folder);
}

}  // namespace lucarne::octree
