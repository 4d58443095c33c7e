#include "octree/convert/nodes/subtree.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "octree/colours/even_colours.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr size_t kAhead = 24;  ///< how many records ahead memory is asked for

/// Builds one chunk in memory, its points sorted along the Morton curve.
class Builder {
 public:
    Builder(const RecordLoader& loader, const NodeLimits& limits)
        : loader_(loader),
          limits_(limits),
          stride_(loader.schema().stride),
          sampler_(limits, loader.root().first_size()),
          emitter_(loader) {}

    Result<void> load(size_t index, uint64_t count);
    Subtree build();

 private:
    size_t upper_end(size_t first, size_t last, uint64_t code) const {
        return static_cast<size_t>(std::lower_bound(codes_.begin() + static_cast<std::ptrdiff_t>(first),
                                                    codes_.begin() + static_cast<std::ptrdiff_t>(last),
                                                    code) -
                                   codes_.begin());
    }
    Pending build_node(const NodeKey& key, size_t first, size_t last, std::vector<uint32_t>& sample);
    const std::byte* record(uint32_t i) const { return &records_[size_t{i} * stride_]; }

    const RecordLoader& loader_;
    NodeLimits limits_;
    uint32_t stride_;
    NodeKey key_;
    std::vector<std::byte> records_;
    std::vector<uint64_t> codes_;
    std::vector<Place> places_;
    std::vector<float> areas_;
    NodeSampler sampler_;
    Emitter emitter_;
    std::vector<uint32_t> order_;
    Subtree result_;
};

Result<void> Builder::load(size_t index, uint64_t count) {
    key_ = loader_.chunks()[index].key;
    LUCARNE_ASSIGN(const auto input, loader_.load(index, 0, count));
    std::vector<CodeIndex> sorted(count);
    for (uint32_t i = 0; i < count; ++i) sorted[i] = {loader_.place(&input[size_t{i} * stride_]).code(), i};
    sort_by_code(sorted, 3 * (kMaxLevel - key_.cell().level));
    codes_.resize(count);
    places_.resize(count);
    areas_.resize(count);
    records_.resize(count * stride_);
    for (size_t i = 0; i < count; ++i) {
        // Where the input is in no order, each record is somewhere else in a chunk larger than the caches.
        const std::byte* ahead = &input[size_t{sorted[std::min(i + kAhead, count - 1)].index} * stride_];
        __builtin_prefetch(ahead);
        __builtin_prefetch(ahead + stride_ - 1);  // it may lie across two lines
        std::byte* to = &records_[i * stride_];
        std::memcpy(to, &input[size_t{sorted[i].index} * stride_], stride_);
        codes_[i] = sorted[i].code;
        places_[i] = loader_.place(to);
        areas_[i] = loader_.area(to);
    }
    if (!loader_.whites().empty())
        ColourEvening(loader_.schema(), loader_.whites(),
                      static_cast<float>(std::exp2(-2.0 * static_cast<double>(loader_.root().doublings))))
            .even(records_, places_, areas_);
    return {};
}

/// Builds bottom up: a leaf shows its points, an inner node a sample of what its children show.
Pending Builder::build_node(const NodeKey& key, size_t first, size_t last, std::vector<uint32_t>& sample) {
    if (last - first <= limits_.leaf || key.level == kMostLevel) {
        sample.resize(last - first);
        for (size_t i = first; i < last; ++i) sample[i - first] = static_cast<uint32_t>(i);
        const auto root_size = static_cast<double>(uint64_t{1} << loader_.root().doublings);
        const auto part = [&](auto& all) { return std::span(all).subspan(first, last - first); };
        return {key, 0, last - first, surface_of(part(areas_), part(codes_), key.level, root_size)};
    }
    struct Child {
        Pending node;
        std::vector<uint32_t> sample;
    };
    std::vector<Child> children;
    const auto end_of = [&](uint32_t octant, size_t begin) {
        if (key.level >= kMaxLevel) return first + stacked_first(last - first, octant + 1);
        const uint32_t shift = 3 * (kMaxLevel - key.level - 1);
        return upper_end(begin, last, (key.child(octant).code() + 1) << shift);
    };
    for (uint32_t octant = 0, begin = static_cast<uint32_t>(first); octant < 8; ++octant) {
        const NodeKey child = key.child(octant);
        const auto end = static_cast<uint32_t>(end_of(octant, begin));
        if (end > begin) {
            children.emplace_back();
            children.back().node = build_node(child, begin, end, children.back().sample);
        }
        begin = end;
        assert(octant < 7 || end == last);  // every point is in an octant
    }
    sampler_.start(key);
    for (const auto& child : children) {
        for (const uint32_t i : child.sample) sampler_.add(places_[i], areas_[i]);
        sampler_.end_child(child.node);
    }
    sampler_.run();
    sample.clear();
    for (size_t c = 0; c < children.size(); ++c) {
        const auto& from = children[c].sample;
        emitter_.emit(
            sampler_, c, [&](uint32_t i) { return record(from[i]); }, result_.payload, result_.entries);
        sampler_.taken(c, order_);
        for (const uint32_t i : order_) sample.push_back(from[i]);
    }
    return sampler_.parent();
}

Subtree Builder::build() {
    std::vector<uint32_t> sample;
    result_.root = build_node(key_, 0, codes_.size(), sample);
    result_.sample.reserve(sample.size() * stride_);
    for (const uint32_t i : sample)
        result_.sample.insert(result_.sample.end(), record(i), record(i) + stride_);
    result_.encode_seconds = emitter_.encode_seconds();
    return std::move(result_);
}

}  // namespace

double surface_of(std::span<const float> areas, std::span<const uint64_t> codes, uint32_t level,
                  double root_size) {
    assert(areas.size() == codes.size() && std::ranges::is_sorted(codes));
    double sum = 0;
    size_t known = 0;
    for (const float area : areas)
        if (area > 0) sum += area, ++known;
    const auto count = static_cast<double>(areas.size());
    if (known) return sum * count / static_cast<double>(known);
    uint32_t depth = std::min(level + 4, kMaxLevel);  // a single point counts as 1/16 of its cube's width
    const auto cells_at = [&](uint32_t d) {
        const uint32_t shift = 3 * (kMaxLevel - d);
        size_t cells = 1;
        for (size_t i = 1; i < codes.size(); ++i) cells += codes[i] >> shift != codes[i - 1] >> shift;
        return cells;
    };
    size_t cells = cells_at(depth);
    while (depth < kMaxLevel) {
        const size_t finer = cells_at(depth + 1);
        if (4 * finer > codes.size()) break;
        cells = finer;
        ++depth;
    }
    const double width = root_size * std::exp2(-static_cast<double>(depth));
    const double part = std::exp2(-3.0 * static_cast<double>(level - std::min(level, kMaxLevel)));
    return static_cast<double>(cells) * width * width / 1.5 * part;
}

Result<Subtree> build_subtree(const RecordLoader& loader, size_t index, const NodeLimits& limits) {
    Builder builder(loader, limits);
    LUCARNE_TRY(builder.load(index, loader.chunks()[index].count));
    return builder.build();
}

}  // namespace lucarne::octree
