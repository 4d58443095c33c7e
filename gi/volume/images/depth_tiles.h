#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "gi/volume/images/image_voxels.h"

namespace lucarne::gi::volume {

/// The least and the largest depth in tiles of a picture. Pixels that show nothing do not count.
class DepthTiles {
 public:
    static constexpr uint32_t kSide = 8;  ///< of a tile, pixels

    struct Range {
        float least = std::numeric_limits<float>::infinity(), most = -least;
        void add(const Range& other) {
            least = std::min(least, other.least);
            most = std::max(most, other.most);
        }
    };

    explicit DepthTiles(const SeenImage& image)
        : columns_((image.view.width + kSide - 1) / kSide),
          rows_((image.view.height + kSide - 1) / kSide),
          tiles_(size_t{columns_} * rows_) {
        for (uint32_t y = 0; y < image.view.height; ++y)
            for (uint32_t x = 0; x < image.view.width; ++x) {
                const float depth = image.texels[size_t{y} * image.view.width + x].depth;
                if (depth > 0) tiles_[size_t{y / kSide} * columns_ + x / kSide].add({depth, depth});
            }
    }

    /// Returns the range of all tiles that meet a box of the picture, in pixels.
    Range about(float left, float top, float right, float bottom) const {
        const auto tile = [](float at, uint32_t count) {
            return static_cast<uint32_t>(std::clamp(at / kSide, 0.0f, static_cast<float>(count)));
        };
        Range range;
        const uint32_t last_x = tile(right, columns_), last_y = tile(bottom, rows_);
        for (uint32_t y = tile(top, rows_); y <= last_y && y < rows_; ++y)
            for (uint32_t x = tile(left, columns_); x <= last_x && x < columns_; ++x)
                range.add(tiles_[size_t{y} * columns_ + x]);
        return range;
    }

 private:
    uint32_t columns_, rows_;
    std::vector<Range> tiles_;
};

}  // namespace lucarne::gi::volume
