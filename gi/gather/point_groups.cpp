#include "gi/gather/point_groups.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace lucarne::gi {
namespace {

constexpr size_t kDimensions = 6;
/// A group may be this share of the reach wide, about twice as wide as the nodes that are drawn. Narrower
/// groups have fewer points each, in wider ones a node has other pixels for each point: a fifth to two fifths
/// take about the same time.
constexpr float kWidest = 0.35f;
/// So many points and fewer are cut at their largest gap, if that is more than this share of their extent.
constexpr size_t kFewPoints = 1024;
constexpr float kGap = 0.25f;

/// Where a point is among others: its place, and where the axis of its picture points.
using Key = std::array<float, kDimensions>;

class Division {
 public:
    Division(std::span<const GatherPoint> points, float reach) : widest_(kWidest * reach) {
        keys_.reserve(points.size());
        for (const GatherPoint& p : points)
            keys_.push_back({p.position.x, p.position.y, p.position.z, reach * p.axis.x, reach * p.axis.y,
                             reach * p.axis.z});
        groups_.order.resize(points.size());
        std::iota(groups_.order.begin(), groups_.order.end(), 0u);
    }
    PointGroups run() && {
        if (!keys_.empty()) divide(0, keys_.size());
        groups_.first.push_back(static_cast<uint32_t>(keys_.size()));
        return split_small(groups_);
    }

 private:
    void divide(size_t first, size_t last) {
        const auto [d, extent] = longest(first, last);
        const size_t count = last - first;
        if (count == 1 || (count <= kGroupedPoints && extent <= widest_)) {
            groups_.first.push_back(static_cast<uint32_t>(first));
            return;
        }
        const bool near = extent <= widest_ || count > kFewPoints;
        const size_t cut = near ? cut_in_middle(first, last, d) : cut_at_gap(first, last, d, extent);
        divide(first, cut);
        divide(cut, last);
    }
    /// Returns the dimension in which points are farthest apart, and how far.
    std::pair<size_t, float> longest(size_t first, size_t last) const {
        Key low = keys_[groups_.order[first]], high = low;
        for (size_t i = first; i < last; ++i)
            for (size_t d = 0; d < kDimensions; ++d) {
                low[d] = std::min(low[d], keys_[groups_.order[i]][d]);
                high[d] = std::max(high[d], keys_[groups_.order[i]][d]);
            }
        size_t longest = 0;
        for (size_t d = 1; d < kDimensions; ++d)
            if (high[d] - low[d] > high[longest] - low[longest]) longest = d;
        return {longest, high[longest] - low[longest]};
    }
    auto before(size_t d) const {
        return [this, d](uint32_t a, uint32_t b) {
            return std::tuple(keys_[a][d], a) < std::tuple(keys_[b][d], b);
        };
    }
    auto at(size_t i) { return groups_.order.begin() + static_cast<std::ptrdiff_t>(i); }
    /// Returns the middle, in whole groups.
    static size_t middle(size_t first, size_t last) {
        const size_t groups = (last - first + kGroupedPoints - 1) / kGroupedPoints;
        return first + std::max<size_t>(1, groups / 2 * kGroupedPoints);
    }
    size_t cut_in_middle(size_t first, size_t last, size_t d) {
        const size_t cut = middle(first, last);
        std::nth_element(at(first), at(cut), at(last), before(d));
        return cut;
    }
    size_t cut_at_gap(size_t first, size_t last, size_t d, float extent) {
        std::sort(at(first), at(last), before(d));
        size_t cut = first + 1;
        float gap = -1;
        for (size_t i = first + 1; i < last; ++i) {
            const float own = keys_[groups_.order[i]][d] - keys_[groups_.order[i - 1]][d];
            if (own > gap) gap = own, cut = i;
        }
        return gap > kGap * extent || last - first <= kGroupedPoints ? cut : middle(first, last);
    }

    /// Returns large groups, and behind them the points of small ones one by one.
    static PointGroups split_small(const PointGroups& groups) {
        PointGroups result;
        std::vector<uint32_t> single;
        for (size_t group = 0; group + 1 < groups.first.size(); ++group) {
            const auto begin = groups.order.begin() + groups.first[group];
            const auto end = groups.order.begin() + groups.first[group + 1];
            if (static_cast<size_t>(end - begin) < kLeastGroup) {
                single.insert(single.end(), begin, end);
                continue;
            }
            result.first.push_back(static_cast<uint32_t>(result.order.size()));
            result.order.insert(result.order.end(), begin, end);
        }
        result.full = result.first.size();
        for (const uint32_t point : single) {
            result.first.push_back(static_cast<uint32_t>(result.order.size()));
            result.order.push_back(point);
        }
        result.first.push_back(static_cast<uint32_t>(result.order.size()));
        return result;
    }

    std::vector<Key> keys_;
    float widest_;
    PointGroups groups_;
};

}  // namespace

PointGroups group_points(std::span<const GatherPoint> points, float reach) {
    return Division(points, reach).run();
}

}  // namespace lucarne::gi
