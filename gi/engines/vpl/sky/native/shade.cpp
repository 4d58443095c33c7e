#include "gi/engines/vpl/sky/native/shade.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <mutex>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/vpl/shading/native/window.h"
#include "io/core/parallel.h"

namespace lucarne::gi::vpl::native {
namespace {

struct SkyReceiver {
    glm::vec3 position, normal;
    float radius;
};

SkyReceiver receiver_of(const SkyShading& input, uint32_t x, uint32_t y, const GBufferTexel& texel) {
    return {texel_position(input.camera, glm::vec2(x, y), texel), texel_normal(texel), texel_radius(texel)};
}

/// Returns the irradiance by the maps of a tile, times the number of tiles, as gather_tile() in pixel.glsl.
glm::vec3 gather_tile(const SkyShading& input, const SkyReceiver& to, uint32_t tile, uint32_t tiles) {
    glm::vec3 sum(0.0f);
    for (size_t i = tile; i < input.maps.size(); i += tiles) {
        const SkyMap& map = input.maps[i];
        const float cosine = -glm::dot(to.normal, glm::vec3(map.away));
        if (!(cosine > 0)) continue;
        const float lift = sky_lift(map, to.radius);
        const glm::vec3 place = sky_place(map, to.position + to.normal * lift);
        const float last = static_cast<float>(input.side - 1);
        const glm::vec2 corner = glm::clamp(glm::floor(glm::vec2(place)), glm::vec2(0.0f), glm::vec2(last));
        const size_t at =
            (i * input.side + static_cast<size_t>(corner.y)) * input.side + static_cast<size_t>(corner.x);
        if (sky_blocks(map, input.texels[at], corner, place, input.depth_step, to.normal, to.radius, lift))
            continue;
        sum += glm::vec3(map.irradiance) * cosine;
    }
    return sum * static_cast<float>(tiles);
}

}  // namespace

void shade_sky(const SkyShading& input, uint32_t n, const GatherOutput& output) {
    const uint32_t width = input.camera.width, tiles = n * n;
    parallel_ranges(input.camera.height, 16, [&](size_t first, size_t end) {
        for (auto y = static_cast<uint32_t>(first); y < end; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const size_t pixel = size_t{y} * width + x;
                const GBufferTexel& texel = input.pixels[pixel];
                if (!(texel.depth > 0)) continue;
                const SkyReceiver to = receiver_of(input, x, y, texel);
                output.irradiance[pixel] += glm::vec4(gather_tile(input, to, y % n * n + x % n, tiles), 0.0f);
            }
    });
    if (n == 1) return;
    parallel_ranges(output.isolated.size(), 64, [&](size_t first, size_t end) {
        for (size_t i = first; i < end; ++i) {
            const uint32_t pixel = output.isolated[i], x = pixel % width, y = pixel / width;
            const SkyReceiver to = receiver_of(input, x, y, input.pixels[pixel]);
            const uint32_t lacking = lacking_tiles(output.joints + 2 * size_t{pixel}, static_cast<int>(n),
                                                   static_cast<int>(x), static_cast<int>(y));
            for (uint32_t tile = 0; tile < tiles; ++tile)
                if (lacking >> tile & 1)
                    output.own_irradiance[pixel] += glm::vec4(gather_tile(input, to, tile, tiles), 0.0f);
        }
    });
}

bool receiver_bounds(const CameraView& camera, const GBufferTexel* pixels, glm::vec3& low, glm::vec3& high) {
    low = glm::vec3(std::numeric_limits<float>::infinity());
    high = -low;
    std::mutex mutex;
    parallel_ranges(camera.height, 16, [&](size_t first, size_t end) {
        glm::vec3 least(std::numeric_limits<float>::infinity()), most = -least;
        for (auto y = static_cast<uint32_t>(first); y < end; ++y)
            for (uint32_t x = 0; x < camera.width; ++x) {
                const GBufferTexel& texel = pixels[size_t{y} * camera.width + x];
                if (!(texel.depth > 0)) continue;
                const glm::vec3 at = texel_position(camera, glm::vec2(x, y), texel);
                least = glm::min(least, at);
                most = glm::max(most, at);
            }
        const std::scoped_lock lock(mutex);
        low = glm::min(low, least);
        high = glm::max(high, most);
    });
    return low.x <= high.x;
}

}  // namespace lucarne::gi::vpl::native
