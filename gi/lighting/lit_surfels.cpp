#include "gi/lighting/lit_surfels.h"

#include "gi/lighting/direct_light.h"
#include "gi/lighting/surfel_light.h"
#include "gi/native/reflectance.h"
#include "gi/shared/brdf.h"
#include "gi/shared/lobe.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/flat_surfels.h"
#include "gi/surfels/plane_normals.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

constexpr size_t kLitAtOnce = 16384;

}  // namespace

Result<void> LitSurfels::set_surfels(Frame& frame, Bare bare) {
    own_.clear();
    reflectances_.clear();
    surfels_.clear();
    const DeviceCut& cut = *frame.gl.cuts.light;
    const size_t count = flat_count(cut);
    if (count == 0) return {};
    LUCARNE_TRY(flatten(frame.gl.device, cut, flat_));
    surfels_ = flat_.download_all<FlatSurfel>(count);
    if (bare == Bare::of_planes && add_plane_normals(surfels_)) flat_.upload_all(surfels_);
    return {};
}

Result<void> LitSurfels::begin_light(Frame& frame, Specular specular) {
    const size_t count = surfels_.size();
    lobes_ = {};
    apart_ = specular == Specular::apart && glossy(frame);
    own_.assign(count, {});
    reflectances_.assign(count, glm::vec3(0.0f));
    if (count == 0) return {};
    if (!flat_) {
        LUCARNE_TRY(frame.gl.device.reserve(flat_, count * sizeof(FlatSurfel), "flat surfels"));
        flat_.upload_all(surfels_);
    }
    LUCARNE_TRY(frame.gl.device.reserve(irradiance_, count * sizeof(SideLight), "light of surfels"));
    irradiance_.clear(0);
    if (!apart_) return {};
    LUCARNE_TRY(frame.gl.device.reserve(directions_, count * sizeof(SideLight), "directions of the light"));
    directions_.clear(0);
    return {};
}

Result<void> LitSurfels::add_light(Frame& frame, const LightView& view, LightGBuffers& gbuffers) {
    if (surfels_.empty()) return {};
    Device& device = frame.gl.device;
    LUCARNE_ASSIGN(const GBuffer* seen, gbuffers.look(device, view));
    return add_surfel_light(device, flat_, static_cast<uint32_t>(surfels_.size()), view, *seen, irradiance_,
                            apart_ ? &directions_ : nullptr);
}

void LitSurfels::set_lobes(size_t surfel, const Reflectance& r) {
    const glm::vec3 normal = decode_octahedral(surfels_[surfel].normal);
    const float size = r.ks * lobe_mean_cosine(r.exponent);
    const auto mirrored = [&](const glm::vec3& to_light) {
        return size * (2 * glm::dot(normal, to_light) * normal - to_light);
    };
    SideLight& directions = lobes_.directions[surfel];
    directions = {mirrored(directions.front), mirrored(directions.back)};
    lobes_.light[surfel] = {r.ks * own_[surfel].front, r.ks * own_[surfel].back};
}

void LitSurfels::end_light(const Frame& frame) {
    const size_t count = surfels_.size();
    if (count == 0) return;
    irradiance_.download(0, std::as_writable_bytes(std::span(own_)));
    if (apart_) {
        lobes_.light.assign(count, {});
        lobes_.directions = directions_.download_all<SideLight>(count);
    }
    const std::vector<Material> materials = device_materials(frame.materials);
    parallel_ranges(count, kLitAtOnce, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const FlatSurfel& surfel = surfels_[i];
            if (!(surfel.radius > 0)) continue;
            const Material& material = materials[surfel.material % materials.size()];
            const Reflectance r = make_reflectance(material, native::linear_albedo(surfel.albedo));
            reflectances_[i] = (r.kd + r.ks) / kPi;
            if (apart_) set_lobes(i, r);
            const glm::vec3 emission(material.emission);
            const glm::vec3 even = apart_ ? r.kd / kPi : reflectances_[i];
            own_[i] = {emission + even * own_[i].front, emission + even * own_[i].back};
        }
    });
}

void LitSurfels::free_device() {
    flat_ = {};
    irradiance_ = {};
    directions_ = {};
}

Result<void> LitSurfels::set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers,
                                   Specular specular) {
    LUCARNE_TRY(begin_light(frame, specular));
    for (const LightView& view : views) {
        if (frame.stopped()) return {};
        LUCARNE_TRY(add_light(frame, view, gbuffers));
    }
    end_light(frame);
    return {};
}

}  // namespace lucarne::gi
