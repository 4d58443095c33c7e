#include "gi/engines/paths/pixel_points.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include <xxhash.h>

#include "gi/engines/paths/interpolation.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kPixelsAtOnce = 2048, kPixelsAPiece = size_t{1} << 16;

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
    searched_ = kept_ = 0;
}

PixelPoints::Piece PixelPoints::find(std::span<const SurfacePoint> surfaces) const {
    std::atomic<size_t> alone = 0;
    Piece piece{find_sharing(*bake_, surfaces.size(), [&](PointFinder& finder, size_t i) {
        const SurfacePoint& at = surfaces[i];
        if (!(at.radius > 0)) return false;
        if (!finder.find(at.position - offset_, at.normal)) ++alone;
        return true;
    })};
    piece.alone = alone;
    return piece;
}

void PixelPoints::visit(List list, std::span<const SurfacePoint> surfaces, const Visit& visit) {
    std::vector<Piece>& kept = found_[static_cast<size_t>(list)];
    size_t& alone = alone_[static_cast<size_t>(list)];
    alone = 0;
    for (size_t first = 0; first < surfaces.size(); first += kPixelsAPiece) {
        const std::span some = surfaces.subspan(first, std::min(surfaces.size() - first, kPixelsAPiece));
        const size_t number = first / kPixelsAPiece;
        Piece found;
        const auto is_of = [&](const Piece& piece) { return piece.points.first.size() == some.size() + 1; };
        for (; number < kept.size() && !is_of(kept[number]); kept.pop_back())
            kept_ -= kept.back().size();  // other pixels than before
        if (number >= kept.size()) {
            found = find(some);
            searched_ += some.size();
            if (number == kept.size() && kept_ + found.size() <= most_kept_) {
                kept_ += found.size();
                kept.push_back(std::move(found));
            }
        }
        const Piece& own = number < kept.size() ? kept[number] : found;
        alone += own.alone;
        parallel_ranges(some.size(), kPixelsAtOnce, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                if (some[i].radius > 0) visit(first + i, own.points.of(i));
        });
    }
}

}  // namespace lucarne::gi::paths
