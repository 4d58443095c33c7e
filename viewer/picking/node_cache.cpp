#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

Result<std::shared_ptr<const octree::NodeData>> NodeCache::node(uint32_t index) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = places_.find(index); found != places_.end()) {
            kept_.splice(kept_.begin(), kept_, found->second);
            return kept_.front().data;
        }
    }
    LUCARNE_ASSIGN(octree::NodeData read, source_->load(index));
    auto data = std::make_shared<const octree::NodeData>(std::move(read));
    const std::lock_guard lock(mutex_);
    if (places_.contains(index)) return data;  // another thread read it meanwhile
    kept_.push_front({index, data});
    places_[index] = kept_.begin();
    bytes_ += data->records.size();
    while (bytes_ > kMostBytes && kept_.size() > 1) {
        bytes_ -= kept_.back().data->records.size();
        places_.erase(kept_.back().node);
        kept_.pop_back();
    }
    return data;
}

}  // namespace lucarne::viewer
