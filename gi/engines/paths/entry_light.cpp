#include "gi/engines/paths/entry_light.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/gl_frame.h"
#include "gi/lighting/nested_views.h"
#include "gi/lighting/surfel_light.h"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/light.h"
#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

/// The light of more lamps is not kept apart: it takes 12 bytes for each entry point and lamp.
constexpr size_t kMostKept = 8;
constexpr size_t kEntriesATask = 1024;

/// Returns how many of the first views belong to one light.
size_t views_of_one(std::span<const LightView> views) {
    size_t count = 1;
    while (count < views.size() && views[count].light == views[0].light) ++count;
    return count;
}

/// Whether two lights give the same to entry points.
bool is_same(const Light& a, const Light& b, bool is_traced) {
    return is_traced ? without_nested_views(a) == without_nested_views(b) : a == b;
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
                        entry.material, 0});
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

/// Adds the light of a view's lamp by a ray from each entry point that faces it and is in the view.
void EntryLight::trace(Frame& frame, const LightView& view, const tracing::SurfelTracer& tracer,
                       std::span<glm::vec3> irradiance) const {
    const Light& light = view.light;
    parallel_ranges(irradiance.size(), kEntriesATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end && !frame.stopped(); ++i) {
            const Entry& entry = bake_->entries[i];
            const glm::vec3 at = entry.position + frame.bake_offset;
            if (light_face(light, at - glm::vec3(light.position)) != view.face) continue;
            glm::vec3 in;
            const glm::vec3 arriving = light_irradiance(light, at, entry.normal, in);
            if (arriving == glm::vec3(0.0f)) continue;
            const glm::vec3 start = tracing::offset_origin(at, entry.normal, entry.radius);
            const bool is_hidden = light.kind == kDirectionalLight
                                       ? tracer.occluded_along(start, in)
                                       : tracer.occluded(start, glm::vec3(light.position));
            if (!is_hidden) irradiance[i] += arriving;
        }
    });
}

/// Adds the luminance of the irradiance by these views times the mean direction that it comes from. Of
/// several lights the mean is that without shadows, since they are not known apart.
void EntryLight::add_directions(const Frame& frame, std::span<const LightView> views,
                                std::span<const Material> materials, std::span<const glm::vec3> irradiance,
                                std::span<glm::vec3> sum) const {
    parallel_ranges(sum.size(), kEntriesATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Entry& entry = bake_->entries[i];
            const bool has_lobe = materials[entry.material % materials.size()].diffuse.w > 0;
            if (!has_lobe || irradiance[i] == glm::vec3(0.0f)) continue;
            float light = 0;
            glm::vec3 directions(0.0f);
            for (auto rest = views; !rest.empty(); rest = rest.subspan(views_of_one(rest))) {
                glm::vec3 in;
                const float own = luminance(
                    light_irradiance(rest[0].light, entry.position + frame.bake_offset, entry.normal, in));
                light += own;
                if (own > 0) directions += own * in;
            }
            if (light > 0) sum[i] += luminance(irradiance[i]) / light * directions;
        }
    });
}

Result<LampLight> EntryLight::light(Frame& frame, std::span<const LightView> views, LightGBuffers& gbuffers,
                                    bool any_state, const tracing::SurfelTracer* tracer,
                                    std::span<const Material> materials) {
    LampLight all;
    std::vector<glm::vec3>& sum = all.irradiance;
    sum.assign(bake_->entries.size(), glm::vec3(0.0f));
    if (!materials.empty()) all.directions.assign(sum.size(), glm::vec3(0.0f));
    std::vector<Kept> kept;
    size_t lights = 0;
    for (size_t i = 0; i < views.size(); i += views_of_one(views.subspan(i))) ++lights;
    const bool keeps = lights <= kMostKept;
    computed_ = 0;
    while (!views.empty() && !sum.empty()) {
        const auto own = views.first(keeps ? views_of_one(views) : views.size());
        const Light& light = own[0].light;
        const bool is_traced = tracer != nullptr;
        uint64_t cut = is_traced ? frame.gl.cuts.light->fingerprint() : 0;
        if (!is_traced)
            for (const LightView& view : own) cut = mix64(cut, view.cut->fingerprint());
        const auto found = std::ranges::find_if(kept_, [&](const Kept& k) {
            if (!keeps || !is_same(k.light, light, k.is_traced)) return false;
            return any_state ? k.is_traced || !is_traced : k.cut == cut && k.is_traced == is_traced;
        });
        if (found != kept_.end()) {
            kept.push_back(*found);
        } else {
            ++computed_;
            std::vector<glm::vec3> irradiance;
            if (is_traced) {
                irradiance.assign(sum.size(), glm::vec3(0.0f));
                for (const LightView& view : own) trace(frame, view, *tracer, irradiance);
            } else {
                LUCARNE_ASSIGN(irradiance, compute(frame, own, gbuffers, any_state));
            }
            if (frame.stopped()) return all;
            kept.push_back({light, cut, is_traced, std::move(irradiance)});
        }
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += kept.back().irradiance[i];
        if (!materials.empty()) add_directions(frame, own, materials, kept.back().irradiance, all.directions);
        views = views.subspan(own.size());
    }
    if (!keeps) kept.clear();
    kept_ = std::move(kept);
    for (size_t i = 0; i < all.directions.size(); ++i)
        if (const float light = luminance(sum[i]); light > 0) all.directions[i] /= light;
    return all;
}

}  // namespace lucarne::gi::paths
