#include "gi/engines/paths/pixel_points.h"

#include <algorithm>
#include <atomic>

#include <xxhash.h>

#include "gi/engines/paths/interpolation.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kPixelsAtOnce = 2048;

uint64_t key_of(const CameraView& camera, std::span<const GBufferTexel> texels, const glm::vec3& offset,
                uint64_t lists) {
    uint64_t key = XXH3_64bits_withSeed(texels.data(), texels.size_bytes(), lists);
    key = XXH3_64bits_withSeed(&camera, sizeof(camera), key);
    return XXH3_64bits_withSeed(&offset, sizeof(offset), key);
}

}  // namespace

void PixelPoints::begin(const PathsBake& bake, const CameraView& camera, std::span<const GBufferTexel> texels,
                        const glm::vec3& offset, uint64_t lists) {
    offset_ = offset;
    const uint64_t key = key_of(camera, texels, offset, lists);
    if (bake_ == &bake && key_ == key) return;
    bake_ = &bake;
    key_ = key;
    found_ = {};
    alone_ = {};
    searched_ = 0;
}

void PixelPoints::visit(List list, std::span<const SurfacePoint> surfaces, const Visit& visit) {
    Sharing& found = found_[static_cast<size_t>(list)];
    if (found.first.empty()) alone_[static_cast<size_t>(list)] = 0;
    for (size_t first = 0; first < surfaces.size(); first += kMostPixels) {
        const std::span some = surfaces.subspan(first, std::min(surfaces.size() - first, kMostPixels));
        if (found.first.size() != some.size() + 1 || some.size() < surfaces.size()) {
            std::atomic<size_t> alone = 0;
            found = find_sharing(*bake_, some.size(), [&](PointFinder& finder, size_t i) {
                const SurfacePoint& at = some[i];
                if (!(at.radius > 0)) return false;
                if (!finder.find(at.position - offset_, at.normal)) ++alone;
                return true;
            });
            alone_[static_cast<size_t>(list)] += alone;
            searched_ += some.size();
        }
        parallel_ranges(some.size(), kPixelsAtOnce, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                if (some[i].radius > 0) visit(first + i, found.of(i));
        });
        if (some.size() < surfaces.size()) found = {};
    }
}

}  // namespace lucarne::gi::paths
