#include <algorithm>
#include <cmath>
#include <limits>

#include <flann/flann.hpp>

#include "octree/normals/neighbours/point_index.h"

namespace lucarne::octree {
namespace {

/// A FLANN result set over a caller's sorted array, so that a second index can continue where the first
/// ended.
class MergingResult final : public flann::ResultSet<double> {
 public:
    MergingResult(std::span<Neighbour> nearest, size_t found, uint32_t offset)
        : nearest_(nearest), found_(found), offset_(offset) {
        update_worst();
    }
    bool full() const override { return found_ == nearest_.size(); }
    double worstDist() const override { return worst_; }
    void addPoint(double distance2, size_t index) override {
        if (!(distance2 < worst_)) return;
        if (!full()) ++found_;
        size_t at = found_ - 1;
        for (; at > 0 && nearest_[at - 1].distance2 > distance2; --at) nearest_[at] = nearest_[at - 1];
        nearest_[at] = {distance2, static_cast<uint32_t>(index) + offset_};
        update_worst();
    }
    size_t found() const { return found_; }

 private:
    void update_worst() { worst_ = full() ? nearest_.back().distance2 : std::numeric_limits<double>::max(); }
    std::span<Neighbour> nearest_;
    size_t found_;
    uint32_t offset_;
    double worst_ = 0;
};

/// A FLANN result set that takes all points within a radius.
class AllWithin final : public flann::ResultSet<double> {
 public:
    AllWithin(double limit2, std::vector<uint32_t>& found) : limit2_(limit2), found_(found) {}
    bool full() const override { return true; }
    double worstDist() const override { return limit2_; }
    void addPoint(double distance2, size_t index) override {
        if (distance2 <= limit2_) found_.push_back(static_cast<uint32_t>(index));
    }

 private:
    double limit2_;
    std::vector<uint32_t>& found_;
};

class FlannIndex final : public PointIndex {
 public:
    explicit FlannIndex(const PointArrays& points)
        : points_(points), interleaved_(interleave(points)), tree_(matrix()) {
        tree_.buildIndex();
    }
    size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                         uint32_t offset) const override {
        if (nearest.empty()) return found;
        MergingResult result(nearest, found, offset);
        tree_.findNeighbors(result, &query.x, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
        return result.found();
    }
    bool gather(const Box& box, double radius, uint32_t offset, size_t most, Tile& tile) const override {
        const glm::dvec3 centre = (box.min + box.max) * 0.5, half = (box.max - box.min) * 0.5;
        const double reach = radius + std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z);
        std::vector<uint32_t> found;
        AllWithin result(reach * reach * (1 + 1e-9), found);
        tree_.findNeighbors(result, &centre.x, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
        std::sort(found.begin(), found.end());
        const glm::vec3 everywhere(std::numeric_limits<float>::max() / 4);
        for (const uint32_t i : found) {
            tile.append(points_, i, i + 1, offset, -everywhere, everywhere, 0);
            if (tile.count > most) return false;
        }
        return true;
    }

 private:
    static std::vector<double> interleave(const PointArrays& points) {
        std::vector<double> interleaved;
        interleaved.reserve(3 * points.size());
        for (size_t i = 0; i < points.size(); ++i)
            interleaved.insert(interleaved.end(), {points.x[i], points.y[i], points.z[i]});
        return interleaved;
    }
    flann::Matrix<double> matrix() { return {interleaved_.data(), points_.size(), 3}; }

    const PointArrays& points_;
    std::vector<double> interleaved_;
    flann::KDTreeSingleIndex<flann::L2_3D<double>> tree_;
};

}  // namespace

std::unique_ptr<PointIndex> make_flann_index(const PointArrays& points) {
    return std::make_unique<FlannIndex>(points);
}

}  // namespace lucarne::octree
