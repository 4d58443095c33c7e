#include "gi/raster/native/rims.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "gi/raster/one_surface.h"
#include "gi/shared/gbuffer.h"
#include "io/core/parallel.h"

namespace lucarne::gi::native {
namespace {

constexpr size_t kRowsPerTask = 16;

/// A bit for each pixel of a picture, rows padded to whole words.
class PixelBits {
 public:
    PixelBits(size_t width, size_t height)
        : words_((width + 63) / 64), height_(height), bits_(words_ * height) {}
    size_t words() const { return words_; }
    uint64_t& word(size_t row, size_t i) { return bits_[row * words_ + i]; }
    /// A word of the pixels that have one of the set within kRimReach columns and rows.
    uint64_t near(size_t row, size_t i) const {
        static_assert(raster::kRimReach == 4);
        const size_t first = row > raster::kRimReach ? row - raster::kRimReach : 0;
        const size_t last = std::min(row + raster::kRimReach + 1, height_);
        uint64_t before = 0, here = 0, after = 0;
        for (size_t y = first; y < last; ++y) {
            const uint64_t* words = bits_.data() + y * words_;
            here |= words[i];
            if (i > 0) before |= words[i - 1];
            if (i + 1 < words_) after |= words[i + 1];
        }
        uint64_t near = here;
        for (int k = 1; k <= raster::kRimReach; ++k)
            near |= here << k | here >> k | before >> (64 - k) | after << (64 - k);
        return near;
    }

 private:
    size_t words_, height_;
    std::vector<uint64_t> bits_;
};

/// Which texels are seen from the front, and which from behind.
struct Sides {
    PixelBits front, behind;

    Sides(const CameraView& view, const GBufferTexel* texels)
        : front(view.width, view.height), behind(view.width, view.height) {
        parallel_ranges(view.height, kRowsPerTask, [&](size_t first, size_t last) {
            for (size_t y = first; y < last; ++y)
                for (size_t i = 0; i < front.words(); ++i) {
                    const GBufferTexel* from = texels + y * view.width + 64 * i;
                    const size_t count = std::min<size_t>(64, view.width - 64 * i);
                    uint64_t known = 0, turned = 0;
                    for (size_t k = 0; k < count; ++k) {
                        const uint64_t shown = from[k].depth != 0 && (from[k].albedo & kSurfelHasNormal);
                        known |= shown << k;
                        turned |= uint64_t{from[k].albedo / kTexelFromBehind} << k;
                    }
                    front.word(y, i) = known & ~turned;
                    behind.word(y, i) = known & turned;
                }
        });
    }
};

/// The points that the pixels of a view show, without a division for each.
class PixelPoints {
 public:
    explicit PixelPoints(const CameraView& view)
        : parallel_(is_parallel(view)),
          forward_(xyz_of(view.forward)),
          first_(view_across(view, glm::vec2(0.5f))),
          right_(view_across(view, glm::vec2(1.5f, 0.5f)) - first_),
          down_(view_across(view, glm::vec2(0.5f, 1.5f)) - first_) {}
    /// view_ray(): its depth is 1.
    glm::vec3 ray(int x, int y) const { return parallel_ ? forward_ : at(x, y, 1); }
    /// Relative to the view's origin, as view_offset().
    glm::vec3 at(int x, int y, float depth) const {
        const glm::vec3 across = first_ + static_cast<float>(x) * right_ + static_cast<float>(y) * down_;
        return depth * forward_ + (parallel_ ? across : depth * across);
    }

