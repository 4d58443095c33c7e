#include "gi/engines/paths/pixel_points.h"

#include <algorithm>
#include <atomic>

#include <xxhash.h>

#include "gi/engines/paths/interpolation.h"

namespace lucarne::gi::paths {
namespace {

uint64_t key_of(const CameraView& camera, std::span<const GBufferTexel> texels, const glm::vec3& offset,
                size_t first) {
    uint64_t key = XXH3_64bits_withSeed(texels.data(), texels.size_bytes(), first);
    key = XXH3_64bits_withSeed(&camera, sizeof(camera), key);
    return XXH3_64bits_withSeed(&offset, sizeof(offset), key);
}

}  // namespace

void PixelPoints::find(const PathsBake& bake, const CameraView& camera, std::span<const GBufferTexel> texels,
                       std::span<const SurfacePoint> surfaces, const glm::vec3& offset, size_t first) {
    const size_t count = std::min(surfaces.size() - first, kMostPixels);
    const uint64_t key = key_of(camera, texels.subspan(first, count), offset, first);
    if (bake_ == &bake && key_ == key) return;
    std::atomic<size_t> alone = 0;
    sharing_ = find_sharing(bake, count, [&](PointFinder& finder, size_t i) {
        const SurfacePoint& at = surfaces[first + i];
        if (!(at.radius > 0)) return false;
        if (!finder.find(at.position - offset, at.normal)) ++alone;
        return true;
    });
    alone_ = alone;
    bake_ = &bake;
    key_ = key;
}

}  // namespace lucarne::gi::paths
