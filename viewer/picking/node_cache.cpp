#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

Result<std::shared_ptr<const octree::NodeData>> NodeCache::node(uint32_t index) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto* kept = kept_.find(index)) return *kept;
    }
    LUCARNE_ASSIGN(octree::NodeData read, source_->load(index));
    auto data = std::make_shared<const octree::NodeData>(std::move(read));
    const std::lock_guard lock(mutex_);
    if (const auto* kept = kept_.find(index)) return *kept;  // another thread has read it meanwhile
    kept_.add(index, data);
    bytes_ += data->records.size();
    while (bytes_ > kMostBytes && kept_.size() > 1) bytes_ -= kept_.take_oldest()->records.size();
    return data;
}

}  // namespace lucarne::viewer
