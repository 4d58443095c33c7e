#include "octree/convert/sampling/sampler.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace lucarne::octree {
namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr float kFree = std::numeric_limits<float>::infinity();
/// Ratio of the radius of a pass to that of the previous pass. The number of points that fit grows by the
/// inverse square, 1.56.
constexpr float kRadiusStep = 0.8f;
/// How many pieces of the curve tell how many points a radius takes, and one of how many points is in them.
/// Short pieces would take more than their share, because nothing outside is in their way.
constexpr size_t kPieces = 8, kPieceShare = 8, kLeastPiece = 512;
constexpr double kTolerance = 1.05;  ///< of that number

}  // namespace

void Sampler::start(const NodeKey& key) {
    const NodeKey node = key.cell();
    const auto corner = [&](uint32_t cell) {
        return static_cast<uint32_t>(uint64_t{cell} << (32 - node.level));
    };
    origin_ = {corner(node.x), corner(node.y), corner(node.z)};
    scale_ = std::exp2(static_cast<float>(node.level) - 32.0f);
    points_.clear();
}

void Sampler::add(const Place& place) {
    const auto local = [&](uint32_t v, uint32_t origin) { return static_cast<float>(v - origin) * scale_; };
    // Rounding may move a point onto the cube's upper face.
    assert(local(place.x, origin_.x) <= 1 && local(place.y, origin_.y) <= 1 &&
           local(place.z, origin_.z) <= 1);
    points_.push_back(
        {local(place.x, origin_.x), local(place.y, origin_.y), local(place.z, origin_.z), kNone});
}

void Sampler::reset_grid(float radius) {
    radius2_ = radius * radius;
    cells_ = 1 / (2 * radius);  // a cell is two radii wide: conflicts are in the nearest 2 x 2 x 2 cells
    std::fill(heads_.begin(), heads_.end(), kNone);
}

/// Hashes a cell. Two cells in one bucket cost a few more distances and change nothing else.
inline size_t Sampler::bucket(int32_t x, int32_t y, int32_t z) const {
    return (static_cast<uint32_t>(x) + static_cast<uint32_t>(y) * 0x9e3779b1u +
            static_cast<uint32_t>(z) * 0x85ebca77u) &
           mask_;
}

inline void Sampler::insert(uint32_t index) {
    Point& p = points_[index];
    const auto cell = [this](float v) { return static_cast<int32_t>(v * cells_); };
    uint32_t& head = heads_[bucket(cell(p.x), cell(p.y), cell(p.z))];
    p.next = head;
    head = index;
}

inline float Sampler::conflict_in(uint32_t first, const Point& p) const {
    for (uint32_t i = first; i != kNone;) {
        const Point& q = points_[i];
        const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
        const float distance2 = dx * dx + dy * dy + dz * dz;
        if (distance2 < radius2_) return distance2;
        i = q.next;
    }
    return kFree;
}

inline float Sampler::conflict_around(const Point& p) const {
    // The point's own cell comes first, where most conflicts are. The other nearest cell of each axis is the
    // one beyond the nearer face.
    const auto own = [this](float v) { return static_cast<int32_t>(v * cells_); };
    const auto other = [this](float v, int32_t cell) {
        return v * cells_ - static_cast<float>(cell) < 0.5f ? cell - 1 : cell + 1;
    };
    const int32_t x = own(p.x), y = own(p.y), z = own(p.z);
    const float in_own = conflict_in(heads_[bucket(x, y, z)], p);
    if (in_own != kFree) return in_own;
    const int32_t x2 = other(p.x, x), y2 = other(p.y, y), z2 = other(p.z, z);
    std::array<uint32_t, 8> heads;
    uint32_t filled = 0;  // most buckets are empty, in no order that a processor could predict
    for (uint32_t corner = 1; corner < 8; ++corner) {
        heads[corner] = heads_[bucket(corner & 1 ? x2 : x, corner & 2 ? y2 : y, corner & 4 ? z2 : z)];
        filled |= static_cast<uint32_t>(heads[corner] != kNone) << corner;
    }
    for (; filled != 0; filled &= filled - 1) {
        const float found = conflict_in(heads[static_cast<size_t>(std::countr_zero(filled))], p);
        if (found != kFree) return found;
    }
    return kFree;
}

void Sampler::take(std::vector<uint32_t>& from, std::vector<uint32_t>& rest, uint8_t pass) {
    size_t kept = 0;
    for (const uint32_t i : from) {
        if (blocked_[i] >= radius2_) blocked_[i] = conflict_around(points_[i]);
        if (blocked_[i] == kFree) {
            insert(i);
            taken_.push_back(i);
            passes_[i] = pass;
        } else {
            rest[kept++] = i;
        }
    }
    rest.resize(kept);
}

/// Returns the factor by which the radius grows if so many points are taken.
float Sampler::widening(size_t taken, size_t most) {
    const auto excess = static_cast<float>(taken) / static_cast<float>(most);
    return std::max(1.1f, std::min(std::sqrt(excess), 1.15f * std::cbrt(excess)));
}

/// Returns the radius at which about `most` points will be taken, or the given one if that is larger. It
/// follows from pieces of the curve, because a run over all points at too small a radius is wasted.
float Sampler::wide_enough(float radius, size_t most) {
    const size_t count = points_.size(), piece = count / (kPieces * kPieceShare);
    if (piece < kLeastPiece) return radius;
    for (;;) {
        reset_grid(radius);
        taken_.clear();
        for (size_t k = 0; k < kPieces; ++k) {
            waiting_.resize(piece);
            std::iota(waiting_.begin(), waiting_.end(), static_cast<uint32_t>(k * count / kPieces));
            take(waiting_, waiting_, 0);
        }
        blocked_.assign(count, kFree);
        const size_t expected = taken_.size() * count / (kPieces * piece);
        if (static_cast<double>(expected) <= kTolerance * static_cast<double>(most)) return radius;
        radius *= widening(expected, most);
    }
}

void Sampler::run(float radius, size_t most) {
    assert(radius > 0 && (most > 0 || points_.empty()));
    const auto count = static_cast<uint32_t>(points_.size());
    passes_.assign(count, kLastPass);
    blocked_.assign(count, kFree);
    heads_.resize(std::bit_ceil(std::max<size_t>(count, 64)));
    mask_ = heads_.size() - 1;
    radius = wide_enough(radius, most);
    passes_.assign(count, kLastPass);
    waiting_.resize(count);
    std::iota(waiting_.begin(), waiting_.end(), 0u);

    taken_.clear();
    reset_grid(radius);
    take(waiting_, waiting_, 0);
    const bool thinning = taken_.size() > most;
    while (taken_.size() > most) {  // a volume instead of a surface, or many layers: widens the radius
        radius *= widening(taken_.size(), most);
        thinned_.swap(taken_);
        taken_.clear();
        reset_grid(radius);
        std::vector<uint32_t> out(thinned_.size());
        take(thinned_, out, 0);
        for (const uint32_t i : out) passes_[i] = kLastPass;
        const size_t before = waiting_.size();
        waiting_.insert(waiting_.end(), out.begin(), out.end());
        std::inplace_merge(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(before),
                           waiting_.end());
    }
    assert(std::ranges::is_sorted(waiting_));     // the result depends on the order alone
    if (thinning) blocked_.assign(count, kFree);  // the points that blocked them may have been removed
    for (uint8_t pass = 1; pass < kLastPass && !waiting_.empty(); ++pass) {
        radius *= kRadiusStep;
        reset_grid(radius);
        for (const uint32_t i : taken_) insert(i);
        take(waiting_, waiting_, pass);
    }
}

}  // namespace lucarne::octree
