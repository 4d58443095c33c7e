#include "gi/engines/vpl/redistribution/redistribution.h"

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/groups.h"

namespace lucarne::gi::vpl {

namespace {

Defines defines(bool glossy, const Redistribution& how) {
    Defines defines;
    if (glossy) defines.emplace_back("LUCARNE_GLOSSY", "1");
    if (how.best_candidate) defines.emplace_back("LUCARNE_BEST_CANDIDATE", "1");
    return defines;
}

/// Binds and sets what both programs read.
void bind(const Program& program, const DeviceCut& cut, const ShadowMaps& maps, const Buffer& materials,
          const Seeds& from, const Redistribution& scratch, const Seeds& to) {
    cut.bind();
    materials.bind(kBindMaterials);
    from.lights.bind_texels(kUnitLights, TexelView::four_words);
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    maps.sources.bind_texels(kUnitSources, TexelView::one_word);
    to.lights.bind(kBindLights);
    set_layout(program, maps.layout);
    program.set("footprint_variance", scratch.footprint_variance);
}

}  // namespace

Result<void> race_maps(Device& device, const DeviceCut& cut, const ShadowMaps& maps, const Buffer& materials,
                       bool glossy, uint32_t seed, const Seeds& from, uint32_t first, uint32_t end,
                       Redistribution& scratch, Seeds& to) {
    LUCARNE_ASSIGN(const Program* race, device.program("gi/engines/vpl/redistribution/redistribute.comp",
                                                       defines(glossy, scratch)));
    const uint32_t count = maps.layout.maps;
    LUCARNE_TRY(device.reserve(to.lights, count * sizeof(VplLight), "virtual point lights"));
    LUCARNE_TRY(device.reserve(scratch.weight_sums, count * sizeof(float), "virtual point lights"));
    bind(*race, cut, maps, materials, from, scratch, to);
    scratch.weight_sums.bind(kBindWeightSums);
    race->set("seed", seed);
    race->set("id_bits", maps.id_bits);
    race->set("first_map", first);
    race->dispatch((end - first) * kRaceGroup);
    return {};
}

Result<void> combine_races(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                           const Buffer& materials, bool glossy, const Seeds& from, Redistribution& scratch,
                           Seeds& to) {
    LUCARNE_ASSIGN(const Program* combine,
                   device.program("gi/engines/vpl/redistribution/combine.comp", defines(glossy, scratch)));
    const uint32_t count = maps.layout.maps;
    bind(*combine, cut, maps, materials, from, scratch, to);
    scratch.weight_sums.bind_texels(kUnitWeightSums, TexelView::one_word);
    combine->set("light_count", count);
    combine->dispatch(count);
    settle_lights(to, count);
    return {};
}

Result<void> redistribute(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                          const Buffer& materials, bool glossy, uint32_t seed, const Seeds& from,
                          Redistribution& scratch, Seeds& to) {
    LUCARNE_TRY(
        race_maps(device, cut, maps, materials, glossy, seed, from, 0, maps.layout.maps, scratch, to));
    return combine_races(device, cut, maps, materials, glossy, from, scratch, to);
}

}  // namespace lucarne::gi::vpl
