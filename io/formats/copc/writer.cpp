#include "io/formats/copc/writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace lucarne::io::copc {
namespace {

constexpr uint64_t kEvlrHeader = 60;
/// Number of levels of a subtree that a page holds: at most 585 nodes and 4096 references, 150 KB.
constexpr uint32_t kPageLevels = 4;

/// The hierarchy as pages, the root's first. Each page holds the nodes of its levels and references to the
/// pages below.
class Pages {
 public:
    /// Adds a node. Parents must come before their children.
    void add(const Node& node) { pages_[page_of(node.key)].nodes.push_back(node); }

    uint64_t root_bytes() const { return bytes_of(pages_[0]); }
    /// Returns the pages one after the other. The first begins at `offset` of the file.
    std::vector<std::byte> bytes(uint64_t offset) const {
        std::vector<uint64_t> offsets;
        for (const Page& page : pages_) {
            offsets.push_back(offset);
            offset += bytes_of(page);
        }
        std::vector<std::byte> data;
        for (const Page& page : pages_) {
            for (const Node& node : page.nodes)
                append(data, node.key, node.chunk.offset, node.chunk.bytes,
                       static_cast<int32_t>(node.chunk.points));
            for (const size_t below : page.below)
                append(data, pages_[below].root, offsets[below], bytes_of(pages_[below]), -1);
        }
        return data;
    }

 private:
    struct Page {
        VoxelKey root;
        std::vector<Node> nodes;
        std::vector<size_t> below;
    };

    static uint64_t bytes_of(const Page& page) {
        return kEntryBytes * (page.nodes.size() + page.below.size());
    }
    static VoxelKey ancestor(const VoxelKey& key, uint32_t level) {
        const uint32_t up = key.level - level;
        return {level, key.x >> up, key.y >> up, key.z >> up};
    }
    size_t page_of(const VoxelKey& key) {
        const VoxelKey root = ancestor(key, key.level / kPageLevels * kPageLevels);
        const auto [found, is_new] =
            numbers_.try_emplace(std::array{root.level, root.x, root.y, root.z}, pages_.size());
        const size_t number = found->second;
        if (is_new) {
            pages_.push_back({root, {}, {}});
            if (root.level > 0) {
                const size_t above = page_of(ancestor(root, root.level - 1));
                pages_[above].below.push_back(number);
            }
        }
        return number;
    }
    static void append(std::vector<std::byte>& data, const VoxelKey& key, uint64_t offset, uint64_t bytes,
                       int32_t points) {
        data.resize(data.size() + kEntryBytes);
        std::byte* at = &data[data.size() - kEntryBytes];
        store(at, key);
        store(at + 16, offset);
        store(at + 24, static_cast<int32_t>(bytes));
        store(at + 28, points);
    }
    static_assert(sizeof(VoxelKey) == 16);

    std::vector<Page> pages_;
    std::map<std::array<uint32_t, 4>, size_t> numbers_;
};

las::Vlr info_record(const Info& info) {
    return {std::string(kUser), kInfoRecord, "COPC info VLR", false, info.bytes()};
}

}  // namespace

Result<std::unique_ptr<NodeWriter>> NodeWriter::create(const std::filesystem::path& path,
                                                       const Schema& schema, const ScanInfo& info,
                                                       const WriteOptions& options, const Info& cube) {
    LUCARNE_ASSIGN(auto target, las::make_target(path.string(), schema, info, options, las::Container::copc));
    auto& records = target.header.vlrs;
    std::erase_if(records, [](const las::Vlr& vlr) { return vlr.user_id == kUser; });
    records.insert(records.begin(), info_record(cube));
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, options.overwrite));
    std::unique_ptr<NodeWriter> writer(
        new NodeWriter(std::move(file), path.string(), std::move(target), schema.stride, cube));
    LUCARNE_TRY(writer->writer_.begin(laz::kVariableChunks));
    return writer;
}

Result<void> NodeWriter::write(const VoxelKey& key, std::span<const std::byte> records) {
    if (records.size() > kMostNodeBytes)
        return failed(fmt::format("node {}-{}-{}-{}", key.level, key.x, key.y, key.z),
                      "has more points than a COPC node should have", "export to a plain .laz");
    nodes_.push_back({key, records.empty()});
    LUCARNE_TRY(writer_.write(records));
    return writer_.end_chunk();
}

Result<void> NodeWriter::finish() {
    LUCARNE_TRY(writer_.finish_points());
    Pages pages;
    auto chunk = writer_.chunks().begin();
    for (const Written& node : nodes_) pages.add({node.key, node.empty ? laz::ChunkPlace{} : *chunk++});
    const las::Statistics& statistics = writer_.statistics();
    if (statistics.gps_low <= statistics.gps_high) {
        info_.gps_low = statistics.gps_low;
        info_.gps_high = statistics.gps_high;
    }
    info_.page_offset = writer_.position() + kEvlrHeader;
    info_.page_bytes = pages.root_bytes();
    auto& records = writer_.header().vlrs;
    records[0] = info_record(info_);
    records.insert(records.begin() + 1, {std::string(kUser), kHierarchyRecord, "EPT hierarchy", true,
                                         pages.bytes(info_.page_offset)});
    return writer_.finish();
}

}  // namespace lucarne::io::copc
