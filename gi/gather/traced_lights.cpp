#include "gi/gather/traced_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "gi/bounce_options.h"
#include "gi/gather/gather_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/area_points.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/light_samples.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kPixelsATask = 1024;

glm::dvec2 random_square(Random& random) {
    const double x = random.uniform();
    return {x, random.uniform()};
}

}  // namespace

TracedLights::TracedLights(const tracing::SurfelTracer& tracer, std::span<const Light> lights,
                           const SkyDirections& sky, uint32_t samples)
    : tracer_(tracer), sky_(sky) {
    for (const Light& light : lights)
        if (shines(light)) (tracing::is_sharp(light) ? sharp_ : soft_).push_back(light);
    const size_t takers = soft_.size() + (sky_.dark() ? 0 : 1);
    if (takers > 0) samples_ = std::max<uint32_t>(samples / static_cast<uint32_t>(takers), 1);
}

glm::vec3 TracedLights::reflected(const SurfacePoint& point, const Reflectance& surface, uint64_t key) const {
    // Most points face no light, or few, so the start of rays is found when it is needed.
    std::optional<glm::vec3> start;
    const auto is_lit = [&](const glm::vec3& direction, float distance) {
        if (!start) {
            const glm::vec3 above = tracing::offset_origin(point.position, point.normal, point.radius);
            start = tracing::before_what_hides(tracer_, above, point.viewer, point.radius);
        }
        return std::isinf(distance) ? !tracer_.occluded_along(*start, direction)
                                    : !tracer_.occluded(*start, point.position + direction * distance);
    };
    glm::vec3 sum(0.0f);
    // `irradiance`: of a surface across the direction.
    const auto add = [&](const glm::vec3& in, const glm::vec3& irradiance, float distance) {
        const float cosine = glm::dot(point.normal, in);
        if (cosine > 0 && is_lit(in, distance))
            sum += brdf(surface, point.normal, point.viewer, in) * cosine * irradiance;
    };
    for (const Light& light : sharp_) {
        glm::vec3 in;
        const glm::vec3 irradiance = light_irradiance(light, point.position, point.normal, in);
        const float distance = light.kind == kDirectionalLight
                                   ? std::numeric_limits<float>::infinity()
                                   : glm::length(glm::vec3(light.position) - point.position);
        if (irradiance != glm::vec3(0.0f) && is_lit(in, distance))
            sum += brdf(surface, point.normal, point.viewer, in) * irradiance;
    }
    Random random(key);
    const float share = 1 / static_cast<float>(samples_);
    for (const Light& light : soft_) {
        const glm::dvec2 shift = random_square(random);
        for (uint32_t i = 0; i < samples_; ++i)
            if (const auto in =
                    tracing::sample_light(light, point.position, lattice_point(i, samples_, shift)))
                add(in->direction, in->radiance * (share / in->pdf), in->distance);
    }
    if (sky_.dark()) return sum;
    const glm::dvec2 shift = random_square(random);
    for (uint32_t i = 0; i < samples_; ++i) {
        const SkyDirections::Drawn drawn = sky_.draw(lattice_point(i, samples_, shift));
        add(drawn.direction, drawn.flux * share, std::numeric_limits<float>::infinity());
    }
    return sum;
}

Result<void> LightCutTracer::update(Frame& frame, uint64_t revision) {
    if (tracer_ && revision_ == revision) return {};
    const TimedPass pass(frame, "surfels for tracing");
    tracer_.reset();
    LUCARNE_ASSIGN(tracer_, tracing::SurfelTracer::create(download_light_surfels(frame)));
    revision_ = revision;
    return {};
}

bool traces_shadows(const Frame& frame) {
    return frame.settings[kShadows] == Shadows::rays && !frame.moving;
}

void add_traced_light(Frame& frame, const tracing::SurfelTracer& tracer, const SkyDirections& sky) {
    const TracedLights lights(tracer, frame.lights, sky, frame.settings[kLightSamples]);
    const auto surfaces = visible_surfaces(frame.camera, download_gbuffer(frame));
    auto radiance = frame.gl.radiance.download_all<glm::vec4>(surfaces.size());
    const std::vector<Material> materials = device_materials(frame.materials);
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    parallel_ranges(surfaces.size(), kPixelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !frame.stopped(); ++i) {
            const SurfacePoint& at = surfaces[i];
            if (!(at.radius > 0)) continue;
            const Reflectance surface =
                make_reflectance(materials[at.material % materials.size()], at.albedo);
            radiance[i] += glm::vec4(lights.reflected(at, surface, mix64(~seed, i)), 0);
        }
    });
    if (!frame.stopped()) upload_radiance(frame, radiance);
}

}  // namespace lucarne::gi
