#include "gi/vpl/shadow_maps.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "gi/shared/surfel.h"
#include "gi/vpl/bindings.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kSideStep = 8;  // so that three levels of 2 x 2 blocks never cross a map's border
constexpr double kSplatTexels = 1.3;  // radius of the thinned splats
constexpr uint32_t kNothing = 0xffffffffu;  // parabolic.glsl
constexpr uint32_t kClusterLights = 8;      // clusters.glsl

void set_layout(const Program& program, const AtlasLayout& layout) {
    program.set("map_side", layout.side);
    program.set("maps", layout.maps);
    program.set("splat_angle", layout.splat_angle);
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

}  // namespace

size_t AtlasLayout::coarse_texels() const {
    size_t sum = 0;
    for (uint32_t level = 1; level <= levels; ++level) sum += size_t{maps} * (side >> level) * (side >> level);
    return sum;
}

Result<AtlasLayout> atlas_layout(uint32_t atlas, uint32_t maps) {
    AtlasLayout layout;
    layout.maps = maps;
    if (maps == 0) return bad_arguments("vpl", "it needs at least one virtual point light", "raise --vpls");
    const double texels = static_cast<double>(atlas) * atlas;
    layout.side = static_cast<uint32_t>(std::sqrt(texels / maps)) / kSideStep * kSideStep;
    if (layout.side == 0)
        return bad_arguments("vpl", fmt::format("an atlas of {0} x {0} texels is too small for {1} VPLs", atlas, maps),
                             "raise --atlas or lower --vpls");
    // A map shows 2 pi sr in pi/4 side^2 texels: the mean texel is as wide as a square of that solid angle.
    const double texel_angle = std::sqrt(8.0) / layout.side;
    layout.splat_angle = static_cast<float>(kSplatTexels * texel_angle);
    layout.levels = 1;
    return layout;
}

Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Buffer& lights, const AtlasLayout& layout,
                              uint32_t seed, PassTimes& times, ShadowMaps& target) {
    LUCARNE_ASSIGN(const Program* cluster, device.program("gi/vpl/cluster.comp"));
    LUCARNE_ASSIGN(const Program* splat, device.program("gi/vpl/splat.comp"));
    LUCARNE_TRY(device.reserve(target.atlas, layout.texels() * sizeof(uint32_t), "ISM atlas"));
    LUCARNE_TRY(device.reserve(target.coarse, layout.coarse_texels() * sizeof(uint32_t), "ISM pyramid"));
    const uint32_t cluster_count = (layout.maps + kClusterLights - 1) / kClusterLights;
    LUCARNE_TRY(device.reserve(target.clusters, cluster_count * 4 * sizeof(float), "clusters of VPLs"));
    target.layout = layout;
    times.begin("ISM splat");
    target.atlas.clear(kNothing);
    lights.bind(kBindLights);
    target.clusters.bind(kBindClusters);
    set_layout(*cluster, layout);
    cluster->dispatch(cluster_count);
    if (cut.blocks() > 0) {
        cut.bind();
        target.atlas.bind(kBindAtlas);
        set_layout(*splat, layout);
        splat->set("seed", seed);
        splat->dispatch(cut.blocks() * kBlockSurfels);
    }
    times.end();
    times.begin("ISM pull-push");
    LUCARNE_TRY(pull_push(device, target));
    times.end();
    return {};
}

}  // namespace lucarne::gi::vpl
