#include "gi/gather/lit_tree.h"

#include "gi/lighting/direct_light.h"
#include "gi/lighting/surfel_light.h"
#include "gi/shared/brdf.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/flat_surfels.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

constexpr size_t kGrain = 16384;

}  // namespace

Result<void> LitTree::set_surfels(Frame& frame) {
    own_.clear();
    reflectances_.clear();
    surfels_.clear();
    tree_ = {};
    const DeviceCut& cut = *frame.gl.cuts.light;
    const size_t count = flat_count(cut);
    if (count == 0) return {};
    LUCARNE_TRY(flatten(frame.gl.device, cut, flat_));
    surfels_ = flat_.download_all<FlatSurfel>(count);
    tree_ = build_tree(surfels_);
    return {};
}

Result<void> LitTree::set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers) {
    Device& device = frame.gl.device;
    const size_t count = surfels_.size();
    own_.assign(count, {});
    reflectances_.assign(count, glm::vec3(0.0f));
    if (tree_.empty()) return {};
    LUCARNE_TRY(device.reserve(irradiance_, count * sizeof(SideLight), "light of surfels"));
    irradiance_.clear(0);
    for (const LightView& view : views) {
        if (frame.stopped()) return {};
        LUCARNE_ASSIGN(const GBuffer* seen, gbuffers.look(device, view));
        LUCARNE_TRY(add_surfel_light(device, flat_, static_cast<uint32_t>(count), view, *seen, irradiance_));
    }
    irradiance_.download(0, std::as_writable_bytes(std::span(own_)));
    const std::vector<Material> materials = device_materials(frame.materials);
    parallel_ranges(count, kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const FlatSurfel& surfel = surfels_[i];
            if (!(surfel.radius > 0)) continue;
            const Material& material = materials[surfel.material % materials.size()];
            const Reflectance r = make_reflectance(material, decode_albedo(surfel.albedo));
            reflectances_[i] = (r.kd + r.ks) / kPi;
            const glm::vec3 emission(material.emission);
            own_[i] = {emission + reflectances_[i] * own_[i].front,
                       emission + reflectances_[i] * own_[i].back};
        }
    });
    return {};
}

}  // namespace lucarne::gi
