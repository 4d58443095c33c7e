#include "gi/engines/vpl/shadow_maps/shadow_maps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kSideStep = 8;     // so that 2 x 2 blocks of three levels never cross the border of a map
constexpr double kSplatTexels = 1.6;  // radius of the thinned splats
constexpr uint32_t kNothing = 0xffffffffu;             // parabolic.glsl
constexpr size_t kCasterBytes = 4 * sizeof(uint32_t);  // casters.glsl
constexpr size_t kBoundsBytes = 8 * sizeof(float);     // queue.glsl, as the next three
constexpr uint32_t kRunMaps = 256;
constexpr size_t kQueueHeader = 4 * sizeof(uint32_t);
constexpr size_t kPairBytes = 2 * sizeof(uint32_t);
// Room of the queue: an atlas of 2048 x 2048 has some 2M pairs. The least room is what one block may need.
// On a device with little memory the queue takes no more than this share of it.
constexpr uint64_t kMostPairs = 4 << 20, kLeastPairs = uint64_t{kBlockSurfels} * kRunMaps, kQueueShare = 16;
constexpr uint32_t kLargeGroups = 65535;  // workgroups that OpenGL guarantees; they share the large discs
constexpr uint32_t kLargeGroup = 16;      // local size of splat_large.comp

struct Range {
    uint32_t first, end;
};

Result<void> pull_push(Device& device, const ShadowMaps& maps) {
    LUCARNE_ASSIGN(const Program* pull, device.program("gi/engines/vpl/shadow_maps/pull.comp"));
    LUCARNE_ASSIGN(const Program* push, device.program("gi/engines/vpl/shadow_maps/push.comp"));
    const AtlasLayout& layout = maps.layout;
    maps.atlas.bind(kBindAtlas);
    maps.coarse.bind(kBindCoarse);
    const auto run = [&](const Program& program, uint32_t level) {
        const uint32_t side = layout.side >> level;
        set_layout(program, layout);
        program.set("maps", layout.maps);
        program.set("level", level);
        program.dispatch(side, side, layout.maps);
    };
    for (uint32_t level = 1; level <= layout.levels; ++level) run(*pull, level);
    for (uint32_t level = layout.levels; level-- > 0;) run(*push, level);
    return {};
}

Defines source_defines(const ShadowMaps& maps) {
    return maps.id_bits ? Defines{{"LUCARNE_SOURCES", "1"}} : Defines{};
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
    const Program *meet, *enter, *draw, *draw_large;
};

/// Draws the surfels of a range of blocks into a range of maps. If the range has more pairs than the queue
/// holds (large maps among many surfaces), it is drawn in halves; a single block has at most kBlockSurfels
/// pairs per map.
void splat_range(const SplatPrograms& splat, Range blocks, Range maps, uint32_t places, ShadowMaps& target) {
    target.queue.upload_all(std::vector<uint32_t>(kQueueHeader / sizeof(uint32_t), 0));
    splat.meet->set("first_block", blocks.first);
    splat.meet->set("block_end", blocks.end);
    splat.meet->set("map_end", maps.end);
    splat.enter->set("first_block", blocks.first);
    splat.enter->set("places", places);
    for (const Program* program : {splat.meet, splat.enter}) program->set("first_map", maps.first);
    splat.meet->dispatch(blocks.end - blocks.first, kRunMaps / 32);
    splat.enter->dispatch((blocks.end - blocks.first) * kBlockSurfels);
    const uint32_t pairs = target.queue.download_all<uint32_t>(1)[0];
    if (pairs > places) {
        const uint32_t half = (blocks.first + blocks.end) / 2;
        splat_range(splat, {blocks.first, half}, maps, places, target);
        splat_range(splat, {half, blocks.end}, maps, places, target);
        return;
    }
    splat.draw->dispatch(pairs);
    const uint32_t large = std::min(target.queue.download_all<uint32_t>(2)[1], kLargeGroups);
    splat.draw_large->dispatch(large * kLargeGroup);
}

