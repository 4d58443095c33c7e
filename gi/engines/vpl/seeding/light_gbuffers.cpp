#include "gi/engines/vpl/seeding/light_gbuffers.h"

#include <algorithm>
#include <utility>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/seeding/halton.h"
#include "gi/gl_frame.h"

namespace lucarne::gi::vpl {
namespace {

constexpr size_t kLeastHeld = 6;  // views: the six of a point light
// More views are held if they fit into this share of the device's memory. A view that is not held is drawn
// three times a frame.
constexpr size_t kHeldShare = 4;

}  // namespace

bool emits(const Frame& frame) {
    return std::any_of(frame.materials.begin(), frame.materials.end(), [](const Material& m) {
        return m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0;
    });
}

void LightGBuffers::begin(const Frame& frame, const SkyDirections& sky) {
    views_ = light_views(frame, sky);
    size_t largest = 1;
    for (const LightView& v : views_) largest = std::max(largest, size_t{v.view.width} * v.view.height);
    const size_t fit =
        frame.gl.device.memory_cap() / kHeldShare / (largest * (sizeof(GBufferTexel) + sizeof(uint32_t)));
    held_.resize(std::min(views_.size(), std::max(kLeastHeld, fit)));
}

Result<const GBuffer*> LightGBuffers::look(Frame& frame, size_t index) {
    Held& held = held_[index % held_.size()];
    const LightView& view = views_[index];
    if (held.whole && held.view == view.view && held.cut == view.cut->fingerprint()) return &held.gbuffer;
    held.whole = false;
    const auto swap_pictures = [&] {
        std::swap(scratch_.texels, held.gbuffer.texels);
        std::swap(scratch_.ids, held.gbuffer.ids);
    };
    swap_pictures();
    const auto drawn = rasterize(frame.gl.device, *view.cut, view.view, scratch_);
    swap_pictures();
    LUCARNE_TRY(drawn);
    held.view = view.view;
    held.cut = view.cut->fingerprint();
    held.gbuffer.width = view.view.width;
    held.gbuffer.height = view.view.height;
    held.whole = true;
    return &held.gbuffer;
}

Result<LightGBuffer> LightGBuffers::gbuffer(Frame& frame, size_t index) {
    LUCARNE_ASSIGN(const GBuffer* seen, look(frame, index));
    const LightView& view = views_[index];
    return LightGBuffer{view.light, view.face, view.view, *view.cut, *seen};
}

Result<void> LightGBuffers::seed(Frame& frame, const Buffer& materials, uint32_t count, uint64_t seed,
                                 Seeds& target) {
    LUCARNE_TRY(frame.gl.device.reserve(target.lights, count * sizeof(VplLight), "virtual point lights"));
    std::vector<double> weights;
    for (size_t i = 0; i < views_.size(); ++i) {
        LUCARNE_ASSIGN(const LightGBuffer from, gbuffer(frame, i));
        materials.bind(kBindMaterials);
        LUCARNE_ASSIGN(const double weight, map_importance(frame.gl.device, from, importance_));
        weights.push_back(weight);
    }
    emitters_.running.clear();
    if (emits(frame))
        LUCARNE_TRY(weigh_emitters(frame.gl.device, *frame.gl.cuts.light, materials, emitters_));
    weights.push_back(emitters_.flux());
    target.lights.upload_all(std::vector<VplLight>(count, kDeadLight));
    const std::vector<uint32_t> shares = share_out(weights, count);
    LUCARNE_TRY(seed_emitters(frame.gl.device, *frame.gl.cuts.light, materials, emitters_, shares.back(),
                              seed, 0, target));
    uint32_t first = shares.back();
    for (size_t i = 0; i < views_.size(); ++i) {
        if (shares[i] == 0) continue;
        LUCARNE_ASSIGN(const LightGBuffer from, gbuffer(frame, i));
        if (views_.size() > 1) {
            materials.bind(kBindMaterials);
            LUCARNE_TRY(map_importance(frame.gl.device, from, importance_));
        }
        LUCARNE_TRY(seed_view(frame.gl.device, from, importance_, materials,
                              halton_points(shares[i], seed, i), first, target));
        first += shares[i];
    }
    settle_lights(target, count);
    return {};
}

}  // namespace lucarne::gi::vpl
