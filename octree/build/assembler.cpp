#include "octree/build/assembler.h"

#include <limits>
#include <memory>

#include <fmt/format.h>
#include <xxhash.h>

namespace lucarne::octree {
namespace {

constexpr uint64_t kOverflowBytes = 1 << 20;

bool is_ancestor(const NodeKey& above, const NodeKey& key) {
    const uint32_t levels = key.level - above.level;
    return above.level < key.level && key.x >> levels == above.x && key.y >> levels == above.y &&
           key.z >> levels == above.z;
}

}  // namespace

Result<Assembler> Assembler::create(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                                    const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(ScratchFile samples, ScratchFile::create(temp_folder));
    return Assembler(writer, loader, limits, std::move(samples));
}

Assembler::Assembler(CacheWriter& writer, const RecordLoader& loader, const NodeLimits& limits,
                     ScratchFile samples)
    : writer_(writer),
      loader_(loader),
      stride_(loader.schema().stride),
      sampler_(limits),
      samples_(std::move(samples)) {}

Result<void> Assembler::add(size_t index, Subtree&& tree) {
    {
        const Subtree done = std::move(tree);  // gone before the sampling above it starts
        LUCARNE_ASSIGN(const uint64_t base, writer_.append(done.payload));
        for (auto entry : done.entries) {
            entry.payload_offset += base;
            LUCARNE_TRY(writer_.add(entry));
        }
        std::optional<size_t> overflow;
        if (done.overflow_first < loader_.chunks()[index].count) overflow = index;
        LUCARNE_TRY(push(done.root, done.sample, overflow, done.overflow_first));
    }
    const auto chunks = loader_.chunks();
    while (stack_.back().node.key.level > 0) {
        const NodeKey parent = stack_.back().node.key.parent();
        if (index + 1 < chunks.size() && is_ancestor(parent, chunks[index + 1].key)) return {};
        size_t children = 1;
        while (children < stack_.size()) {
            const NodeKey& key = stack_[stack_.size() - children - 1].node.key;
            if (key.level != parent.level + 1 || key.parent() != parent) break;
            ++children;
        }
        LUCARNE_TRY(join(children));
    }
    return finish_root();
}

Result<void> Assembler::push(Pending node, std::span<const std::byte> sample, std::optional<size_t> chunk,
                             uint64_t overflow_first) {
    LUCARNE_TRY(samples_.write_at(end_ * stride_, sample));
    const auto count = static_cast<uint32_t>(sample.size() / stride_);
    stack_.push_back({node, end_, count, chunk, overflow_first});
    end_ += count;
    return {};
}

Result<std::vector<std::byte>> Assembler::sample_of(const Waiting& waiting) const {
    std::vector<std::byte> records(size_t{waiting.count} * stride_);
    LUCARNE_TRY(samples_.read_at(waiting.first * stride_, records));
    return records;
}

/// The last `children` of the stack become their parent.
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
        LUCARNE_TRY(emit(c, family[c], records));
        sampler_.taken(c, order_);
        for (const uint32_t i : order_)
            sample.insert(sample.end(), &records[size_t{i} * stride_],
                          &records[size_t{i} * stride_] + stride_);
    }
    stack_.resize(stack_.size() - children);
    end_ = family[0].first;
    return push(sampler_.parent(), sample, std::nullopt, 0);
}

Result<void> Assembler::finish_root() {
    const Waiting root = stack_.back();
    LUCARNE_ASSIGN(const auto records, sample_of(root));
    sampler_.start(root.node.key);
    for (size_t at = 0; at < records.size(); at += stride_)
        sampler_.add(loader_.place(&records[at]), loader_.area(&records[at]));
    sampler_.end_child(root.node);
    sampler_.run_root();
    return emit(0, root, records);
}

Result<void> Assembler::emit(size_t child, const Waiting& from, const std::vector<std::byte>& sample) {
    std::vector<std::byte> payload;
    std::vector<format::Entry> entries;
    emit_child(
        sampler_, child, stride_, order_, [&](uint32_t i) { return &sample[size_t{i} * stride_]; }, payload,
        entries);
    LUCARNE_ASSIGN(const uint64_t base, writer_.append(payload));
    for (auto& entry : entries) {  // one, or none where the parent took every point
        entry.payload_offset = base;
        if (from.overflow_chunk) LUCARNE_TRY(append_overflow(from, payload, entry));
        LUCARNE_TRY(writer_.add(entry));
    }
    return {};
}

/// The points of one place that never were in memory follow the node's own, in their order.
Result<void> Assembler::append_overflow(const Waiting& from, std::span<const std::byte> payload,
                                        format::Entry& entry) {
    const uint64_t last = loader_.chunks()[*from.overflow_chunk].count;
    const uint64_t count = entry.count + (last - from.overflow_first);
    if (count * stride_ > std::numeric_limits<uint32_t>::max())
        return failed("points", fmt::format("{} of them share one place, more than a node holds", count),
                      "thin out the input");
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_64bits_reset(state.get());
    XXH3_64bits_update(state.get(), payload.data(), payload.size());
    const uint64_t most = std::max<uint64_t>(1, kOverflowBytes / stride_);
    for (uint64_t first = from.overflow_first; first < last; first += most) {
        LUCARNE_ASSIGN(const auto records,
                       loader_.load(*from.overflow_chunk, first, std::min(most, last - first)));
        LUCARNE_ASSIGN([[maybe_unused]] const uint64_t at, writer_.append(records));
        XXH3_64bits_update(state.get(), records.data(), records.size());
    }
    entry.count = static_cast<uint32_t>(count);
    entry.payload_bytes = static_cast<uint32_t>(count * stride_);
    entry.checksum = XXH3_64bits_digest(state.get());
    return {};
}

}  // namespace lucarne::octree
