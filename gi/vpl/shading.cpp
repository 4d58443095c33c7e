#include "gi/vpl/shading.h"

#include "gi/gbuffer/uniforms.h"
#include "gi/vpl/bindings.h"

namespace lucarne::gi::vpl {

Result<void> shade_panes(Frame& frame, const Buffer& materials, const Seeds& seeds, const ShadowMaps& maps,
                         bool glossy, Panes& target) {
    const Defines defines = glossy ? Defines{{"LUCARNE_GLOSSY", "1"}} : Defines{};
    LUCARNE_ASSIGN(const Program* shade, frame.device.program("gi/vpl/shade.comp", defines));
    LUCARNE_ASSIGN(const Program* merge, frame.device.program("gi/vpl/merge.comp", defines));
    const GBuffer& gbuffer = frame.gbuffer;
    const size_t bytes = size_t{gbuffer.width} * gbuffer.height * 4 * sizeof(float);
    LUCARNE_TRY(frame.device.reserve(target.diffuse, bytes, "indirect irradiance"));
    LUCARNE_TRY(
        frame.device.reserve(target.specular, glossy ? bytes : 4 * sizeof(float), "indirect specular light"));
    materials.bind(kBindMaterials);
    gbuffer.texels.bind_texels(kUnitGBuffer, TexelView::four_words);
    seeds.lights.bind_texels(kUnitLights, TexelView::four_words);
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    target.diffuse.bind(kBindDiffuse);
    target.specular.bind(kBindSpecular);
    target.diffuse.bind_texels(kUnitDiffuse, TexelView::four_floats);
    target.specular.bind_texels(kUnitSpecular, TexelView::four_floats);
    frame.radiance.bind(kBindRadiance);
    const uint32_t n = frame.settings.interleave;
    for (const Program* program : {shade, merge}) {
        program->set("map_side", maps.layout.side);
        program->set("splat_angle", maps.layout.splat_angle);
        program->set("light_count", maps.layout.maps);
        program->set("interleave", n);
        set(*program, "camera", frame.camera);
    }
    frame.times.begin("VPL shading");
    shade->dispatch((gbuffer.width + n - 1) / n, (gbuffer.height + n - 1) / n, n * n);
    frame.times.end();
    frame.times.begin("VPL merge");
    merge->dispatch(gbuffer.width, gbuffer.height);
    frame.times.end();
    return {};
}

}  // namespace lucarne::gi::vpl
