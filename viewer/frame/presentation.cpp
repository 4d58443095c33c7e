#include "viewer/frame/presentation.h"

#include <cmath>
#include <utility>

#include "gi/lighting/direct_light.h"
#include "gi/post/accumulate.h"
#include "gi/post/backdrop.h"
#include "gi/post/exposure.h"
#include "gi/post/false_colour.h"
#include "gi/post/fill_gaps.h"
#include "gi/post/share_edges.h"
#include "gi/post/tone_map.h"
#include "gi/scene/views.h"

namespace lucarne::viewer {

/// Whether the points' light is averaged apart from the background.
bool Presentation::keeps_apart(const gi::Scene& scene, const Averaging& averaging) {
    return averaging.points_apart || scene.look.backdrop.kind != gi::Backdrop::Kind::scene;
}

Result<void> Presentation::reserve(size_t pixels, const gi::Scene& scene, const Averaging& averaging,
                                   bool compared) {
    for (Images* images : {&own_, &other_}) {
        if (images == &other_ && !compared) continue;
        LUCARNE_TRY(device_.reserve(images->sample, pixels * sizeof(glm::vec4), "the picture's radiance"));
        LUCARNE_TRY(device_.reserve(images->picture, pixels * sizeof(uint32_t), "picture"));
        if (!averaging.on && !averaging.edges) continue;
        LUCARNE_TRY(device_.reserve(images->mean, pixels * sizeof(glm::vec4), "the picture's average"));
        if (!keeps_apart(scene, averaging)) continue;
        LUCARNE_TRY(device_.reserve(images->points, pixels * sizeof(glm::vec4), "the picture's average"));
    }
    return {};
}

Result<void> Presentation::finish(const gi::Engine& engine, const gi::Engine* other, const gi::Scene& scene,
                                  const gi::GBuffer& gbuffer, const Averaging& averaging) {
    ++accumulated_;
    averaged_ = averaging.on;
    edges_ = averaging.edges && accumulated_ == 1;
    mean_shown_ = averaged_ || edges_;
    points_apart_ = keeps_apart(scene, averaging);
    if (mean_shown_) LUCARNE_TRY(add_to_average(own_, gbuffer));
    if (other && mean_shown_) LUCARNE_TRY(add_to_average(other_, gbuffer));
    const bool by_other = engine.info().unlit && other && !other->info().unlit;
    LUCARNE_TRY(expose(by_other ? *other : engine, by_other ? other_ : own_, scene, gbuffer));
    LUCARNE_TRY(show(engine, scene, gbuffer, own_));
    if (other) LUCARNE_TRY(compare(*other, scene, gbuffer));
    LUCARNE_TRY(
        gi::draw_backdrop(device_, gbuffer, radiance(), mean_shown_, scene.look.backdrop, own_.picture));
    if (averaging.gaps == 0) return {};
    return gi::fill_gaps(device_, gbuffer, radiance(), mean_shown_, averaging.gaps, own_.picture);
}

/// Finds the exposure of one engine's light.
Result<void> Presentation::expose(const gi::Engine& lit_by, const Images& images, const gi::Scene& scene,
                                  const gi::GBuffer& gbuffer) {
    const auto before = std::exchange(exposed_, std::nullopt);
    if (lit_by.info().unlit) {  // its colours are for the screen already
        exposure_ = {};
        return {};
    }
    const glm::vec3 balance = gi::white_balance(scene.white);
    if (scene.exposure_ev) {
        exposure_ = {*scene.exposure_ev, 0, balance};
        return {};
    }
    LUCARNE_ASSIGN(const gi::Exposure measured, gi::automatic_exposure(device_, images.radiance(mean_shown_),
                                                                       gbuffer, scene.tone_map, balance));
    exposed_ = std::chrono::steady_clock::now();
    const double passed = before ? std::chrono::duration<double>(*exposed_ - *before).count() : 0;
    const bool at_once = !before || !(exposure_seconds_ > 0);
    const double share = at_once ? 1 : 1 - std::exp(-passed / exposure_seconds_);
    exposure_ = gi::between(exposure_, measured, share);
    return {};
}

Result<void> Presentation::add_to_average(Images& images, const gi::GBuffer& gbuffer) {
    const auto add = [&](bool points_only, gi::Buffer& mean) -> Result<void> {
        if (edges_) return gi::share_edges(device_, images.sample, gbuffer, points_only, mean);
        return gi::accumulate(device_, images.sample, gbuffer, accumulated_, points_only, mean);
    };
    LUCARNE_TRY(add(false, images.mean));
    return points_apart_ ? add(true, images.points) : Result<void>();
}

Result<void> Presentation::show(const gi::Engine& lit_by, const gi::Scene& scene, const gi::GBuffer& gbuffer,
                                Images& images) {
    const gi::Buffer& radiance = images.points_radiance(mean_shown_, points_apart_);
    const uint32_t pixels = gbuffer.width * gbuffer.height;
    const bool unlit = lit_by.info().unlit;
    if (unlit || !gi::shows_figures(scene.tone_map))
        return gi::tone_map(device_, radiance, pixels, unlit ? gi::ToneMap::none : scene.tone_map,
                            unlit ? gi::Exposure{} : exposure_, images.picture);
    const gi::ValueRange range = gi::false_colour_range(scene.tone_map, scene.luminance, exposure_.ev);
    if (scene.tone_map == gi::ToneMap::false_colour)
        return gi::false_colour(device_, radiance, pixels, range, images.picture);
    LUCARNE_TRY(gi::upload_materials(device_, gi::materials_of(scene), materials_));
    return gi::illuminance(device_, radiance, gbuffer, materials_, range, images.picture);
}

/// Combines the picture with the other engine's light.
Result<void> Presentation::compare(const gi::Engine& other, const gi::Scene& scene,
                                   const gi::GBuffer& gbuffer) {
    using Show = gi::Comparison::Show;
    const gi::Comparison& how = *scene.comparison;
    const uint32_t pixels = gbuffer.width * gbuffer.height;
    if (how.show != Show::split)
        return gi::difference(device_, radiance(), other_.radiance(mean_shown_), pixels,
                              how.show == Show::absolute_difference, exposure_.ev, how.range, own_.picture);
    LUCARNE_TRY(show(other, scene, gbuffer, other_));
    return gi::split(device_, other_.picture, gbuffer.width, gbuffer.height, how.border, own_.picture);
}

}  // namespace lucarne::viewer
