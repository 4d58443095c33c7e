#include "gi/engines/paths/entry_light.h"

#include "gi/gl_frame.h"
#include "gi/lighting/surfel_light.h"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi::paths {

Result<void> EntryLight::set_entries(Frame& frame, std::span<const Entry> entries) {
    if (entries_ == entries.data() && count_ == entries.size() && offset_ == frame.bake_offset) return {};
    entries_ = nullptr;
    count_ = entries.size();
    if (count_ == 0) return {};
    std::vector<FlatSurfel> flat;
    for (const Entry& entry : entries) {
        const glm::vec3 at = entry.position + frame.bake_offset;
        flat.push_back({at.x, at.y, at.z, entry.radius, 0, encode_octahedral(entry.normal), kSurfelHasNormal,
                        entry.material, kNoEdges});
    }
    Device& device = frame.gl.device;
    LUCARNE_TRY(device.reserve(flat_, count_ * sizeof(FlatSurfel), "entry points"));
    LUCARNE_TRY(device.reserve(irradiance_, 2 * count_ * sizeof(glm::vec3), "light of entry points"));
    flat_.upload(0, std::as_bytes(std::span(flat)));
    entries_ = entries.data();
    offset_ = frame.bake_offset;
    return {};
}

Result<std::vector<glm::vec3>> EntryLight::irradiance(Frame& frame, const std::vector<LightView>& views,
                                                      LightGBuffers& gbuffers, bool any_state) {
    std::vector<glm::vec3> irradiance(count_, glm::vec3(0.0f));
    if (count_ == 0 || views.empty()) return irradiance;
    Device& device = frame.gl.device;
    irradiance_.clear(0);
    for (const LightView& view : views) {
        if (frame.stopped()) return irradiance;
        LUCARNE_ASSIGN(const GBuffer* seen,
                       any_state ? gbuffers.look_at_any_state(device, view) : gbuffers.look(device, view));
        LUCARNE_TRY(add_surfel_light(device, flat_, static_cast<uint32_t>(count_), view, *seen, irradiance_));
    }
    // Front and back of each; an entry point is one side, its front.
    const auto both = irradiance_.download_all<glm::vec3>(2 * count_);
    for (size_t i = 0; i < count_; ++i) irradiance[i] = both[2 * i];
    return irradiance;
}

}  // namespace lucarne::gi::paths
