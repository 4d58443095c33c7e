#include <flann/flann.hpp>

#include "octree/normals/point_index.h"

namespace lucarne::octree {
namespace {

/// A FLANN result set over a caller's sorted array, so that a second index can go on where the first ended.
class MergingResult final : public flann::ResultSet<double> {
 public:
    MergingResult(std::span<Neighbour> nearest, size_t found, uint32_t offset, double limit2,
                  const PointIndex::Wanted* wanted = nullptr)
        : nearest_(nearest), found_(found), offset_(offset), limit2_(limit2), wanted_(wanted) {
        update_worst();
    }
    bool full() const override { return found_ == nearest_.size(); }
    double worstDist() const override { return worst_; }
    void addPoint(double distance2, size_t index) override {
        if (!(distance2 < worst_)) return;
        if (wanted_ && !(*wanted_)(static_cast<uint32_t>(index))) return;
        if (!full()) ++found_;
        size_t at = found_ - 1;
        for (; at > 0 && nearest_[at - 1].distance2 > distance2; --at) nearest_[at] = nearest_[at - 1];
        nearest_[at] = {distance2, static_cast<uint32_t>(index) + offset_};
        update_worst();
    }
    size_t found() const { return found_; }

 private:
    void update_worst() { worst_ = full() ? nearest_.back().distance2 : limit2_; }
    std::span<Neighbour> nearest_;
    size_t found_;
    uint32_t offset_;
    double limit2_, worst_ = 0;
    const PointIndex::Wanted* wanted_;
};

flann::Matrix<double> matrix_of(std::span<const glm::dvec3> points) {
    static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
    // FLANN's matrix has no const form; the tree copies the points and never writes them.
    return {const_cast<double*>(&points.data()->x), points.size(), 3};
}

}  // namespace

struct PointIndex::Tree {
    explicit Tree(std::span<const glm::dvec3> points) : index(matrix_of(points)) { index.buildIndex(); }
    flann::KDTreeSingleIndex<flann::L2_3D<double>> index;
};

PointIndex::PointIndex() = default;
PointIndex::PointIndex(std::span<const glm::dvec3> points) {
    if (!points.empty()) tree_ = std::make_unique<Tree>(points);
}
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;
PointIndex::~PointIndex() = default;

size_t PointIndex::merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                                 uint32_t offset, double limit2) const {
    if (!tree_ || nearest.empty()) return found;
    MergingResult result(nearest, found, offset, limit2);
    tree_->index.findNeighbors(result, &query.x, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    return result.found();
}

size_t PointIndex::merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                                 uint32_t offset, double limit2, const Wanted& wanted) const {
    if (!tree_ || nearest.empty()) return found;
    MergingResult result(nearest, found, offset, limit2, &wanted);
    tree_->index.findNeighbors(result, &query.x, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    return result.found();
}

}  // namespace lucarne::octree
