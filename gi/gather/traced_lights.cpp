#include "gi/gather/traced_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "gi/bounce_options.h"
#include "gi/gather/gather_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/area_points.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/light_samples.h"
#include "gi/surfels/plane_normals.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kPixelsATask = 1024;
/// Each pixel casts so many rays to a light with a size first. If all those of 5 x 5 pixels pass, the other
/// rays are taken to pass, too; if none does, they are taken to be blocked. This clips the faint ends of
/// penumbrae, also in averages: a pixel that sees 2 % of a light is dark in a third of the frames.
constexpr uint32_t kProbes = 2, kLeastToProbe = 4;
constexpr size_t kMostProbed = 8;  ///< lights; what they tell takes a byte a pixel each

glm::dvec2 random_square(Random& random) {
    const double x = random.uniform();
    return {x, random.uniform()};
}

/// Whether a cap of sky is above the plane of a surface as a whole. Then it lights it evenly as if all of its
/// light came from the middle.
bool above(const Light& light, const glm::vec3& normal) {
    return light.kind == kDirectionalLight && light.direction.w < 0.5f * kPi &&
           -glm::dot(normal, glm::vec3(light.direction)) > std::sin(light.direction.w);
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

/// Rays from a point to lights.
class TracedLights::Rays {
 public:
    Rays(const tracing::SurfelTracer& tracer, const SurfacePoint& point) : tracer_(tracer), point_(point) {}

    /// Whether nothing is in a direction as far as `distance`.
    bool pass(const glm::vec3& direction, float distance) {
        // Most points face no light, or few, so the start of rays is found when it is needed.
        if (!start_) {
            const glm::vec3 above = tracing::offset_origin(point_.position, point_.normal, point_.radius);
            start_ = tracing::before_what_hides(tracer_, above, point_.viewer, point_.normal, point_.radius);
        }
        return std::isinf(distance) ? !tracer_.occluded_along(*start_, direction)
                                    : !tracer_.occluded(*start_, point_.position + direction * distance);
    }

 private:
    const tracing::SurfelTracer& tracer_;
    const SurfacePoint& point_;
    std::optional<glm::vec3> start_;
};

size_t TracedLights::probed() const {
    return samples_ >= kLeastToProbe && soft_.size() <= kMostProbed ? soft_.size() : 0;
}

void TracedLights::probe(const SurfacePoint& point, uint64_t key, std::span<uint8_t> sights) const {
    Random random(key);
    Rays rays(tracer_, point);
    const uint32_t step = samples_ / kProbes;
    for (size_t l = 0; l < soft_.size(); ++l) {
        const glm::dvec2 shift = random_square(random);
        for (uint32_t i = 0; i < kProbes; ++i) {
            const auto in =
                tracing::sample_light(soft_[l], point.position, lattice_point(i * step, samples_, shift));
            if (!in || !(glm::dot(point.normal, in->direction) > 0)) continue;
            sights[l] |= rays.pass(in->direction, in->distance) ? kSeen : kHidden;
        }
    }
}

glm::vec3 TracedLights::reflected(const SurfacePoint& point, const Reflectance& surface, uint64_t key,
                                  std::span<const uint8_t> sights) const {
    Rays rays(tracer_, point);
    glm::vec3 sum(0.0f);
    // `irradiance`: of a surface across the direction.
    const auto add = [&](const glm::vec3& in, const glm::vec3& irradiance, float distance, bool surely) {
        const float cosine = glm::dot(point.normal, in);
        if (cosine > 0 && (surely || rays.pass(in, distance)))
            sum += brdf(surface, point.normal, point.viewer, in) * cosine * irradiance;
    };
    for (const Light& light : sharp_) {
        glm::vec3 in;
        const glm::vec3 irradiance = light_irradiance(light, point.position, point.normal, in);
        const float distance = light.kind == kDirectionalLight
                                   ? std::numeric_limits<float>::infinity()
                                   : glm::length(glm::vec3(light.position) - point.position);
        if (irradiance != glm::vec3(0.0f) && rays.pass(in, distance))
            sum += brdf(surface, point.normal, point.viewer, in) * irradiance;
    }
    Random random(key);
    const float share = 1 / static_cast<float>(samples_);
    for (size_t l = 0; l < soft_.size(); ++l) {
        const glm::dvec2 shift = random_square(random);
        const uint8_t sight = sights.empty() ? uint8_t{kSeenInPart} : sights[l];
        if (sight == kHidden) continue;
        if (sight == kSeen && surface.ks == 0 && above(soft_[l], point.normal)) {
            glm::vec3 in;
            const glm::vec3 irradiance = light_irradiance(soft_[l], point.position, point.normal, in);
            sum += brdf(surface, point.normal, point.viewer, in) * irradiance;
            continue;
        }
        for (uint32_t i = 0; i < samples_; ++i)
            if (const auto in =
                    tracing::sample_light(soft_[l], point.position, lattice_point(i, samples_, shift)))
                add(in->direction, in->radiance * (share / in->pdf), in->distance, sight == kSeen);
    }
    if (sky_.dark()) return sum;
    const glm::dvec2 shift = random_square(random);
    for (uint32_t i = 0; i < samples_; ++i) {
        const SkyDirections::Drawn drawn = sky_.draw(lattice_point(i, samples_, shift));
        add(drawn.direction, drawn.flux * share, std::numeric_limits<float>::infinity(), false);
    }
    return sum;
}

namespace {

/// What pixels see of some lights: for each of them, one byte a pixel.
class Sights {
 public:
    Sights(const CameraView& camera, size_t lights)
        : width_(camera.width), height_(camera.height), lights_(lights), seen_(pixels() * lights) {}

    size_t lights() const { return lights_; }
    std::span<uint8_t> of(size_t pixel) { return std::span(seen_).subspan(pixel * lights_, lights_); }

    /// Joins what each pixel sees with what those about it see. Of a light that it has not probed, because
    /// its surface looks past it, others know nothing for it.
    void spread() {
        const std::vector<uint8_t> own = seen_;
        spread_along(1, width_, width_, height_);
        spread_along(width_, height_, 1, width_);
        for (size_t i = 0; i < own.size(); ++i)
            if (own[i] == TracedLights::kNoSight) seen_[i] = TracedLights::kSeenInPart;
    }

 private:
    size_t pixels() const { return size_t{width_} * height_; }
    /// Joins along lines of `count` pixels that lie `step` apart; there are `lines`, of which the first
    /// pixels lie `between` apart.
    void spread_along(size_t step, size_t count, size_t between, size_t lines) {
        std::vector<uint8_t> joined(seen_.size());
        parallel_ranges(lines, kLinesATask, [&](size_t first, size_t last) {
            for (size_t line = first; line < last; ++line)
                for (size_t i = 0; i < count; ++i)
                    for (size_t k = i - std::min(i, kAbout); k <= std::min(i + kAbout, count - 1); ++k)
                        for (size_t l = 0; l < lights_; ++l)
                            joined[(line * between + i * step) * lights_ + l] |=
                                seen_[(line * between + k * step) * lights_ + l];
        });
        seen_ = std::move(joined);
    }

    static constexpr size_t kAbout = 2, kLinesATask = 16;
    const uint32_t width_, height_;
    const size_t lights_;
    std::vector<uint8_t> seen_;
};

/// Calls visit(i) for the pixels that show a surface.
template <class Visit>
void each_surface(const Frame& frame, std::span<const SurfacePoint> surfaces, const Visit& visit) {
    parallel_ranges(surfaces.size(), kPixelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !frame.stopped(); ++i)
            if (surfaces[i].radius > 0) visit(i);
    });
}

}  // namespace

Result<void> LightCutTracer::update(Frame& frame, uint64_t revision) {
    if (tracer_ && revision_ == revision) return {};
    const TimedPass pass(frame, "surfels for tracing");
    tracer_.reset();
    std::vector<Surfel> surfels = download_light_surfels(frame);
    add_normals_of_planes(surfels);  // of a scan that is being read: else none of them would cast a shadow
    LUCARNE_ASSIGN(tracer_, tracing::SurfelTracer::create(std::move(surfels)));
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
    const uint64_t seed = ~mix64(frame.settings[kSeed], frame.index);
    Sights sights(frame.camera, lights.probed());
    if (sights.lights() > 0) {
        each_surface(frame, surfaces,
                     [&](size_t i) { lights.probe(surfaces[i], mix64(seed, i), sights.of(i)); });
        sights.spread();
    }
    each_surface(frame, surfaces, [&](size_t i) {
        const SurfacePoint& at = surfaces[i];
        const Reflectance surface = make_reflectance(materials[at.material % materials.size()], at.albedo);
        radiance[i] += glm::vec4(lights.reflected(at, surface, mix64(seed, i), sights.of(i)), 0);
    });
    if (!frame.stopped()) upload_radiance(frame, radiance);
}

}  // namespace lucarne::gi
