#include <algorithm>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "octree/cache/cache.h"
#include "octree/cache/checked_read.h"
#include "octree/cache/file.h"

namespace lucarne::octree {
namespace {

/// Checks both superblocks. A new cache has two equal ones; after an append the older state stays valid in
/// the other one.
Result<void> check_superblocks(const CacheFile& cache) {
    const auto& file = cache.file();
    LUCARNE_ASSIGN(const auto blocks, read_superblocks(file));
    for (size_t i = 0; i < blocks.size(); ++i) {
        format::SuperblockBytes stored;
        LUCARNE_TRY(file.read_at(i * format::kSuperblockBytes, stored));
        // The bytes outside the superblock's own checksum must be zero: encode() writes them so.
        if (!blocks[i] || stored != format::encode(*blocks[i]))
            return rejected(file.path().string(), fmt::format("superblock {} is damaged", i),
                            "if an interrupted update did it, lucarne compact writes both again");
    }
    return {};
}

/// Checks the directory's own checksum, which covers all pages.
Result<void> check_sum_of_pages(const CacheFile& cache) {
    const format::Superblock& block = cache.superblock();
    const auto read = [&](uint64_t at, std::span<std::byte> out) { return cache.file().read_at(at, out); };
    LUCARNE_ASSIGN(const uint64_t sum, checksum_of(read, block.directory_offset, block.directory_bytes));
    if (sum != block.directory_checksum)
        return damaged(cache.file(), "its directory does not match its checksum");
    return {};
}

/// Checks what a directory that is read page by page has not shown yet: its checksum, the counts of subtrees,
/// and that nothing overlaps. Takes 16 bytes of memory a node.
Result<void> check_all_pages(const CacheFile& cache) {
    LUCARNE_TRY(check_sum_of_pages(cache));
    std::vector<FileRange> payloads;
    payloads.reserve(cache.nodes().size());
    const auto nodes = cache.nodes();
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        const NodeInfo node = nodes[i];
        uint64_t below = node.count;
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = node.child(octant); child != kNoNode)
                below += nodes[child].subtree_count;
        LUCARNE_TRY(cache.directory_state());
        if (below != node.subtree_count)
            return damaged(cache.file(), fmt::format("the counts below node {} do not add up", i));
        LUCARNE_ASSIGN(const FileRange range, cache.payload(i));
        if (range.begin < range.end) payloads.push_back(range);
    }
    return cache.check_overlaps(std::move(payloads));
}

/// Checks that a node's points lie in its cube, and extends the bounds by them.
Result<void> check_points(const CacheFile& cache, uint32_t index, glm::dvec3& least, glm::dvec3& most) {
    LUCARNE_ASSIGN(const NodeData data, cache.load(index));
    const auto& header = cache.header();
    const NodeKey cell = cache.nodes()[index].key.cell();
    for (size_t i = 0; i < data.count; ++i) {
        const auto p = io::position_of(header.schema, &data.records[i * header.schema.stride]);
        // Written so that a NaN fails as well.
        const bool bounded =
            glm::all(glm::greaterThanEqual(p, header.min)) && glm::all(glm::lessThanEqual(p, header.max));
        if (!bounded || header.root.place(p).key(cell.level) != cell)
            return rejected(cache.file().path().string(),
                            fmt::format("point {} of node {} lies outside its cube", i, index));
        least = glm::min(least, p);
        most = glm::max(most, p);
    }
    return {};
}

/// Checks that the synthetic surfels can be read and lie in the root cube.
Result<void> check_filling(const CacheFile& cache) {
    LUCARNE_ASSIGN(const NodeData data, cache.load_filling());
    if (data.count == 0) return {};
    const auto& schema = cache.header().filling->schema;
    const Cube& root = cache.header().root;
    const glm::dvec3 least = root.min - 1e-6 * root.size, most = root.min + (1 + 1e-6) * root.size;
    for (size_t i = 0; i < data.count; ++i) {
        const auto p = io::position_of(schema, &data.records[i * schema.stride]);
        if (!(glm::all(glm::greaterThanEqual(p, least)) && glm::all(glm::lessThanEqual(p, most))))
            return rejected(cache.file().path().string(),
                            fmt::format("synthetic surfel {} lies outside the root cube", i));
    }
    return {};
}

}  // namespace

Result<VerifyReport> verify_cache(std::shared_ptr<const ByteSource> file,
                                  const std::function<void(uint64_t)>& progress, uint64_t directory_memory) {
    const std::string name = file->path().string();
    LUCARNE_ASSIGN(const auto cache, CacheFile::open(std::move(file), directory_memory));
    LUCARNE_TRY(check_superblocks(*cache));
    if (!cache->whole()) LUCARNE_TRY(check_all_pages(*cache));
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    glm::dvec3 least(kInfinity), most(-kInfinity);
    VerifyReport report;
    const auto nodes = cache->nodes();
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        LUCARNE_TRY(check_points(*cache, i, least, most));
        report.points += nodes[i].count;
        report.depth = std::max(report.depth, nodes[i].key.level);
        progress(nodes[i].payload_bytes);
    }
    LUCARNE_TRY(check_filling(*cache));
    if (report.points && (least != cache->header().min || most != cache->header().max))
        return rejected(name, "its stored bounds differ from those of its points");
    report.nodes = nodes.size();
    report.bytes = cache->file().size();
    report.bytes_behind_end =
        report.bytes - cache->superblock().file_bytes;  // open() checked that this is not negative
    return report;
}

Result<VerifyReport> verify_cache(const std::filesystem::path& path,
                                  const std::function<void(uint64_t)>& progress) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    return verify_cache(std::move(file), progress);
}

}  // namespace lucarne::octree
