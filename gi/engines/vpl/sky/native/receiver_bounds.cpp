#include <cstddef>
#include <limits>
#include <mutex>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/vpl/sky/native/shade.h"
#include "io/core/parallel.h"

namespace lucarne::gi::vpl::native {

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