 private:
    bool parallel_;
    glm::vec3 forward_, first_, right_, down_;
};

/// Returns whether most texels of the surface around a texel show its other side. See rims.comp.
bool is_rim(const CameraView& view, const PixelPoints& points, const GBufferTexel* texels, int x, int y) {
    const auto width = static_cast<int>(view.width), height = static_cast<int>(view.height);
    const GBufferTexel& texel = texels[y * width + x];
    const glm::vec3 place = points.at(x, y, texel.depth), normal = raster::stored_normal(texel);
    const float pixel = pixel_height(view, texel.depth);
    int others = 0, left = 8 * static_cast<int>(raster::kRimSteps);
    for (int steps = 1; steps <= raster::kRimReach; steps *= 2)
        for (int dy = -steps; dy <= steps; dy += steps)
            for (int dx = -steps; dx <= steps; dx += steps) {
                if (dx == 0 && dy == 0) continue;
                if (others > left || others + left <= 0) return others > 0;  // nothing can change it
                --left;
                const int column = x + dx, row = y + dy;
                if (column < 0 || row < 0 || column >= width || row >= height) continue;
                const GBufferTexel& other = texels[row * width + column];
                if (other.depth == 0) continue;
                const glm::vec3 across = points.at(column, row, other.depth) - place;
                const float reach = static_cast<float>(steps) * pixel;
                if (!raster::is_one_surface(texel, normal, other, across, reach)) continue;
                others += (texel.albedo ^ other.albedo) & kTexelFromBehind ? 1 : -1;
            }
    return others > 0;
}

/// A texel whose depth and normal change.
struct TurnedTexel {
    size_t at;
    float depth;
    uint32_t normal;
};

/// Returns a texel of a hidden face moved to the face in front; otherwise as it is. See rims.comp.
TurnedTexel in_front_face(const CameraView& view, const PixelPoints& points, const GBufferTexel* texels,
                          int x, int y) {
    const auto width = static_cast<int>(view.width), height = static_cast<int>(view.height);
    const auto at = static_cast<size_t>(y) * view.width + static_cast<size_t>(x);
    const GBufferTexel& texel = texels[at];
    const glm::vec3 place = points.at(x, y, texel.depth), normal = raster::stored_normal(texel);
    const float pixel = pixel_height(view, texel.depth), farthest = raster::kRimReach * pixel;
    const auto inside = [&](int column, int row) {
        return column >= 0 && row >= 0 && column < width && row < height;
    };
    for (int steps = 1; steps <= raster::kRimReach; steps *= 2) {
        const float reach = static_cast<float>(steps) * pixel;
        for (int dy = -steps; dy <= steps; dy += steps)
            for (int dx = -steps; dx <= steps; dx += steps) {
                if ((dx == 0 && dy == 0) || !inside(x + dx, y + dy)) continue;
                const GBufferTexel& front = texels[(y + dy) * width + x + dx];
                if (front.depth == 0) continue;
                const glm::vec3 across = points.at(x + dx, y + dy, front.depth) - place;
                if (!raster::is_over_crease(texel, normal, front, across, reach)) continue;
                const int away_x = x - dx / steps * raster::kRimReach;  // where its own surface may go on
                const int away_y = y - dy / steps * raster::kRimReach;
                if (inside(away_x, away_y)) {
                    const GBufferTexel& beyond = texels[away_y * width + away_x];
                    if (beyond.depth != 0 &&
                        raster::is_one_surface(texel, normal, beyond,
                                               points.at(away_x, away_y, beyond.depth) - place, farthest))
                        continue;
                }
                const float depth =
                    texel.depth + raster::depth_to_plane(texel_normal(front), across, points.ray(x, y));
                if (depth > 0) return {at, depth, front.normal};
            }
    }
    return {at, texel.depth, texel.normal};
}

/// Finds the rims of some rows.
void find_rims(const CameraView& view, const GBufferTexel* texels, Sides& sides, size_t first, size_t last,
               std::vector<TurnedTexel>& found) {
    const PixelPoints points(view);
    for (size_t y = first; y < last; ++y)
        for (size_t i = 0; i < sides.front.words(); ++i) {
            const uint64_t front = sides.front.word(y, i), behind = sides.behind.word(y, i);
            uint64_t left = 0;  // those with another side near them
            if (front) left |= front & sides.behind.near(y, i);
            if (behind) left |= behind & sides.front.near(y, i);
            for (; left; left &= left - 1) {
                const size_t column = 64 * i + static_cast<size_t>(std::countr_zero(left));
                const size_t at = y * view.width + column;
                const int x = static_cast<int>(column), row = static_cast<int>(y);
                const glm::vec3 ray = glm::normalize(points.ray(x, row));
                if (raster::may_be_rim(texels[at], ray) && is_rim(view, points, texels, x, row)) {
                    found.push_back(
                        {at, texels[at].depth, encode_octahedral(raster::rim_normal(texels[at], ray))});
                } else if (behind >> (column % 64) & 1) {
                    found.push_back(in_front_face(view, points, texels, x, row));
                }
            }
        }
}

}  // namespace

Result<void> turn_rims(const CameraView& view, const Buffer& texels) {
    LUCARNE_ASSIGN(const MappedBuffer memory, texels.map());
    GBufferTexel* const out = memory.as<GBufferTexel>().data();
    Sides sides(view, out);
    // No texel may see what has become of its neighbours.
    std::vector<std::vector<TurnedTexel>> found((view.height + kRowsPerTask - 1) / kRowsPerTask);
    parallel_ranges(view.height, kRowsPerTask, [&](size_t first, size_t last) {
        find_rims(view, out, sides, first, last, found[first / kRowsPerTask]);
    });
    for (const auto& rims : found)
        for (const TurnedTexel& rim : rims) {
            out[rim.at].depth = rim.depth;
            out[rim.at].normal = rim.normal;
        }
    return {};
}

}  // namespace lucarne::gi::native
