#include "octree/build/emitter.h"

namespace lucarne::octree {

void Emitter::finish(bool raw, format::Entry& entry, std::vector<std::byte>& payload) {
    entry.codec = raw ? format::kCodecRaw : format::kCodecColumns;
    entry.payload_offset = payload.size();
    if (raw)
        payload.insert(payload.end(), records_.begin(), records_.end());
    else
        encoder_.encode(records_, passes_, payload);
    entry.payload_bytes = static_cast<uint32_t>(payload.size() - entry.payload_offset);
    entry.checksum = format::checksum(std::span(payload).subspan(entry.payload_offset));
}

}  // namespace lucarne::octree
