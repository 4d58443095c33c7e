#pragma once

#include <vector>

#include "octree/cache/writer.h"
#include "octree/convert/nodes/build_listener.h"
#include "octree/convert/nodes/subtree.h"

namespace lucarne::octree {

/// Assembles subtrees, in Morton order: writes their nodes, and samples a node as soon as all of its children
/// are there. Nodes that wait for their parent are in a scratch file, so that memory holds only one parent
/// with its children at a time. The file is the same wherever the borders of the chunks are.
class Assembler {
 public:
    static Result<Assembler> create(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                                    const std::filesystem::path& temp_folder,
                                    BuildListener* listener = nullptr);

    /// Takes the next subtree in Morton order. `next` is the root of the subtree after it, null at the end.
    Result<void> add(Subtree&& tree, const NodeKey* next);

    /// Call before the first subtree if the subtrees are a part of all: nodes with descendants in other parts
    /// are left to the one who joins the parts. `before`: the root of the subtree before the first one, null
    /// if there is none; it outlives this object.
    void only_a_part(const NodeKey* before) {
        part_ = true;
        before_ = before;
    }
    /// A node of a part whose parent is left to others.
    struct Loose {
        Pending node;
        uint64_t payload_end = 0, nodes = 0;  ///< bytes and nodes that were written before its parent's
    };
    std::vector<Loose> loose() const;
    /// Returns the sample of a loose node. Thread-safe once all subtrees are added.
    Result<std::vector<std::byte>> loose_sample(size_t index) const { return sample_of(stack_[index]); }

    /// CPU time spent on compression, including that of the subtrees.
    double encode_seconds() const { return subtree_encode_seconds_ + emitter_.encode_seconds(); }

 private:
    struct Waiting {
        Pending node;
        uint64_t first = 0;  ///< index of its sample's first record in the scratch file
        uint32_t count = 0;
        uint64_t payload_end = 0, nodes = 0;
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
    bool part_ = false;
    const NodeKey* before_ = nullptr;
    std::vector<Waiting> stack_;
    uint64_t end_ = 0;  ///< records in the scratch file; those after the top of the stack are free
    std::vector<uint32_t> order_;
};

}  // namespace lucarne::octree
