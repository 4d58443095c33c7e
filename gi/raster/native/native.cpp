#include "gi/raster/native/native.h"

#include <algorithm>
#include <bit>

#include <hwy/targets.h>

#include "gi/raster/native/blending.h"
#include "gi/raster/native/coverage.h"
#include "gi/raster/native/visibility.h"
#include "io/core/parallel.h"

namespace lucarne::gi::native {

namespace {

CutMemory memory_of(const DeviceCut& cut, std::span<const PackedSurfel> pool) {
    const HostSurfels& surfels = cut.on_host(pool);
    return {pool.data(), cut.items().data(), cut.block_list().data(), surfels.radii.data(),
            surfels.first.data()};
}

}  // namespace

bool draws(const Device& device, const DeviceCut& cut) {
    // Indices of words are signed 32-bit numbers in gathers.
    constexpr size_t kMostSurfels = size_t{1} << 28;
    return device.native_passes() && cut.blocks() > 0 && cut.blocks() <= kMostSurfels / kBlockSurfels &&
           cut.pool().bytes() <= kMostSurfels * sizeof(PackedSurfel);
}

Result<void> rasterize(const DeviceCut& cut, const DiscView& view, const Buffer& texels, const Buffer& ids,
                       std::vector<PlacedBlock>& to_blend) {
    LUCARNE_ASSIGN(const MappedBuffer pool, cut.pool().map());
    LUCARNE_ASSIGN(const MappedBuffer texel_memory, texels.map());
    LUCARNE_ASSIGN(const MappedBuffer id_memory, ids.map());
    const auto surfels = pool.as<const PackedSurfel>();
    const CutMemory memory = memory_of(cut, surfels);
    std::vector<uint8_t> blended(cut.blocks(), 0);
    to_blend = place_blocks(cut.on_host(surfels), view);
    const VisibilityTarget out{texel_memory.as<GBufferTexel>().data(), id_memory.as<uint32_t>().data(),
                               blended.data()};
    for_tiles(to_blend, view, kVisibilityTile,
              [&](const PixelRect& tile, std::span<const PlacedBlock* const> blocks) {
                  draw_visibility(memory, view, tile, blocks, out);
              });
    std::erase_if(to_blend, [&](const PlacedBlock& block) { return !blended[block.block]; });
    return {};
}

Result<void> blend(const DeviceCut& cut, const DiscView& view, const Buffer& texels,
                   std::span<const PlacedBlock> to_blend) {
    LUCARNE_ASSIGN(const MappedBuffer pool, cut.pool().map());
    LUCARNE_ASSIGN(const MappedBuffer texel_memory, texels.map());
    const CutMemory memory = memory_of(cut, pool.as<const PackedSurfel>());
    GBufferTexel* out = texel_memory.as<GBufferTexel>().data();
    for_tiles(to_blend, view, kBlendingTile,
              [&](const PixelRect& tile, std::span<const PlacedBlock* const> blocks) {
                  draw_blending(memory, view, tile, blocks, out);
              });
    return {};
}

Result<void> find_coverage(const DeviceCut& cut, const CameraView& camera, const DiscView& view,
                           const Buffer& texels, const Buffer& ids, const Buffer& coverage) {
    LUCARNE_ASSIGN(const MappedBuffer pool, cut.pool().map());
    LUCARNE_ASSIGN(const MappedBuffer texel_memory, texels.map());
    LUCARNE_ASSIGN(const MappedBuffer id_memory, ids.map());
    LUCARNE_ASSIGN(const MappedBuffer coverage_memory, coverage.map());
    const CutMemory memory = memory_of(cut, pool.as<const PackedSurfel>());
    const auto* seen = texel_memory.as<const GBufferTexel>().data();
    const auto* owners = id_memory.as<const uint32_t>().data();
    auto* out = coverage_memory.as<uint32_t>().data();
    constexpr size_t kRows = 16;  // of a task
    parallel_ranges(view.height, kRows, [&](size_t first, size_t last) {
        find_coverage(memory,
                      {camera, view, seen, owners, out, static_cast<int>(first), static_cast<int>(last)});
    });
    return {};
}

bool use_instruction_set(int set) {
    hwy::SetSupportedTargetsForTest(0);
    if (set < 0) return true;
    // The bits of faster sets are lower.
    const int64_t all = hwy::SupportedTargets();
    int64_t left = all;
    for (int i = 0; left; ++i) {
        const int64_t slowest = std::bit_floor(static_cast<uint64_t>(left));
        if (i == set) {
            hwy::SetSupportedTargetsForTest(slowest);
            return true;
        }
        left &= ~slowest;
    }
    return false;
}

}  // namespace lucarne::gi::native
