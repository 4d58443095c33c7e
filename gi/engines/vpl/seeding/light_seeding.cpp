#include "gi/engines/vpl/seeding/light_seeding.h"

#include <algorithm>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/seeding/halton.h"
#include "gi/lighting/direct_light.h"

namespace lucarne::gi::vpl {
namespace {

Result<LightGBuffer> gbuffer(Frame& frame, const LightView& view, LightGBuffers& gbuffers) {
    LUCARNE_ASSIGN(const GBuffer* seen, gbuffers.look(frame.gl.device, view));
    return LightGBuffer{view.light, view.face, view.view, *view.cut, *seen};
}

}  // namespace

bool emits(const Frame& frame) {
    return std::any_of(frame.materials.begin(), frame.materials.end(), [](const Material& m) {
        return m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0;
    });
}

Result<void> LightSeeding::seed(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers,
                                const Buffer& materials, uint32_t count, uint64_t seed, Seeds& target) {
    Device& device = frame.gl.device;
    LUCARNE_TRY(device.reserve(target.lights, count * sizeof(VplLight), "virtual point lights"));
    std::vector<double> weights;
    for (const LightView& view : views) {
        LUCARNE_ASSIGN(const LightGBuffer from, gbuffer(frame, view, gbuffers));
        LUCARNE_ASSIGN(const double weight,
                       map_importance(device, from, materials, glossy(frame), importance_));
        weights.push_back(weight);
    }
    emitters_.running.clear();
    if (emits(frame)) LUCARNE_TRY(weigh_emitters(device, *frame.gl.cuts.light, materials, emitters_));
    weights.push_back(emitters_.flux());
    target.lights.upload_all(std::vector<VplLight>(count, kDeadLight));
    const std::vector<uint32_t> shares = share_out(weights, count);
    LUCARNE_TRY(
        seed_emitters(device, *frame.gl.cuts.light, materials, emitters_, shares.back(), seed, 0, target));
    uint32_t first = shares.back();
    for (size_t i = 0; i < views.size(); ++i) {
        if (shares[i] == 0) continue;
        LUCARNE_ASSIGN(const LightGBuffer from, gbuffer(frame, views[i], gbuffers));
        if (views.size() > 1)
            LUCARNE_TRY(map_importance(device, from, materials, glossy(frame), importance_));
        LUCARNE_TRY(seed_view(device, from, importance_, materials, halton_points(shares[i], seed, i), first,
                              target));
        first += shares[i];
    }
    settle_lights(target, count);
    return {};
}

}  // namespace lucarne::gi::vpl
