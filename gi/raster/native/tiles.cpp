#include "gi/raster/native/tiles.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"

namespace lucarne::gi::native {
namespace {

/// Pixels by which discs may reach beyond the bounds of their spheres: the pixel of the centre, the affine
/// map of small discs, and the width by which blending spreads them.
constexpr float kMargin = 3;
/// Pairs of tiles and blocks that are listed at a time.
constexpr size_t kMostPairs = size_t{1} << 24;

/// Returns the range of v / z for v in [low, high] and z in [near, far], near > 0.
glm::vec2 quotient_range(float low, float high, float near, float far) {
    return {low / (low < 0 ? near : far), high / (high < 0 ? far : near)};
}

class Placing {
 public:
    explicit Placing(const DiscView& view) : view_(view) {
        const glm::vec3 axes[3] = {glm::vec3(view.right), glm::vec3(view.down), glm::vec3(view.forward)};
        for (int i = 0; i < 3; ++i) axes_[i] = axes[i];
        size_ = {static_cast<float>(view.width), static_cast<float>(view.height)};
        scale_ = size_ / (2.0f * glm::vec2(view.right.w, view.down.w));
        middle_ = 0.5f * size_ - view.shift;
    }

    /// Returns false if no disc of the block is seen.
    bool place(const BlockBounds& bounds, PlacedBlock& placed) const {
        if (!(bounds.radius > 0)) return false;
        const bool flat = view_.origin.w > 0;
        const glm::vec3 middle = 0.5f * (bounds.low + bounds.high) - glm::vec3(view_.origin);
        const glm::vec3 half = 0.5f * (bounds.high - bounds.low);
        glm::vec3 centre, reach;
        for (int i = 0; i < 3; ++i) {
            centre[i] = glm::dot(middle, axes_[i]);
            reach[i] = glm::dot(half, glm::abs(axes_[i])) * 1.0001f + 1e-6f;
        }
        float radius = view_.size.scale * bounds.radius;
        const float per_pixel =
            0.5f * (flat ? 1.0f : std::max(centre.z + reach.z, 0.0f)) / std::min(scale_.x, scale_.y);
        if (view_.size.pixels > 0)
            radius = view_.size.pixels * per_pixel;
        else if (view_.size.most > 0)
            radius = std::min(radius, view_.size.most * per_pixel);
        const glm::vec3 low = centre - reach - radius, high = centre + reach + radius;
        if (!(high.z > view_.forward.w)) return false;
        placed.nearest = low.z - 0.01f * radius;
        glm::vec2 x(0, size_.x), y(0, size_.y);
        // Discs that reach behind the eye may cover every pixel.
        if (flat || low.z > 0.01f * radius) {
            x = flat ? glm::vec2(low.x, high.x) : quotient_range(low.x, high.x, low.z, high.z);
            y = flat ? glm::vec2(low.y, high.y) : quotient_range(low.y, high.y, low.z, high.z);
            x = x * scale_.x + middle_.x;
            y = y * scale_.y + middle_.y;
        }
        // NaN becomes 0.
        const auto pixel = [](float at, float end) {
            return at > 0 ? static_cast<int>(std::min(at, end)) : 0;
        };
        placed.rect = {pixel(x.x - kMargin, size_.x), pixel(y.x - kMargin, size_.y),
                       pixel(x.y + kMargin + 1, size_.x), pixel(y.y + kMargin + 1, size_.y)};
        return placed.rect.x0 < placed.rect.x1 && placed.rect.y0 < placed.rect.y1;
    }

 private:
    const DiscView& view_;
    glm::vec3 axes_[3];
    glm::vec2 size_, scale_, middle_;
};

}  // namespace

std::vector<PlacedBlock> place_blocks(const HostSurfels& surfels, const DiscView& view) {
    const Placing placing(view);
    std::vector<PlacedBlock> placed(surfels.bounds.size());
    parallel_ranges(placed.size(), 1024, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            placed[i].block = static_cast<uint32_t>(i);
            if (!placing.place(surfels.bounds[i], placed[i])) placed[i].block = UINT32_MAX;
        }
    });
    std::erase_if(placed, [](const PlacedBlock& block) { return block.block == UINT32_MAX; });
    std::ranges::sort(placed, {}, [](const PlacedBlock& b) { return std::tuple(b.nearest, b.block); });
    return placed;
}

namespace {

struct Tiling {
    std::span<const PlacedBlock> blocks;
    int width, height, size;
    const std::function<void(const PixelRect&, std::span<const PlacedBlock* const>)>& draw;

    /// Draws the tiles of a part of the picture, given in tiles.
    void run(const PixelRect& part) const {
        const int columns = part.x1 - part.x0, rows = part.y1 - part.y0;
        const size_t tiles = static_cast<size_t>(columns) * static_cast<size_t>(rows);
        const auto each_tile = [&](const PlacedBlock& block, const auto& take) {
            const int x1 = std::min((block.rect.x1 - 1) / size + 1, part.x1),
                      y1 = std::min((block.rect.y1 - 1) / size + 1, part.y1);
            for (int y = std::max(block.rect.y0 / size, part.y0); y < y1; ++y)
                for (int x = std::max(block.rect.x0 / size, part.x0); x < x1; ++x)
                    take(static_cast<size_t>(y - part.y0) * static_cast<size_t>(columns) +
                         static_cast<size_t>(x - part.x0));
        };
        std::vector<size_t> first(tiles + 1, 0);
        for (const PlacedBlock& block : blocks) each_tile(block, [&](size_t tile) { ++first[tile + 1]; });
        for (size_t tile = 0; tile < tiles; ++tile) first[tile + 1] += first[tile];
        if (first[tiles] > kMostPairs && tiles > 1) {
            PixelRect head = part, tail = part;
            if (rows > columns)
                head.y1 = tail.y0 = part.y0 + rows / 2;
            else
                head.x1 = tail.x0 = part.x0 + columns / 2;
            run(head);
            return run(tail);
        }
        std::vector<const PlacedBlock*> pairs(first[tiles]);
        std::vector<size_t> next(first.begin(), first.end() - 1);
        for (const PlacedBlock& block : blocks)
            each_tile(block, [&](size_t tile) { pairs[next[tile]++] = &block; });
        parallel_ranges(tiles, 1, [&](size_t tile, size_t) {
            const int x = (part.x0 + static_cast<int>(tile) % columns) * size,
                      y = (part.y0 + static_cast<int>(tile) / columns) * size;
            draw({x, y, std::min(x + size, width), std::min(y + size, height)},
                 std::span(pairs).subspan(first[tile], first[tile + 1] - first[tile]));
        });
    }
};

}  // namespace

void for_tiles(std::span<const PlacedBlock> blocks, const DiscView& view, int size,
               const std::function<void(const PixelRect&, std::span<const PlacedBlock* const>)>& draw) {
    const auto width = static_cast<int>(view.width), height = static_cast<int>(view.height);
    const Tiling tiling{blocks, width, height, size, draw};
    tiling.run({0, 0, (width + size - 1) / size, (height + size - 1) / size});
}

}  // namespace lucarne::gi::native
