#pragma once

#include <vector>

#include "octree/cache/writer.h"
#include "octree/convert/nodes/build_listener.h"
#include "octree/convert/nodes/subtree.h"

namespace lucarne::octree {

/// Puts subtrees together, in Morton order: writes their nodes, and as soon as all children of a node are
/// there samples it from them. What waits for its parent lies in a scratch file, so that memory holds one
/// family at a time. The file comes out the same wherever the chunks' borders were.
class Assembler {
 public:
    static Result<Assembler> create(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                                    const std::filesystem::path& temp_folder,
                                    BuildListener* listener = nullptr);

    /// Takes the next subtree in Morton order; `next` is the root of the one after it, null at the end.
    Result<void> add(Subtree&& tree, const NodeKey* next);

    /// CPU time spent on compressing, in the subtrees taken as well.
    double encode_seconds() const { return subtree_encode_seconds_ + emitter_.encode_seconds(); }

 private:
    struct Waiting {
        Pending node;
        uint64_t first = 0;  ///< its sample's first record in the scratch file
        uint32_t count = 0;
    };
    Assembler(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits, ScratchFile samples,
              BuildListener* listener);
    Result<void> push(Pending node, std::span<const std::byte> sample);
    Result<void> join(size_t children);
    Result<void> finish_root();
    Result<void> emit(size_t child, const std::vector<std::byte>& sample);
    Result<std::vector<std::byte>> sample_of(const Waiting& waiting) const;

    CacheWriter& writer_;
    const RecordLoader& loader_;
    uint32_t stride_;
    NodeSampler sampler_;
    Emitter emitter_;
    double subtree_encode_seconds_ = 0;
    ScratchFile samples_;
    BuildListener* listener_;
    std::vector<Waiting> stack_;
    uint64_t end_ = 0;  ///< records in the scratch file; those behind the top of the stack are free again
    std::vector<uint32_t> order_;
};

}  // namespace lucarne::octree
