#pragma once

#include <memory>
#include <mutex>

#include "io/core/recently_used.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Keeps the most recently read nodes of a source, so that points near each other need no further reads.
/// Thread-safe.
class NodeCache {
 public:
    static constexpr uint64_t kMostBytes = uint64_t{32} << 20;  ///< of records; the last node is always kept

    NodeCache() = default;
    explicit NodeCache(std::shared_ptr<const octree::NodeSource> source) : source_(std::move(source)) {}

    const std::shared_ptr<const octree::NodeSource>& source() const { return source_; }
    /// Returns a node's data. Errors: those of NodeSource::load.
    Result<std::shared_ptr<const octree::NodeData>> node(uint32_t index);

 private:
    std::shared_ptr<const octree::NodeSource> source_;
    std::mutex mutex_;
    RecentlyUsed<uint32_t, std::shared_ptr<const octree::NodeData>> kept_;
    uint64_t bytes_ = 0;
};

}  // namespace lucarne::viewer
