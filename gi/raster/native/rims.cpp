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
                for (size_t x = 0; x < view.width; ++x) {
                    const GBufferTexel& texel = texels[y * view.width + x];
                    if (texel.depth == 0 || !(texel.albedo & kSurfelHasNormal)) continue;
                    PixelBits& bits = texel.albedo & kTexelFromBehind ? behind : front;
                    bits.word(y, x / 64) |= uint64_t{1} << (x % 64);
                }
        });
    }
};

/// Returns whether most texels of the surface around a texel show its other side. See rims.comp.
bool is_rim(const CameraView& view, const GBufferTexel* texels, int x, int y) {
    const auto width = static_cast<int>(view.width), height = static_cast<int>(view.height);
    const GBufferTexel& texel = texels[y * width + x];
    const glm::vec3 place = view_offset(view, glm::vec2(x, y) + 0.5f, texel.depth);
    const float pixel = pixel_height(view, texel.depth);
    int others = 0;
    for (int steps = 1; steps <= raster::kRimReach; steps *= 2)
        for (int dy = -steps; dy <= steps; dy += steps)
            for (int dx = -steps; dx <= steps; dx += steps) {
                const int column = x + dx, row = y + dy;
                if (column < 0 || row < 0 || column >= width || row >= height) continue;
                if (dx == 0 && dy == 0) continue;
                const GBufferTexel& other = texels[row * width + column];
                if (other.depth == 0) continue;
                const glm::vec3 across =
                    view_offset(view, glm::vec2(column, row) + 0.5f, other.depth) - place;
                if (!raster::is_one_surface(texel, other, across, static_cast<float>(steps) * pixel))
                    continue;
                others += (texel.albedo ^ other.albedo) & kTexelFromBehind ? 1 : -1;
            }
    return others > 0;
}

/// A texel and its new normal.
struct TurnedTexel {
    size_t at;
    uint32_t normal;
};

/// Finds the rims of some rows.
void find_rims(const CameraView& view, const GBufferTexel* texels, Sides& sides, size_t first, size_t last,
               std::vector<TurnedTexel>& found) {
    for (size_t y = first; y < last; ++y)
        for (size_t i = 0; i < sides.front.words(); ++i) {
            const uint64_t front = sides.front.word(y, i), behind = sides.behind.word(y, i);
            uint64_t left = 0;  // those with another side near them
            if (front) left |= front & sides.behind.near(y, i);
            if (behind) left |= behind & sides.front.near(y, i);
            for (; left; left &= left - 1) {
                const size_t x = 64 * i + static_cast<size_t>(std::countr_zero(left));
                const size_t at = y * view.width + x;
                const glm::vec3 ray = glm::normalize(view_ray(view, glm::vec2(x, y) + 0.5f));
                if (!raster::may_be_rim(texels[at], ray)) continue;
                if (!is_rim(view, texels, static_cast<int>(x), static_cast<int>(y))) continue;
                found.push_back({at, encode_octahedral(raster::rim_normal(texels[at], ray))});
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
        for (const TurnedTexel& rim : rims) out[rim.at].normal = rim.normal;
    return {};
}

}  // namespace lucarne::gi::native
