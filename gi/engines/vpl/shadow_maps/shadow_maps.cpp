#include "gi/engines/vpl/shadow_maps/shadow_maps.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/native/close.h"
#include "gi/engines/vpl/shadow_maps/native/splat.h"
#include "gi/engines/vpl/shadow_maps/queue.h"
#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kSideStep = 8;     // whole vectors of 8 texels: native/close.cpp
constexpr double kSplatTexels = 1.6;  // radius of the thinned splats
constexpr size_t kPairBytes = 2 * sizeof(uint32_t);
// Room of the queue: an atlas of 2048 x 2048 has some 2M pairs. The least room is what one block may need.
// On a device with little memory the queue takes no more than this share of it.
constexpr uint64_t kMostPairs = 4 << 20, kLeastPairs = uint64_t{kBlockSurfels} * kRunMaps, kQueueShare = 16;

struct Range {
    uint32_t first, end;
};
struct BlocksAndMaps {
    Range blocks, maps;
};

Result<void> pull_push(Device& device, const ShadowMaps& maps) {
    LUCARNE_ASSIGN(const Program* pull, device.program("gi/engines/vpl/shadow_maps/pull.comp"));
    LUCARNE_ASSIGN(const Program* push, device.program("gi/engines/vpl/shadow_maps/push.comp"));
    const AtlasLayout& layout = maps.layout;
    maps.atlas.bind(kBindAtlas);
    maps.coarse.bind(kBindCoarse);
    const auto run = [&](const Program& program, uint32_t side) {
        set_layout(program, layout);
        program.dispatch(side, side, layout.maps);
    };
    run(*pull, layout.side / 2);
    run(*push, layout.side);
    return {};
}

Defines source_defines(const ShadowMaps& maps) {
    return maps.id_bits ? Defines{{"LUCARNE_SOURCES", "1"}} : Defines{};
}

/// Closes and fills all maps in C++, see close() and pull_push().
Result<void> close_natively(ShadowMaps& maps) {
    {
        LUCARNE_ASSIGN(const MappedBuffer atlas, maps.atlas.map());
        LUCARNE_ASSIGN(const MappedBuffer fringe, maps.fringe.map());
        native::CloseMemory memory{.cores = atlas.as<const uint32_t>().data(),
                                   .fringe = fringe.as<uint32_t>().data(),
                                   .maps = maps.layout.maps,
                                   .side = maps.layout.side,
                                   .splat_angle = maps.layout.splat_angle};
        if (maps.id_bits == 0) {
            native::close_and_fill(memory);
        } else {
            LUCARNE_ASSIGN(const MappedBuffer sources, maps.sources.map());
            LUCARNE_ASSIGN(const MappedBuffer fringe_sources, maps.fringe_sources.map());
            memory.sources = sources.as<const uint32_t>().data();
            memory.fringe_sources = fringe_sources.as<uint32_t>().data();
            native::close_and_fill(memory);
        }
    }
    std::swap(maps.atlas, maps.fringe);
    std::swap(maps.sources, maps.fringe_sources);
    return {};
}

/// Completes the atlas: the drawn cores, plus the fringes that close holes between them (fringe.glsl).
Result<void> close(Device& device, ShadowMaps& maps) {
    LUCARNE_ASSIGN(const Program* close,
                   device.program("gi/engines/vpl/shadow_maps/close.comp", source_defines(maps)));
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    maps.fringe.bind(kBindFringe);
    if (maps.id_bits) {
        maps.sources.bind(kBindSources);
        maps.fringe_sources.bind(kBindFringeSources);
    }
    set_layout(*close, maps.layout);
    close->dispatch(maps.layout.side, maps.layout.side, maps.layout.maps);
    std::swap(maps.atlas, maps.fringe);
    std::swap(maps.sources, maps.fringe_sources);
    return {};
}

uint32_t queue_places(const Device& device) {
    const uint64_t affordable = device.memory_cap() / kQueueShare / (kPairBytes + sizeof(uint32_t));
    return static_cast<uint32_t>(std::clamp(affordable, kLeastPairs, kMostPairs));
}

