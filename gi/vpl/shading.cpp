#include "gi/vpl/shading.h"

#include "gi/vpl/bindings.h"

namespace lucarne::gi::vpl {
namespace {

Defines defines_of(bool glossy) {
    return glossy ? Defines{{"LUCARNE_GLOSSY", "1"}} : Defines{};
}

void bind_inputs(const Frame& frame, const Seeds& seeds, const ShadowMaps& maps, const Panes& panes) {
    frame.gbuffer.texels.bind(kBindGBuffer);
    seeds.lights.bind(kBindLights);
    maps.atlas.bind(kBindAtlas);
    panes.diffuse.bind(kBindDiffuse);
    panes.specular.bind(kBindSpecular);
}

void set_sizes(const Program& program, const EngineSettings& settings, const AtlasLayout& layout) {
    program.set("map_side", layout.side);
    program.set("splat_angle", layout.splat_angle);
    program.set("light_count", layout.maps);
    program.set("interleave", settings.interleave);
}

}  // namespace

Result<void> shade_panes(Frame& frame, const Seeds& seeds, const ShadowMaps& maps, bool glossy, Panes& target) {
    LUCARNE_ASSIGN(const Program* shade, frame.device.program("gi/vpl/shade.comp", defines_of(glossy)));
    const GBuffer& gbuffer = frame.gbuffer;
    const size_t bytes = size_t{gbuffer.width} * gbuffer.height * 4 * sizeof(float);
    LUCARNE_TRY(frame.device.reserve(target.diffuse, bytes, "indirect irradiance"));
    LUCARNE_TRY(frame.device.reserve(target.specular, glossy ? bytes : 4 * sizeof(float), "indirect specular light"));
    bind_inputs(frame, seeds, maps, target);
    set_sizes(*shade, frame.settings, maps.layout);
    const uint32_t n = frame.settings.interleave;
    shade->dispatch((gbuffer.width + n - 1) / n, (gbuffer.height + n - 1) / n, n * n);
    return {};
}

Result<void> merge_panes(Frame& frame, const MergeInput& input) {
    Defines defines = defines_of(input.glossy);
    if (input.panes) defines.emplace_back("LUCARNE_INDIRECT", "1");
    LUCARNE_ASSIGN(const Program* merge, frame.device.program("gi/vpl/merge.comp", defines));
    if (input.panes) {
        bind_inputs(frame, *input.seeds, *input.maps, *input.panes);
        set_sizes(*merge, frame.settings, input.maps->layout);
    }
    frame.gbuffer.texels.bind(kBindGBuffer);
    frame.radiance.bind(kBindRadiance);
    merge->set("add_direct", input.direct ? 1u : 0u);
    merge->dispatch(frame.gbuffer.width, frame.gbuffer.height);
    return {};
}

}  // namespace lucarne::gi::vpl
