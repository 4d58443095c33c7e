#include "gi/vpl/shadow_maps.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "gi/shared/surfel.h"
#include "gi/vpl/bindings.h"
#include "gi/vpl/vpl_light.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kSideStep = 8;           // so that three levels of 2 x 2 blocks never cross a map's border
constexpr double kSplatTexels = 1.6;        // radius of the thinned splats
constexpr uint32_t kNothing = 0xffffffffu;  // parabolic.glsl
constexpr size_t kCasterBytes = 4 * sizeof(uint32_t);  // casters.glsl
constexpr size_t kQueueHeader = 4 * sizeof(uint32_t);  // queue.glsl
constexpr uint32_t kLargeDiscs = 65535;  // a workgroup each: the least that OpenGL promises of them
constexpr uint32_t kLargeGroup = 16;     // local size of splat_large.comp
constexpr size_t kPairBytes = 2 * sizeof(uint32_t);
constexpr uint32_t kQueuePairs =
    2 << 20;  // 16 MiB; a run of an atlas of 2048 x 2048 for 256 VPLs has some 450 000

void set_layout(const Program& program, const AtlasLayout& layout) {
    program.set("map_side", layout.side);
    program.set("maps", layout.maps);
    program.set("splat_angle", layout.splat_angle);
}

struct IdRange {
    uint32_t first, count;
};

/// The VPLs that enter.comp tries next, as uniforms (see there).
void set_run(const Program& enter, std::span<const VplLight> lights, uint32_t first) {
    std::vector<float> positions, normals;
    for (const VplLight& l : lights.subspan(first, kRunMaps)) {
        const glm::vec4 centre = map_centre(l);
        positions.insert(positions.end(), {centre.x, centre.y, centre.z, 0.0f});
        normals.insert(normals.end(), {l.normal.x, l.normal.y, l.normal.z, 0.0f});
    }
    enter.set("first_map", first);
    enter.set_block("run_position", positions);
    enter.set_block("run_normal", normals);
}

Result<void> pull_push(Device& device, const ShadowMaps& maps) {
    LUCARNE_ASSIGN(const Program* pull, device.program("gi/vpl/pull.comp"));
    LUCARNE_ASSIGN(const Program* push, device.program("gi/vpl/push.comp"));
    const AtlasLayout& layout = maps.layout;
    maps.atlas.bind(kBindAtlas);
    maps.coarse.bind(kBindCoarse);
    const auto run = [&](const Program& program, uint32_t level) {
        const uint32_t side = layout.side >> level;
        set_layout(program, layout);
        program.set("level", level);
        program.dispatch(side, side, layout.maps);
    };
    for (uint32_t level = 1; level <= layout.levels; ++level) run(*pull, level);
    for (uint32_t level = layout.levels; level-- > 0;) run(*push, level);
    return {};
}

/// Draws the surfels of the range into the run of maps that is set in `enter`. A range with more pairs than
/// the queue holds (large maps close to surfaces) is drawn in halves; a single surfel has kRunMaps at most.
struct SplatPrograms {
    const Program *enter, *draw, *draw_large;
};

void splat_range(const SplatPrograms& splat, IdRange range, Buffer& queue) {
    queue.upload_all(std::vector<uint32_t>(kQueueHeader / sizeof(uint32_t), 0));
    splat.enter->set("first_id", range.first);
    splat.enter->set("id_end", range.first + range.count);
    splat.enter->dispatch(range.count);
    const uint32_t pairs = queue.download_all<uint32_t>(1)[0];
    if (pairs > kQueuePairs) {
        const uint32_t half = range.count / 2;
        splat_range(splat, {range.first, half}, queue);
        splat_range(splat, {range.first + half, range.count - half}, queue);
        return;
    }
    splat.draw->dispatch(pairs);
    const uint32_t large = std::min(queue.download_all<uint32_t>(2)[1], kLargeDiscs);
    splat.draw_large->dispatch(large * kLargeGroup);
}

Result<void> splat(Device& device, const DeviceCut& cut, uint32_t ids, const Seeds& seeds, uint32_t seed,
                   ShadowMaps& target) {
    LUCARNE_ASSIGN(const Program* casters, device.program("gi/vpl/casters.comp"));
    LUCARNE_ASSIGN(const Program* enter, device.program("gi/vpl/enter.comp"));
    LUCARNE_ASSIGN(const Program* draw, device.program("gi/vpl/splat.comp"));
    LUCARNE_ASSIGN(const Program* draw_large, device.program("gi/vpl/splat_large.comp"));
    const SplatPrograms programs{enter, draw, draw_large};
    cut.bind();
    seeds.lights.bind(kBindLights);
    target.casters.bind(kBindCasters);
    target.atlas.bind(kBindAtlas);
    target.queue.bind(kBindQueue);
    target.large.bind(kBindLarge);
    casters->dispatch(ids);
    for (const Program* program : {enter, draw, draw_large}) set_layout(*program, target.layout);
    enter->set("seed", seed);
    const uint32_t runs = (target.layout.maps + kRunMaps - 1) / kRunMaps;
    for (uint32_t run = 0; run < runs; ++run) {
        set_run(*enter, seeds.host_lights, run * kRunMaps);
        splat_range(programs, {0, ids}, target.queue);
    }
    return {};
}

}  // namespace

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
    // A map shows 2 pi sr in pi/4 side^2 texels: the mean texel is as wide as a square of that solid angle.
    const double texel_angle = std::sqrt(8.0) / layout.side;
    layout.splat_angle = static_cast<float>(kSplatTexels * texel_angle);
    layout.levels = 1;
    return layout;
}

Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds,
                              const AtlasLayout& layout, uint32_t seed, PassTimes& times,
                              ShadowMaps& target) {
    const uint32_t ids = cut.blocks() * kBlockSurfels;
    LUCARNE_TRY(device.reserve(target.atlas, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    LUCARNE_TRY(device.reserve(target.coarse, layout.coarse_texels() * sizeof(uint32_t), "ISM pyramid"));
    LUCARNE_TRY(device.reserve(target.casters, size_t{ids} * kCasterBytes, "ISM casters"));
    LUCARNE_TRY(device.reserve(target.queue, kQueueHeader + kQueuePairs * kPairBytes, "ISM queue"));
    LUCARNE_TRY(device.reserve(target.large, kLargeDiscs * sizeof(uint32_t), "ISM queue"));
    target.layout = layout;
    times.begin("ISM splat");
    target.atlas.clear(kNothing);
    if (ids > 0) LUCARNE_TRY(splat(device, cut, ids, seeds, seed, target));
    times.end();
    times.begin("ISM pull-push");
    LUCARNE_TRY(pull_push(device, target));
    times.end();
    return {};
}

}  // namespace lucarne::gi::vpl
