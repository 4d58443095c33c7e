#include "octree/build/emitter.h"

namespace lucarne::octree {

bool Emitter::compress(format::Entry& entry, std::vector<std::byte>& payload) {
    const size_t begin = payload.size();
    encoder_.encode(records_, passes_, payload);
    const bool smaller =
        payload.size() - begin < records_.size() && records_.size() <= codec::kMostRecordBytes;
    if (smaller)
        entry.codec = format::kCodecColumns;
    else
        payload.resize(begin);
    return smaller;
}

}  // namespace lucarne::octree