Result<void> splat(Device& device, const DeviceCut& cut, const Seeds& seeds, ShadowMaps& target) {
    if (cut.blocks() == 0) return {};
    LUCARNE_ASSIGN(const Program* meet, device.program("gi/engines/vpl/shadow_maps/meet.comp"));
    LUCARNE_ASSIGN(const Program* enter, device.program("gi/engines/vpl/shadow_maps/enter.comp"));
    const Defines defines = source_defines(target);
    LUCARNE_ASSIGN(const Program* draw, device.program("gi/engines/vpl/shadow_maps/splat.comp", defines));
    LUCARNE_ASSIGN(const Program* draw_large,
                   device.program("gi/engines/vpl/shadow_maps/splat_large.comp", defines));
    target.casters.bind_texels(kUnitCasters, TexelView::four_words);
    LUCARNE_TRY(device.reserve(target.meetings, size_t{cut.blocks()} * kRunMaps / 8, "ISM queue"));
    const uint32_t places = queue_places(device);
    LUCARNE_TRY(device.reserve(target.queue, kQueueHeader + places * kPairBytes, "ISM queue"));
    LUCARNE_TRY(device.reserve(target.large, places * sizeof(uint32_t), "ISM queue"));
    seeds.lights.bind_texels(kUnitLights, TexelView::four_words);
    target.bounds.bind_texels(kUnitBounds, TexelView::four_words);
    target.atlas.bind(kBindAtlas);
    target.fringe.bind(kBindFringe);
    target.queue.bind(kBindQueue);
    target.large.bind(kBindLarge);
    target.meetings.bind(kBindMeetings);
    const SplatPrograms programs{meet, enter, draw, draw_large};
    for (const Program* program : {meet, enter}) program->set("splat_angle", target.layout.splat_angle);
    for (const Program* program : {enter, draw, draw_large}) program->set("cut_size", cut.size());
    for (const Program* program : {draw, draw_large}) {
        set_layout(*program, target.layout);
        program->set("id_bits", target.id_bits);
    }
    if (target.id_bits) {
        target.sources.bind(kBindSources);
        target.fringe_sources.bind(kBindFringeSources);
    }
    for (uint32_t first = 0; first < target.layout.maps; first += kRunMaps)
        splat_range(programs, {0, cut.blocks()}, {first, std::min(first + kRunMaps, target.layout.maps)},
                    places, target);
    return {};
}

}  // namespace

void set_layout(const Program& program, const AtlasLayout& layout) {
    program.set("map_side", layout.side);
    program.set("splat_angle", layout.splat_angle);
}

size_t AtlasLayout::coarse_texels() const {
    size_t sum = 0;
    for (uint32_t level = 1; level <= levels; ++level)
        sum += size_t{maps} * (side >> level) * (side >> level);
    return sum;
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
    layout.levels = 1;
    return layout;
}

Result<void> decode_casters(Device& device, const DeviceCut& cut, ShadowMaps& target) {
    LUCARNE_ASSIGN(const Program* casters, device.program("gi/engines/vpl/shadow_maps/casters.comp"));
    LUCARNE_ASSIGN(const Program* bounds, device.program("gi/engines/vpl/shadow_maps/block_bounds.comp"));
    const size_t ids = size_t{cut.blocks()} * kBlockSurfels;
    LUCARNE_TRY(device.reserve(target.casters, ids * kCasterBytes, "ISM casters"));
    LUCARNE_TRY(device.reserve(target.bounds, cut.blocks() * kBoundsBytes, "ISM casters"));
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

Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds,
                              const AtlasLayout& layout, bool sources, PassTimes& times, ShadowMaps& target) {
    LUCARNE_TRY(device.reserve(target.atlas, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    LUCARNE_TRY(device.reserve(target.fringe, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    LUCARNE_TRY(device.reserve(target.coarse, layout.coarse_texels() * sizeof(uint32_t), "ISM pyramid"));
    target.layout = layout;
    target.id_bits = sources ? static_cast<uint32_t>(std::bit_width(cut.blocks() * kBlockSurfels)) : 0;
    if (sources) {
        LUCARNE_TRY(device.reserve(target.sources, layout.texels() * sizeof(uint32_t), "ISM sources"));
        LUCARNE_TRY(device.reserve(target.fringe_sources, layout.texels() * sizeof(uint32_t), "ISM sources"));
        target.sources.clear(kNothing);
        target.fringe_sources.clear(kNothing);
    }
    times.begin("ISM splat");
    target.atlas.clear(kNothing);
    target.fringe.clear(kNothing);
    LUCARNE_TRY(splat(device, cut, seeds, target));
    times.end();
    times.begin("ISM pull-push");
    LUCARNE_TRY(close(device, target));
    LUCARNE_TRY(pull_push(device, target));
    times.end();
    return {};
}

}  // namespace lucarne::gi::vpl
