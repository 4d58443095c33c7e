#include "octree/convert/nodes/emitter.h"

#include <ctime>

namespace lucarne::octree {
namespace {

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

bool Emitter::compress(format::Entry& entry, std::vector<std::byte>& payload) {
    const double start = thread_seconds();
    const size_t begin = payload.size();
    rounding_.round(records_);
    encoder_.encode(records_, passes_, payload);
    const bool smaller =
        payload.size() - begin < records_.size() && records_.size() <= codec::kMostRecordBytes;
    if (smaller)
        entry.codec = format::kCodecColumns;
    else
        payload.resize(begin);
    seconds_ += thread_seconds() - start;
    return smaller;
}

}  // namespace lucarne::octree
