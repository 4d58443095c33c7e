#include "gi/engines/paths/entry_light.h"

#include <algorithm>
#include <utility>

#include "gi/gl_frame.h"
#include "gi/lighting/surfel_light.h"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi::paths {
namespace {

/// The light of more lamps is not kept apart: it takes 12 bytes for each entry point and lamp.
constexpr size_t kMostKept = 8;

/// Returns how many of the first views belong to one light.
size_t views_of_one(std::span<const LightView> views) {
    size_t count = 1;
    while (count < views.size() && views[count].light == views[0].light && views[count].cut == views[0].cut)
        ++count;
    return count;
}

}  // namespace

Result<void> EntryLight::set_entries(Frame& frame, const std::shared_ptr<const PathsBake>& bake) {
    if (bake_ == bake && offset_ == frame.bake_offset) return {};
    bake_.reset();
    kept_.clear();
    const size_t count = bake->entries.size();
    std::vector<FlatSurfel> flat;
    flat.reserve(count);
    for (const Entry& entry : bake->entries) {
        const glm::vec3 at = entry.position + frame.bake_offset;
        flat.push_back({at.x, at.y, at.z, entry.radius, 0, encode_octahedral(entry.normal), kSurfelHasNormal,
                        entry.material, kNoEdges});
    }
    if (count > 0) {
        Device& device = frame.gl.device;
        LUCARNE_TRY(device.reserve(flat_, count * sizeof(FlatSurfel), "entry points"));
        LUCARNE_TRY(device.reserve(irradiance_, 2 * count * sizeof(glm::vec3), "light of entry points"));
        flat_.upload_all(flat);
    }
    bake_ = bake;
    offset_ = frame.bake_offset;
    return {};
}

Result<std::vector<glm::vec3>> EntryLight::compute(Frame& frame, std::span<const LightView> views,
                                                   LightGBuffers& gbuffers, bool any_state) {
    const size_t count = bake_->entries.size();
    std::vector<glm::vec3> irradiance(count, glm::vec3(0.0f));
    Device& device = frame.gl.device;
    irradiance_.clear(0);
    for (const LightView& view : views) {
        if (frame.stopped()) return irradiance;
        LUCARNE_ASSIGN(const GBuffer* seen,
                       any_state ? gbuffers.look_at_any_state(device, view) : gbuffers.look(device, view));
        LUCARNE_TRY(add_surfel_light(device, flat_, static_cast<uint32_t>(count), view, *seen, irradiance_));
    }
    // Front and back of each; an entry point is one side, its front.
    const auto both = irradiance_.download_all<glm::vec3>(2 * count);
    for (size_t i = 0; i < count; ++i) irradiance[i] = both[2 * i];
    return irradiance;
}

Result<std::vector<glm::vec3>> EntryLight::irradiance(Frame& frame, std::span<const LightView> views,
                                                      LightGBuffers& gbuffers, bool any_state) {
    std::vector<glm::vec3> sum(bake_->entries.size(), glm::vec3(0.0f));
    std::vector<Kept> kept;
    size_t lights = 0;
    for (size_t i = 0; i < views.size(); i += views_of_one(views.subspan(i))) ++lights;
    const bool keeps = lights <= kMostKept;
    computed_ = 0;
    while (!views.empty() && !sum.empty()) {
        const auto own = views.first(keeps ? views_of_one(views) : views.size());
        const Light& light = own[0].light;
        const uint64_t cut = own[0].cut->fingerprint();
        const auto found = std::ranges::find_if(
            kept_, [&](const Kept& k) { return keeps && k.light == light && (any_state || k.cut == cut); });
        if (found != kept_.end()) {
            kept.push_back(*found);
        } else {
            ++computed_;
            LUCARNE_ASSIGN(auto irradiance, compute(frame, own, gbuffers, any_state));
            if (frame.stopped()) return sum;
            kept.push_back({light, cut, std::move(irradiance)});
        }
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += kept.back().irradiance[i];
        views = views.subspan(own.size());
    }
    if (!keeps) kept.clear();
    kept_ = std::move(kept);
    return sum;
}

}  // namespace lucarne::gi::paths
