#pragma once

#include <memory>
#include <mutex>

#include "io/core/recently_used.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// The nodes of a source that were read last, so that neighbours of a point cost nothing. Thread-safe.
class NodeCache {
 public:
    static constexpr uint64_t kMostBytes = uint64_t{32}
                                           << 20;  ///< of records; the last node is kept in any case

    NodeCache() = default;
    explicit NodeCache(std::shared_ptr<const octree::NodeSource> source) : source_(std::move(source)) {}

    const std::shared_ptr<const octree::NodeSource>& source() const { return source_; }
    /// Errors: those of NodeSource::load.
    Result<std::shared_ptr<const octree::NodeData>> node(uint32_t index);

 private:
    std::shared_ptr<const octree::NodeSource> source_;
    std::mutex mutex_;
    RecentlyUsed<uint32_t, std::shared_ptr<const octree::NodeData>> kept_;
    uint64_t bytes_ = 0;
};

}  // namespace lucarne::viewer
