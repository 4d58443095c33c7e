#include "gi/raster/native/rims.h"

#include <algorithm>
#include <bit>
#include <optional>
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

/// A texel that changes: it shows what the texel `from` shows, or itself, at another depth or with another
/// normal.
struct ChangedTexel {
    size_t at, from;
    float depth;
    uint32_t normal;
};

/// Finds what to show in place of hidden faces. See rims.comp.
class HiddenFaces {
 public:
    HiddenFaces(const CameraView& view, const PixelPoints& points, const GBufferTexel* texels)
        : view_(view),
          points_(points),
          texels_(texels),
          width_(static_cast<int>(view.width)),
          height_(static_cast<int>(view.height)) {}

    /// Returns what a texel that is seen from behind shows instead, if it belongs to a hidden face.
    std::optional<ChangedTexel> replaced(int x, int y) const {
        const GBufferTexel& texel = texel_at(x, y);
        const Place place{x,
                          y,
                          texel,
                          points_.at(x, y, texel.depth),
                          raster::stored_normal(texel),
                          pixel_height(view_, texel.depth)};
        for (int steps = 1; steps <= raster::kRimReach; steps *= 2)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    if ((dx == 0 && dy == 0) || !is_inside(x + steps * dx, y + steps * dy)) continue;
                    const int column = x + steps * dx, row = y + steps * dy;
                    const GBufferTexel& front = texel_at(column, row);
                    if (front.depth == 0) continue;
                    const glm::vec3 across = points_.at(column, row, front.depth) - place.point;
                    const float reach = static_cast<float>(steps) * place.pixel;
                    if (!raster::is_over_crease(texel, place.normal, front, across, reach)) continue;
                    if (const auto changed = beyond(place, -dx, -dy, front, across)) return changed;
                }
        return std::nullopt;
    }

 private:
    struct Place {
        int x, y;
        const GBufferTexel& texel;
        glm::vec3 point, normal;  // relative to the view's origin, m; as stored
        float pixel;              // m
    };

    size_t index(int x, int y) const { return static_cast<size_t>(y * width_ + x); }
    const GBufferTexel& texel_at(int x, int y) const { return texels_[index(x, y)]; }
    bool is_inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

    /// Returns what lies beyond the hidden face, in a direction away from the face in front; or else that
    /// face.
    std::optional<ChangedTexel> beyond(const Place& place, int dx, int dy, const GBufferTexel& front,
                                       const glm::vec3& across) const {
        const size_t at = index(place.x, place.y);
        const glm::vec3 ray = points_.ray(place.x, place.y);
        for (int k = 1; k <= raster::kRimReach; ++k) {
            const int column = place.x + k * dx, row = place.y + k * dy;
            if (!is_inside(column, row)) break;
            const size_t from = index(column, row);
            const GBufferTexel& other = texels_[from];
            if (other.depth == 0) return ChangedTexel{at, from, 0, other.normal};
            const glm::vec3 point = points_.at(column, row, other.depth);
            const float reach = static_cast<float>(k) * place.pixel;
            if (raster::is_one_surface(place.texel, place.normal, other, point - place.point, reach)) {
                if (k == raster::kRimReach) return std::nullopt;
                continue;
            }
            if (!raster::is_background(other, place.texel, reach)) break;
            const float deeper = raster::depth_to_plane(
                texel_normal(other), point - points_.at(place.x, place.y, other.depth), ray);
            const float depth = other.depth + deeper;
            return ChangedTexel{at, from, depth > place.texel.depth ? depth : other.depth, other.normal};
        }
        const float depth = place.texel.depth + raster::depth_to_plane(texel_normal(front), across, ray);
        if (!(depth > 0)) return std::nullopt;
        return ChangedTexel{at, at, depth, front.normal};
    }

    const CameraView& view_;
    const PixelPoints& points_;
    const GBufferTexel* texels_;
    int width_, height_;
};

/// Finds the rims of some rows.
void find_rims(const CameraView& view, const GBufferTexel* texels, Sides& sides, size_t first, size_t last,
               std::vector<ChangedTexel>& found) {
    const PixelPoints points(view);
    const HiddenFaces hidden(view, points, texels);
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
                    const uint32_t normal = encode_octahedral(raster::rim_normal(texels[at], ray));
                    found.push_back({at, at, texels[at].depth, normal});
                } else if (behind >> (column % 64) & 1) {
                    if (const auto changed = hidden.replaced(x, row)) found.push_back(*changed);
                }
            }
        }
}

}  // namespace

Result<void> turn_rims(const CameraView& view, const Buffer& texels, const Buffer& ids) {
    LUCARNE_ASSIGN(const MappedBuffer memory, texels.map());
    LUCARNE_ASSIGN(const MappedBuffer ids_memory, ids.map());
    GBufferTexel* const out = memory.as<GBufferTexel>().data();
    uint32_t* const ids_out = ids_memory.as<uint32_t>().data();
    Sides sides(view, out);
    // No texel may see what has become of its neighbours.
    std::vector<std::vector<ChangedTexel>> found((view.height + kRowsPerTask - 1) / kRowsPerTask);
    parallel_ranges(view.height, kRowsPerTask, [&](size_t first, size_t last) {
        find_rims(view, out, sides, first, last, found[first / kRowsPerTask]);
    });
    for (const auto& rims : found)
        for (const ChangedTexel& rim : rims) {
            // What is copied does not change itself, apart from its normal: it is not seen from behind.
            out[rim.at].albedo = out[rim.from].albedo;
            out[rim.at].material = out[rim.from].material;
            out[rim.at].depth = rim.depth;
            out[rim.at].normal = rim.normal;
            ids_out[rim.at] = ids_out[rim.from];
        }
    return {};
}

}  // namespace lucarne::gi::native
