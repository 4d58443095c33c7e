#include "gi/engines/vpl/redistribution/redistribution.h"

#include "gi/engines/vpl/bindings.h"

namespace lucarne::gi::vpl {

Result<void> redistribute(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                          const Buffer& materials, bool glossy, uint32_t seed, const Seeds& from,
                          Redistribution& scratch, Seeds& to) {
    Defines defines;
    if (glossy) defines.emplace_back("LUCARNE_GLOSSY", "1");
    if (scratch.best_candidate) defines.emplace_back("LUCARNE_BEST_CANDIDATE", "1");
    LUCARNE_ASSIGN(const Program* race,
                   device.program("gi/engines/vpl/redistribution/redistribute.comp", defines));
    LUCARNE_ASSIGN(const Program* combine,
                   device.program("gi/engines/vpl/redistribution/combine.comp", defines));
    const uint32_t count = maps.layout.maps;
    LUCARNE_TRY(device.reserve(to.lights, count * sizeof(VplLight), "virtual point lights"));
    LUCARNE_TRY(device.reserve(scratch.weight_sums, count * sizeof(float), "virtual point lights"));
    cut.bind();
    materials.bind(kBindMaterials);
    from.lights.bind_texels(kUnitLights, TexelView::four_words);
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    maps.sources.bind_texels(kUnitSources, TexelView::one_word);
    to.lights.bind(kBindLights);
    scratch.weight_sums.bind(kBindWeightSums);
    for (const Program* program : {race, combine}) {
        set_layout(*program, maps.layout);
        program->set("footprint_variance", scratch.footprint_variance);
    }
    combine->set("light_count", count);
    race->set("seed", seed);
    race->set("id_bits", maps.id_bits);
    constexpr uint32_t kRaceGroup = 64;  // redistribute.comp
    race->dispatch(count * kRaceGroup);
    scratch.weight_sums.bind_texels(kUnitWeightSums, TexelView::one_word);
    combine->dispatch(count);
    settle_lights(to, count);
    return {};
}

}  // namespace lucarne::gi::vpl
