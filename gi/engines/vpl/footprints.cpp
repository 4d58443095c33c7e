#include "gi/engines/vpl/footprints.h"

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/groups.h"

namespace lucarne::gi::vpl {

Result<void> trim_footprints(Device& device, const ShadowMaps& maps, float shrink, Seeds& seeds) {
    LUCARNE_ASSIGN(const Program* trim, device.program("gi/engines/vpl/footprints.comp"));
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    seeds.lights.bind(kBindLights);
    set_layout(*trim, maps.layout);
    trim->set("shrink", shrink);
    trim->dispatch(maps.layout.maps * kTrimGroup);
    return {};
}

}  // namespace lucarne::gi::vpl
