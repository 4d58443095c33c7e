#include "tests/octree/normals/pcl_normals.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include <glm/common.hpp>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/search.h>

#include "octree/normals/neighbours/leaf_index.h"
#include "octree/normals/neighbours/neighbours.h"
#include "octree/normals/neighbours/one_chunk.h"

namespace lucarne::octree {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Search = pcl::search::Search<pcl::PointXYZ>;

/// Our neighbour search behind PCL's interface. Estimators ask for the nearest of the cloud's own points one
/// by one and in their own order, so the first request finds those of all points at once. Other positions are
/// searched one by one.
class LeafSearch final : public Search {
 public:
    LeafSearch() : Search("leaves along a Morton curve", true) {}

    using Search::nearestKSearch;
    using Search::radiusSearch;

    void setInputCloud(const Cloud::ConstPtr& cloud, const pcl::IndicesConstPtr& indices) override {
        Search::setInputCloud(cloud, indices);
        table_.clear();
        asked_ = 0;
        index_.reset();
    }
    int nearestKSearch(const Cloud& cloud, pcl::index_t index, int k, pcl::Indices& found,
                       std::vector<float>& distances) const override {
        const auto own = static_cast<size_t>(index);
        if (&cloud != input_.get() || !has_table(k)) return nearestKSearch(cloud[own], k, found, distances);
        const auto row = std::span(table_).subspan(own * asked_, static_cast<size_t>(k));
        found.resize(row.size());
        distances.resize(row.size());
        size_t count = 0;
        for (; count < row.size() && row[count].index != kNone; ++count) {
            found[count] = static_cast<pcl::index_t>(row[count].index);
            distances[count] = row[count].distance2;
        }
        found.resize(count);
        distances.resize(count);
        return static_cast<int>(count);
    }
    int nearestKSearch(const pcl::PointXYZ& point, int k, pcl::Indices& found,
                       std::vector<float>& distances) const override {
        std::vector<Neighbour> nearest(static_cast<size_t>(std::max(0, k)));
        nearest.resize(index().merge_nearest({point.x, point.y, point.z}, nearest, 0, 0));
        found.clear();
        distances.clear();
        for (const auto& n : nearest) {
            found.push_back(static_cast<pcl::index_t>(order_[n.index]));
            distances.push_back(static_cast<float>(n.distance2));
        }
        return static_cast<int>(found.size());
    }
    int radiusSearch(const pcl::PointXYZ& point, double radius, pcl::Indices& found,
                     std::vector<float>& distances, unsigned most) const override {
        const glm::dvec3 at(point.x, point.y, point.z);
        Tile tile;
        tile.clear(at);
        index().gather({at, at}, radius, 0, input_->size(), tile);
        Patch patch, nearest;
        patch.take_within(tile, glm::vec3(0.0f), static_cast<float>(radius * radius));
        if (patch.count > 0)
            nearest.take_nearest(patch, most > 0 ? std::min<size_t>(most, patch.count) : patch.count);
        found.clear();
        distances.clear();
        for (size_t i = 0; i < nearest.count; ++i) {
            found.push_back(static_cast<pcl::index_t>(order_[nearest.index[i]]));
            distances.push_back(nearest.distance2[i]);
        }
        return static_cast<int>(found.size());
    }

 private:
    static constexpr uint32_t kNone = UINT32_MAX;
    static constexpr int kMostAsked = 127;
    struct Entry {
        uint32_t index = kNone;
        float distance2 = 0;
    };

    std::vector<glm::dvec3> positions() const {
        std::vector<glm::dvec3> points;
        points.reserve(input_->size());
        for (const auto& p : *input_) points.emplace_back(p.x, p.y, p.z);
        return points;
    }

    /// For positions that are not points of the cloud.
    const LeafIndex& index() const {
        const std::lock_guard lock(mutex_);
        if (!index_) {
            const auto points = positions();
            order_ = morton_order(points);
            sorted_.clear();
            for (const uint32_t i : order_) sorted_.push_back(points[i]);
            index_ = std::make_unique<LeafIndex>(sorted_);
        }
        return *index_;
    }

    bool has_table(int k) const {
        const std::lock_guard lock(mutex_);
        if (asked_ == 0 && k > 0 && k <= kMostAsked && !fill(static_cast<size_t>(k))) return false;
        return k > 0 && static_cast<size_t>(k) <= asked_;
    }

    bool fill(size_t k) const {
        table_.assign(input_->size() * k, {});
        const OneChunk chunk(positions());
        ChunkCache cache(chunk, 0);
        auto neighbours = ChunkNeighbours::load(cache, 0, NeighbourSearch::leaf, 0);
        if (!neighbours) return false;
        const double unit2 = 1 / (cache.scale() * cache.scale());
        const auto done = neighbours->search(
            k, [&](uint32_t site, const Patch& nearest, bool, ChunkNeighbours::Surroundings&) {
                for (const uint32_t point : neighbours->members(site)) {
                    Entry* row = &table_[point * k];
                    size_t filled = 0;
                    for (size_t i = 0; i < nearest.count && filled < k; ++i)
                        for (const uint32_t other : neighbours->members(nearest.index[i])) {
                            if (filled == k) break;
                            row[filled++] = {other, static_cast<float>(nearest.distance2[i] * unit2)};
                        }
                }
                return 0.0;
            });
        asked_ = done ? k : 0;
        return done.has_value();
    }

    mutable std::mutex mutex_;
    mutable PointArrays sorted_;
    mutable std::vector<uint32_t> order_;
    mutable std::unique_ptr<LeafIndex> index_;
    mutable size_t asked_ = 0;  ///< neighbours per point in the table
    mutable std::vector<Entry> table_;
};

}  // namespace

std::vector<glm::vec3> pcl_normals(std::span<const glm::vec3> points, int neighbours,
                                   NeighbourSearch search) {
    auto cloud = pcl::make_shared<Cloud>();
    for (const auto& p : points) cloud->push_back({p.x, p.y, p.z});
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimator;
    estimator.setInputCloud(cloud);
    estimator.setKSearch(neighbours);
    if (search == NeighbourSearch::leaf) estimator.setSearchMethod(pcl::make_shared<LeafSearch>());
    pcl::PointCloud<pcl::Normal> found;
    estimator.compute(found);
    std::vector<glm::vec3> normals;
    normals.reserve(found.size());
    for (const auto& n : found) normals.emplace_back(n.normal_x, n.normal_y, n.normal_z);
    return normals;
}

}  // namespace lucarne::octree
