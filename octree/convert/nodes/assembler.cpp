#include "octree/convert/nodes/assembler.h"

#include <cassert>

namespace lucarne::octree {
namespace {

bool is_ancestor(const NodeKey& above, const NodeKey& key) {
    const uint32_t levels = key.level - above.level;
    return above.level < key.level && key.x >> levels == above.x && key.y >> levels == above.y &&
           key.z >> levels == above.z;
}

}  // namespace

Result<Assembler> Assembler::create(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                                    const std::filesystem::path& temp_folder, BuildListener* listener) {
    LUCARNE_ASSIGN(ScratchFile samples, ScratchFile::create(temp_folder));
    return Assembler(writer, loader, limits, std::move(samples), listener);
}

Assembler::Assembler(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                     ScratchFile samples, BuildListener* listener)
    : writer_(writer),
      loader_(loader),
      stride_(loader.schema().stride),
      sampler_(limits, loader.root().first_size()),
      emitter_(loader),
      samples_(std::move(samples)),
      listener_(listener) {}

Result<void> Assembler::add(Subtree&& tree, const NodeKey* next) {
    {
        Subtree done = std::move(tree);  // freed before the sampling above it starts
        subtree_encode_seconds_ += done.encode_seconds;
        LUCARNE_ASSIGN(const uint64_t base, writer_.append(done.payload));
        for (auto& entry : done.entries) {
            entry.payload_offset += base;
            LUCARNE_TRY(writer_.add(entry));
        }
        if (listener_) listener_->settled(done.entries);
        LUCARNE_TRY(push(done.root, done.sample));
    }
    while (stack_.back().node.key.level > 0) {
        const NodeKey parent = stack_.back().node.key.parent();
        if (next && is_ancestor(parent, *next)) return {};
        if (before_ && is_ancestor(parent, *before_)) return {};
        size_t children = 1;
        while (children < stack_.size()) {
            const NodeKey& key = stack_[stack_.size() - children - 1].node.key;
            if (key.level != parent.level + 1 || key.parent() != parent) break;
            ++children;
        }
        LUCARNE_TRY(join(children));
    }
    return part_ ? Result<void>() : finish_root();
}

std::vector<Assembler::Loose> Assembler::loose() const {
    std::vector<Loose> loose;
    for (const Waiting& waiting : stack_) loose.push_back({waiting.node, waiting.payload_end, waiting.nodes});
    return loose;
}

Result<void> Assembler::push(Pending node, std::span<const std::byte> sample) {
    LUCARNE_TRY(samples_.write_at(end_ * stride_, sample));
    const auto count = static_cast<uint32_t>(sample.size() / stride_);
    stack_.push_back({node, end_, count, writer_.bytes(), writer_.nodes()});
    end_ += count;
    if (listener_) listener_->pending(node, sample, writer_);
    return {};
}

Result<std::vector<std::byte>> Assembler::sample_of(const Waiting& waiting) const {
    std::vector<std::byte> records(size_t{waiting.count} * stride_);
    LUCARNE_TRY(samples_.read_at(waiting.first * stride_, records));
    return records;
}

/// Replaces the last `children` nodes of the stack by their parent.
Result<void> Assembler::join(size_t children) {
    const std::vector<Waiting> family(stack_.end() - static_cast<std::ptrdiff_t>(children), stack_.end());
    sampler_.start(family[0].node.key.parent());
    for (const auto& child : family) {
        LUCARNE_ASSIGN(const auto records, sample_of(child));
        for (size_t at = 0; at < records.size(); at += stride_)
            sampler_.add(loader_.place(&records[at]), loader_.area(&records[at]));
        sampler_.end_child(child.node);
    }
    sampler_.run();
    std::vector<std::byte> sample;
    for (size_t c = 0; c < children; ++c) {
        LUCARNE_ASSIGN(const auto records, sample_of(family[c]));
        LUCARNE_TRY(emit(c, records));
        sampler_.taken(c, order_);
        for (const uint32_t i : order_)
            sample.insert(sample.end(), &records[size_t{i} * stride_],
                          &records[size_t{i} * stride_] + stride_);
    }
    stack_.resize(stack_.size() - children);
    end_ = family[0].first;
    return push(sampler_.parent(), sample);
}

Result<void> Assembler::finish_root() {
    assert(stack_.size() == 1 && stack_.back().node.key == NodeKey{});
    const Waiting root = stack_.back();
    LUCARNE_ASSIGN(const auto records, sample_of(root));
    sampler_.start(root.node.key);
    for (size_t at = 0; at < records.size(); at += stride_)
        sampler_.add(loader_.place(&records[at]), loader_.area(&records[at]));
    sampler_.end_child(root.node);
    sampler_.run_root();
    return emit(0, records);
}

Result<void> Assembler::emit(size_t child, const std::vector<std::byte>& sample) {
    std::vector<std::byte> payload;
    std::vector<format::Entry> entries;
    emitter_.emit(
        sampler_, child, [&](uint32_t i) { return &sample[size_t{i} * stride_]; }, payload, entries);
    LUCARNE_ASSIGN(const uint64_t base, writer_.append(payload));
    for (auto& entry : entries) {  // one, or none if the parent took every point
        entry.payload_offset = base;
        LUCARNE_TRY(writer_.add(entry));
    }
    if (listener_) listener_->settled(entries);
    return {};
}

}  // namespace lucarne::octree
