#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "io/core/file.h"
#include "octree/cache_format.h"

namespace lucarne::octree {

/// Writes a fresh cache. Payloads and nodes come in the order in which a depth-first build finishes them: the
/// children of a node together in octant order, subtrees along the Morton curve, the root last. Nodes of one
/// level then come sorted, so the directory needs no sort and memory does not grow with the number of nodes.
class CacheWriter {
 public:
    static Result<CacheWriter> create(const std::filesystem::path& path, bool overwrite,
                                      const std::filesystem::path& temp_folder);

    /// Appends payload bytes and returns where they begin.
    Result<uint64_t> append(std::span<const std::byte> payload);
    Result<void> add(const format::Entry& entry);
    /// Writes directory, metadata and superblocks, syncs, and gives the file its name.
    Result<void> finish(const SourceHeader& header);

    uint64_t nodes() const { return nodes_; }
    uint64_t bytes() const { return output_.position(); }

 private:
    CacheWriter(OutputFile output, ScratchFile entries)
        : output_(std::move(output)), entries_(std::move(entries)) {}
    Result<void> flush_entries();
    Result<uint64_t> write_directory();

    OutputFile output_;
    ScratchFile entries_;  ///< the nodes as they came
    uint64_t nodes_ = 0, entries_written_ = 0;
    std::array<uint64_t, kMostLevel + 1> per_level_{};
    std::vector<std::byte> buffer_;
};

}  // namespace lucarne::octree
