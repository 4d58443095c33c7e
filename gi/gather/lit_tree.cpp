#include "gi/gather/lit_tree.h"

#include "gi/gather/lobe.h"
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
    lobes_ = {};
    if (tree_.empty()) return {};
    LUCARNE_TRY(device.reserve(irradiance_, count * sizeof(SideLight), "light of surfels"));
    irradiance_.clear(0);
    const bool directed = glossy(frame);
    if (directed) {
        LUCARNE_TRY(device.reserve(directions_, count * sizeof(SideLight), "directions of the light"));
        directions_.clear(0);
    }
    for (const LightView& view : views) {
        if (frame.stopped()) return {};
        LUCARNE_ASSIGN(const GBuffer* seen, gbuffers.look(device, view));
        LUCARNE_TRY(add_surfel_light(device, flat_, static_cast<uint32_t>(count), view, *seen, irradiance_,
                                     directed ? &directions_ : nullptr));
    }
    irradiance_.download(0, std::as_writable_bytes(std::span(own_)));
    std::vector<SideLight> lobes, directions;
    if (directed) {
        lobes.assign(count, {});
        directions = directions_.download_all<SideLight>(count);
    }
    const std::vector<Material> materials = device_materials(frame.materials);
    parallel_ranges(count, kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const FlatSurfel& surfel = surfels_[i];
            if (!(surfel.radius > 0)) continue;
            const Material& material = materials[surfel.material % materials.size()];
            const Reflectance r = make_reflectance(material, decode_albedo(surfel.albedo));
            reflectances_[i] = (r.kd + r.ks) / kPi;
            const glm::vec3 emission(material.emission), kd = r.kd / kPi;
            if (directed && r.ks > 0) {
                const glm::vec3 normal = decode_octahedral(surfel.normal);
                const float size = r.ks * lobe_mean_cosine(r.exponent);
                const auto mirrored = [&](const glm::vec3& to_light) {
                    return size * (2 * glm::dot(normal, to_light) * normal - to_light);
                };
                lobes[i] = {r.ks * own_[i].front, r.ks * own_[i].back};
                directions[i] = {mirrored(directions[i].front), mirrored(directions[i].back)};
            } else if (directed) {
                directions[i] = {};
            }
            own_[i] = {emission + kd * own_[i].front, emission + kd * own_[i].back};
        }
    });
    if (!directed) return {};
    pull_light(tree_, lobes, lobes_.light);
    pull_light(tree_, directions, lobes_.directions);
    return {};
}

}  // namespace lucarne::gi
