#include "gi/raster/blend.h"

#include <algorithm>
#include <cstddef>

#include "gi/raster/bindings.h"
#include "gi/raster/blend_sums.h"
#include "gi/raster/native/native.h"
#include "gi/raster/queues.h"

namespace lucarne::gi {
namespace {

/// Larger pictures are blended in bands of rows.
constexpr size_t kMostSumBytes = size_t{128} << 20;

}  // namespace

Result<void> blend(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                   const PointSize& size) {
    if (size.pixels > 0) return {};
    if (native::draws(device, cut))
        return native::blend(cut, disc_view(view, size), target.texels, target.to_blend);
    const size_t row_bytes = view.width * raster::kSumWords * sizeof(uint32_t);
    const auto band = static_cast<uint32_t>(std::clamp<size_t>(kMostSumBytes / row_bytes, 1, view.height));
    if (target.sums.bytes() < band * row_bytes) {
        LUCARNE_TRY(device.reserve(target.sums, band * row_bytes, "blended G-buffer"));
        target.sums.clear(0);
    }
    LUCARNE_ASSIGN(const Program* plan, device.program("gi/raster/plan_blend.comp"));
    LUCARNE_ASSIGN(const Program* small, device.program("gi/raster/blend.comp"));
    LUCARNE_ASSIGN(const Program* queued, device.program("gi/raster/blend_large.comp"));
    LUCARNE_ASSIGN(const Program* overflow, device.program("gi/raster/blend_overflow.comp"));
    LUCARNE_ASSIGN(const Program* resolve, device.program("gi/raster/blend_resolve.comp"));
    cut.bind();
    target.queues.bind(raster::kBindQueues);
    target.texels.bind(raster::kBindTexels);
    target.texels.bind_texels(raster::kUnitFront, TexelView::four_words);
    target.seen_blocks.bind(raster::kBindBlocks);
    target.sums.bind(raster::kBindSums);
    target.sums.bind_texels(raster::kUnitSums, TexelView::four_words);
    small->set("blocks", cut.blocks());
    plan->dispatch(1);
    for (uint32_t first = 0; first < view.height; first += band) {
        const uint32_t end = std::min(first + band, view.height);
        for (const Program* program : {small, queued, overflow, resolve}) {
            set_disc_view(*program, view, size);
            program->set("band_first", first);
            program->set("band_end", end);
        }
        small->dispatch_indirect(target.queues, offsetof(QueueHeader, seen_groups));
        queued->dispatch_indirect(target.queues, offsetof(QueueHeader, large_groups));
        overflow->dispatch_indirect(target.queues, offsetof(QueueHeader, overflow_groups));
        resolve->dispatch(view.width * (end - first));
    }
    return {};
}

}  // namespace lucarne::gi
