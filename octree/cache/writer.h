#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "io/files/file.h"
#include "io/files/shared_output.h"
#include "io/files/update_file.h"
#include "octree/cache/format.h"

namespace lucarne::octree {

/// Writes a new cache. Payloads and nodes must come in the order in which a depth-first build finishes them:
/// the children of a node together in octant order, subtrees along the Morton curve, the root last. The nodes
/// of one level then come sorted, so the directory needs no sort and memory does not grow with the number of
/// nodes.
class CacheWriter {
 public:
    static Result<CacheWriter> create(const std::filesystem::path& path, bool overwrite,
                                      const std::filesystem::path& temp_folder);
    /// Writes a new state behind that of an existing cache, whose newest superblock is `before`, at index
    /// `newest`. Cuts off what an interrupted update left there. Until `finish` switches to the new state,
    /// the file shows the old one, whatever happens.
    static Result<CacheWriter> update(UpdateFile file, const format::Superblock& before, size_t newest,
                                      const std::filesystem::path& temp_folder);

    /// Starts a new cache to which other processes write as well (reserve).
    static Result<CacheWriter> create_shared(const std::filesystem::path& path, bool overwrite,
                                             const std::filesystem::path& temp_folder);
    /// Keeps payloads and nodes in scratch files, from which they get into the cache of another writer. Its
    /// offsets begin at 0.
    static Result<CacheWriter> stage(const std::filesystem::path& temp_folder);

    /// How many nodes a page of the directory has, and how many nodes must be there.
    struct Paged {
        uint32_t nodes = 0;
        uint64_t from = 0;
    };

    /// Appends a payload and returns its offset.
    Result<uint64_t> append(std::span<const std::byte> payload);
    /// Leaves room for payloads that another process writes. Returns its offset.
    uint64_t reserve(uint64_t bytes) { return std::exchange(end_, end_ + bytes); }
    /// Reads what was appended.
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Returns nodes [first, first + count) in the order of add(), as the directory stores them. Call
    /// flush_entries() first. Thread-safe.
    Result<std::vector<std::byte>> entries(uint64_t first, uint64_t count) const;
    Result<void> flush_entries();
    Result<void> add(const format::Entry& entry);
    /// Takes a node's cube and its points in the new state's schema. Returns whether it wants more nodes.
    using NodeVisit = std::function<bool(const Cube& cube, const NodeData& data)>;
    /// Visits the coarsest of the nodes added so far: the root, further whole levels that have `most` points
    /// at the most, and of the next level as many nodes, evenly spaced. `header` is that of the new state.
    Result<void> visit_coarsest(const SourceHeader& header, uint64_t most, const NodeVisit& visit);
    /// Takes a node's cube, its points or the first of them, and the least surface share of a point where no
    /// others are drawn (NodeInfo::area_floor at that prefix; 0 where all points of a cube are visited).
    using EvenVisit = std::function<void(const Cube& cube, const NodeData& data, float floor)>;
    /// Visits an even subsample of at most about `most` points: the coarsest levels, and of the last one the
    /// same share of every node.
    Result<void> visit_even(const SourceHeader& header, uint64_t most, const EvenVisit& visit);
    /// Writes directory, metadata and superblocks, syncs, and gives a new file its name. A directory of at
    /// least `paged.from` nodes can be read in pages of `paged.nodes`.
    Result<void> finish(const SourceHeader& header, const Paged& paged = {1024, 1 << 17});
    /// Call when an update has failed: cuts off what it wrote, unless the switch may have happened.
    void abandon();

    /// Opens what has been appended to a new cache so far.
    Result<InputFile> reader() const { return output_->reader(end_); }

    uint64_t nodes() const { return nodes_; }
    uint64_t bytes() const { return end_; }

 private:
    explicit CacheWriter(ScratchFile entries) : entries_(std::move(entries)) {}
    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> start();
    Result<void> commit(format::Superblock block);
    /// Visits the entries in the order of add().
    Result<void> each_entry(const std::function<void(const format::Entry&)>& visit);
    /// Takes a node that was added, and its points, which may be changed. Returns whether it wants more
    /// nodes.
    using LoadedVisit = std::function<bool(const format::Entry& entry, NodeData& data)>;
    /// Loads these nodes from the unfinished file, one after the other. `header` is that of the new state.
    Result<void> load_each(const SourceHeader& header, std::span<const format::Entry> entries,
                           const LoadedVisit& visit);
    Result<std::vector<format::Entry>> coarsest(uint64_t most);
    Result<void> write_directory();
    Result<DirectoryPages> write_pages(uint64_t directory, uint32_t nodes);

    std::optional<OutputFile> output_;    ///< of a new cache...
    std::optional<UpdateFile> update_;    ///< ...or of one that is updated
    std::optional<SharedOutput> shared_;  ///< ...or of a new one that others write as well
    std::optional<ScratchFile> stage_;    ///< ...or of what is only kept for another
    format::Superblock before_;           ///< the state that an update changes
    size_t next_block_ = 0;               ///< index of the superblock that an update writes
    uint64_t generation_ = 1, begin_ = 0;
    bool switching_ = false;
    uint64_t end_ = 0;     ///< end of what was appended
    ScratchFile entries_;  ///< the nodes in the order of add()
    uint64_t nodes_ = 0, entries_written_ = 0;
    std::array<uint64_t, kMostLevel + 1> per_level_{};
    std::vector<std::byte> buffer_;
};

}  // namespace lucarne::octree
