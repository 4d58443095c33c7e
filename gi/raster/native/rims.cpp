#include "gi/raster/native/rims.h"

#include "gi/raster/one_surface.h"
#include "gi/shared/gbuffer.h"
#include "io/core/parallel.h"

namespace lucarne::gi::native {
namespace {

constexpr size_t kRowsPerTask = 16;

bool from_behind(const GBufferTexel& texel) {
    return texel.albedo & kTexelFromBehind;
}

/// Returns whether a texel has the front of its surface beside it. See rims.comp.
bool continues_front(const CameraView& view, const GBufferTexel* texels, int x, int y) {
    const auto width = static_cast<int>(view.width), height = static_cast<int>(view.height);
    const GBufferTexel& texel = texels[y * width + x];
    const glm::vec3 place = view_offset(view, glm::vec2(x, y) + 0.5f, texel.depth);
    const float pixel = pixel_height(view, texel.depth);
    for (int steps = 1; steps < 1 << raster::kRimSteps; steps *= 2)
        for (int dy = -steps; dy <= steps; dy += steps)
            for (int dx = -steps; dx <= steps; dx += steps) {
                const int column = x + dx, row = y + dy;
                if (column < 0 || row < 0 || column >= width || row >= height) continue;
                const GBufferTexel& other = texels[row * width + column];
                if (other.depth == 0 || from_behind(other)) continue;
                const glm::vec3 across =
                    view_offset(view, glm::vec2(column, row) + 0.5f, other.depth) - place;
                if (raster::is_one_surface(texel, other, across, static_cast<float>(steps) * pixel))
                    return true;
            }
    return false;
}

}  // namespace

Result<void> turn_rims(const CameraView& view, const Buffer& texels) {
    LUCARNE_ASSIGN(const MappedBuffer memory, texels.map());
    GBufferTexel* const out = memory.as<GBufferTexel>().data();
    parallel_ranges(view.height, kRowsPerTask, [&](size_t first, size_t last) {
        for (size_t y = first; y < last; ++y)
            for (size_t x = 0; x < view.width; ++x) {
                GBufferTexel& texel = out[y * view.width + x];
                if (!from_behind(texel) || texel.depth == 0) continue;
                const glm::vec3 ray = glm::normalize(view_ray(view, glm::vec2(x, y) + 0.5f));
                if (!raster::may_be_rim(texel, ray)) continue;
                if (!continues_front(view, out, static_cast<int>(x), static_cast<int>(y))) continue;
                texel.normal = encode_octahedral(raster::turned_across(raster::stored_normal(texel), ray));
            }
    });
    return {};
}

}  // namespace lucarne::gi::native