struct SplatPrograms {
    const Program *cull, *enqueue, *plan, *draw, *draw_large;
};

/// Draws the surfels of a range of blocks into a range of maps, unless it has more pairs than the queue
/// holds.
void splat_range(const SplatPrograms& splat, const BlocksAndMaps& range, uint32_t queue,
                 const ShadowMaps& target) {
    const auto& [blocks, maps] = range;
    for (const Program* program : {splat.enqueue, splat.plan, splat.draw, splat.draw_large})
        program->set("queue", queue);
    splat.cull->set("first_block", blocks.first);
    splat.cull->set("block_end", blocks.end);
    splat.cull->set("map_end", maps.end);
    splat.enqueue->set("first_block", blocks.first);
    for (const Program* program : {splat.cull, splat.enqueue}) program->set("first_map", maps.first);
    const size_t header = queue * sizeof(SplatQueue);
    splat.cull->dispatch(blocks.end - blocks.first, kRunWords);
    splat.enqueue->dispatch((blocks.end - blocks.first) * kBlockSurfels);
    splat.plan->dispatch(1);
    splat.draw->dispatch_indirect(target.queues, header + offsetof(SplatQueue, pair_groups));
    splat.plan->dispatch(1);
    splat.draw_large->dispatch_indirect(target.queues, header + offsetof(SplatQueue, large_groups));
}

/// Draws all ranges. The host learns only after the last one which of them had too many pairs (large maps
/// among many surfaces); those are drawn in halves. A single block has at most kBlockSurfels pairs per map,
/// for which there is room.
Result<void> splat_ranges(Device& device, const SplatPrograms& splat, std::vector<BlocksAndMaps> ranges,
                          uint32_t places, ShadowMaps& target) {
    while (!ranges.empty()) {
        LUCARNE_TRY(device.reserve(target.queues, ranges.size() * sizeof(SplatQueue), "ISM queue"));
        target.queues.upload_all(std::vector<SplatQueue>(ranges.size()));
        target.queues.bind(kBindQueues);
        for (size_t i = 0; i < ranges.size(); ++i)
            splat_range(splat, ranges[i], static_cast<uint32_t>(i), target);
        const auto drawn = target.queues.download_all<SplatQueue>(ranges.size());
        std::vector<BlocksAndMaps> halves;
        for (size_t i = 0; i < ranges.size(); ++i) {
            if (drawn[i].pair_count <= places) continue;
            const auto& [blocks, maps] = ranges[i];
            const uint32_t half = (blocks.first + blocks.end) / 2;
            assert(half > blocks.first);
            halves.push_back({{blocks.first, half}, maps});
            halves.push_back({{half, blocks.end}, maps});
        }
        ranges = std::move(halves);
    }
    return {};
}

/// Draws a range of maps in C++.
Result<void> splat_natively(const DeviceCut& cut, const Seeds& seeds, const Range& maps,
                            const ShadowMaps& target) {
    const size_t first = size_t{maps.first} * target.layout.side * target.layout.side;
    LUCARNE_ASSIGN(const MappedBuffer casters, target.casters.map());
    LUCARNE_ASSIGN(const MappedBuffer bounds, target.bounds.map());
    LUCARNE_ASSIGN(const MappedBuffer lights, seeds.lights.map());
    LUCARNE_ASSIGN(const MappedBuffer atlas, target.atlas.map());
    LUCARNE_ASSIGN(const MappedBuffer fringe, target.fringe.map());
    native::SplatMemory memory{
        .casters = casters.as<const uint32_t>().data(),
        .bounds = bounds.as<const float>().data(),
        .blocks = cut.blocks(),
        .lights = lights.as<const VplLight>().subspan(maps.first, maps.end - maps.first),
        .atlas = atlas.as<uint32_t>().data() + first,
        .fringe = fringe.as<uint32_t>().data() + first};
    const native::SplatLayout layout{.side = target.layout.side,
                                     .splat_angle = target.layout.splat_angle,
                                     .cut_size = cut.size(),
                                     .id_bits = target.id_bits};
    if (target.id_bits == 0) {
        native::splat(memory, layout);
        return {};
    }
    LUCARNE_ASSIGN(const MappedBuffer sources, target.sources.map());
    LUCARNE_ASSIGN(const MappedBuffer fringe_sources, target.fringe_sources.map());
    memory.sources = sources.as<uint32_t>().data() + first;
    memory.fringe_sources = fringe_sources.as<uint32_t>().data() + first;
    native::splat(memory, layout);
    return {};
}

