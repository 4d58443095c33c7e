#pragma once

#include <utility>

#include <glm/common.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {

/// Presents a whole cloud as one chunk.
class OneChunk final : public ChunkAccess {
 public:
    explicit OneChunk(std::vector<glm::dvec3> points) : points_(std::move(points)) {
        if (!points_.empty()) bounds_ = {points_[0], points_[0]};
        for (const auto& p : points_) {
            bounds_.min = glm::min(bounds_.min, p);
            bounds_.max = glm::max(bounds_.max, p);
        }
    }
    size_t chunk_count() const override { return 1; }
    Box bounds(size_t) const override { return bounds_; }
    uint64_t point_count(size_t) const override { return points_.size(); }
    Result<std::vector<glm::dvec3>> positions(size_t) const override { return points_; }
    Result<std::vector<int32_t>> stations(size_t) const override {
        return std::vector<int32_t>(points_.size(), -1);
    }

 private:
    std::vector<glm::dvec3> points_;
    Box bounds_{};
};

}  // namespace lucarne::octree