Result<void> splat(Device& device, const DeviceCut& cut, const Seeds& seeds, const Range& maps,
                   ShadowMaps& target) {
    if (cut.blocks() == 0) return {};
    if (device.native_passes()) return splat_natively(cut, seeds, maps, target);
    LUCARNE_ASSIGN(const Program* cull, device.program("gi/engines/vpl/shadow_maps/cull.comp"));
    LUCARNE_ASSIGN(const Program* enqueue, device.program("gi/engines/vpl/shadow_maps/enqueue.comp"));
    LUCARNE_ASSIGN(const Program* plan, device.program("gi/engines/vpl/shadow_maps/plan.comp"));
    const Defines defines = source_defines(target);
    LUCARNE_ASSIGN(const Program* draw, device.program("gi/engines/vpl/shadow_maps/splat.comp", defines));
    LUCARNE_ASSIGN(const Program* draw_large,
                   device.program("gi/engines/vpl/shadow_maps/splat_large.comp", defines));
    target.casters.bind_texels(kUnitCasters, TexelView::four_words);
    const size_t meeting_bytes = size_t{cut.blocks()} * kRunWords * sizeof(uint32_t);
    LUCARNE_TRY(device.reserve(target.meetings, meeting_bytes, "ISM queue"));
    const uint32_t places = queue_places(device);
    LUCARNE_TRY(device.reserve(target.pairs, places * kPairBytes, "ISM queue"));
    LUCARNE_TRY(device.reserve(target.large, places * sizeof(uint32_t), "ISM queue"));
    seeds.lights.bind_texels(kUnitLights, TexelView::four_words);
    target.bounds.bind_texels(kUnitBounds, TexelView::four_words);
    target.atlas.bind(kBindAtlas);
    target.fringe.bind(kBindFringe);
    target.pairs.bind(kBindPairs);
    target.large.bind(kBindLarge);
    target.meetings.bind(kBindMeetings);
    const SplatPrograms programs{cull, enqueue, plan, draw, draw_large};
    for (const Program* program : {enqueue, plan}) program->set("places", places);
    for (const Program* program : {cull, enqueue}) program->set("splat_angle", target.layout.splat_angle);
    for (const Program* program : {enqueue, draw, draw_large}) program->set("cut_size", cut.size());
    for (const Program* program : {draw, draw_large}) {
        set_layout(*program, target.layout);
        program->set("id_bits", target.id_bits);
    }
    if (target.id_bits) {
        target.sources.bind(kBindSources);
        target.fringe_sources.bind(kBindFringeSources);
    }
    std::vector<BlocksAndMaps> ranges;
    for (uint32_t first = maps.first; first < maps.end; first += kRunMaps)
        ranges.push_back({{0, cut.blocks()}, {first, std::min(first + kRunMaps, maps.end)}});
    return splat_ranges(device, programs, std::move(ranges), places, target);
}

}  // namespace

void set_layout(const Program& program, const AtlasLayout& layout) {
    program.set("map_side", layout.side);
    program.set("splat_angle", layout.splat_angle);
}

Result<AtlasLayout> atlas_layout(uint32_t atlas, uint32_t maps) {
    AtlasLayout layout;
    layout.maps = maps;
    if (maps == 0) return bad_arguments("vpl", "it needs at least one virtual point light", "raise --vpls");
    const double texels = static_cast<double>(atlas) * atlas;
    layout.side = static_cast<uint32_t>(std::sqrt(texels / maps)) / kSideStep * kSideStep;
    if (layout.side == 0)
        return bad_arguments(
            "vpl", fmt::format("an atlas of {0} x {0} texels is too small for {1} VPLs", atlas, maps),
            "raise --atlas or lower --vpls");
    // A map shows 2 pi sr in pi/4 side^2 texels: the mean texel is as wide as a square of its solid angle.
    const double texel_angle = std::sqrt(8.0) / layout.side;
    layout.splat_angle = static_cast<float>(kSplatTexels * texel_angle);
    return layout;
}

Result<void> decode_casters(Device& device, const DeviceCut& cut, ShadowMaps& target) {
    LUCARNE_ASSIGN(const Program* casters, device.program("gi/engines/vpl/shadow_maps/casters.comp"));
    LUCARNE_ASSIGN(const Program* bounds, device.program("gi/engines/vpl/shadow_maps/block_bounds.comp"));
    const size_t ids = size_t{cut.blocks()} * kBlockSurfels;
    LUCARNE_TRY(device.reserve(target.casters, ids * kCasterWords * sizeof(uint32_t), "ISM casters"));
    LUCARNE_TRY(device.reserve(target.bounds, cut.blocks() * kBoundsWords * sizeof(float), "ISM casters"));
    for (const Program* program : {casters, bounds}) program->set("cut_size", cut.size());
    bounds->set("block_count", cut.blocks());
    cut.bind();
    target.casters.bind(kBindCasters);
    casters->dispatch(static_cast<uint32_t>(ids));
    target.casters.bind_texels(kUnitCasters, TexelView::four_words);
    target.bounds.bind(kBindBounds);
    bounds->dispatch(cut.blocks());
    return {};
}

Result<void> clear_shadow_maps(Device& device, const DeviceCut& cut, const AtlasLayout& layout, bool sources,
                               ShadowMaps& target) {
    LUCARNE_TRY(device.reserve(target.atlas, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    LUCARNE_TRY(device.reserve(target.fringe, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    if (!device.native_passes())
        LUCARNE_TRY(device.reserve(target.coarse, layout.coarse_texels() * sizeof(uint32_t), "ISM atlas"));
    target.layout = layout;
    target.id_bits = sources ? static_cast<uint32_t>(std::bit_width(cut.blocks() * kBlockSurfels)) : 0;
    target.atlas.clear(kNothing);
    target.fringe.clear(kNothing);
    if (!sources) return {};
    LUCARNE_TRY(device.reserve(target.sources, layout.texels() * sizeof(uint32_t), "ISM sources"));
    LUCARNE_TRY(device.reserve(target.fringe_sources, layout.texels() * sizeof(uint32_t), "ISM sources"));
    target.sources.clear(kNothing);
    target.fringe_sources.clear(kNothing);
    return {};
}

Result<void> splat_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds, uint32_t first,
                               uint32_t end, PassTimes& times, ShadowMaps& target) {
    times.begin("ISM splat");
    const auto drawn = splat(device, cut, seeds, {first, end}, target);
    times.end();
    return drawn;
}

Result<void> close_shadow_maps(Device& device, PassTimes& times, ShadowMaps& target) {
    times.begin("ISM pull-push");
    if (device.native_passes()) {
        LUCARNE_TRY(close_natively(target));
    } else {
        LUCARNE_TRY(close(device, target));
        LUCARNE_TRY(pull_push(device, target));
    }
    times.end();
    return {};
}

Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds,
                              const AtlasLayout& layout, bool sources, PassTimes& times, ShadowMaps& target) {
    LUCARNE_TRY(clear_shadow_maps(device, cut, layout, sources, target));
    LUCARNE_TRY(splat_shadow_maps(device, cut, seeds, 0, layout.maps, times, target));
    return close_shadow_maps(device, times, target);
}

}  // namespace lucarne::gi::vpl
