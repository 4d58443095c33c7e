#include "gi/lighting/light_samples.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/area_points.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/nested_views.h"
#include "gi/shared/brdf.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

glm::vec3 xyz(const glm::vec4& v) {
    return {v.x, v.y, v.z};
}

/// How many samples stand in for a light in this frame, and which.
class Strata {
 public:
    Strata(uint32_t count, uint64_t index, uint64_t seed, uint64_t light)
        : count_(count), frame_(index), seed_(seed), light_(light) {}
    uint32_t count() const { return count_; }
    uint64_t first() const { return frame_ * count_; }  ///< of all frames' samples, the first of this frame
    AreaPoints area_points() const { return AreaPoints(count_, seed_, light_); }

    /// Returns point `i` of a Fibonacci lattice, which becomes a spiral on a sphere, in [0, 1)^2. It is
    /// better for few directions; each frame shifts it by the R2 sequence.
    glm::dvec2 lattice(uint32_t i) const {
        Random random(seed_, light_);
        glm::dvec2 shift;
        shift.x = random.uniform();
        shift.y = random.uniform();
        return lattice_point(i, count_, static_cast<double>(frame_) * kR2 + shift);
    }

 private:
    uint32_t count_;
    uint64_t frame_, seed_, light_;
};

bool has_size(const Light& light) {
    return light.kind == kRectangleLight || light.kind == kDiscLight ||
           (light.kind == kDirectionalLight && light.direction.w > 0);
}

/// Returns the largest useful number of samples of a sun: its penumbra has no more texels than this in the
/// widest of its views.
uint32_t most_samples(const Light& sun, uint32_t resolution) {
    const double tangent = std::tan(std::min<double>(sun.direction.w, 1.5));
    return static_cast<uint32_t>(1 + std::min(2 * tangent * resolution, 1e6));
}

/// Computes two unit vectors perpendicular to a unit vector and to each other (Duff et al. 2017).
void across(const glm::vec3& n, glm::vec3& u, glm::vec3& v) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    u = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v = {b, sign + n.y * n.y * a, -n.y};
}

/// Adds even directions of the cap. Each has its share of the irradiance of a surface that faces the middle
/// of the cap, E / (pi sin^2 a) * 2 pi (1 - cos a).
void add_sun(const Light& sun, const Strata& strata, const DeviceCut* cut, std::vector<SharpLight>& target) {
    const double radius = sun.direction.w, half_sine = std::sin(radius / 2);
    const double height = 2 * half_sine * half_sine;  // 1 - cos a, which small angles do not cancel
    const double sine_a = std::sin(radius);
    const auto share = static_cast<float>(2 * height / (sine_a * sine_a) / strata.count());
    glm::vec3 u, v;
    across(xyz(sun.direction), u, v);
    for (uint32_t i = 0; i < strata.count(); ++i) {
        const glm::dvec2 point = strata.lattice(i);
        const double drop = point.y * height, sine = std::sqrt(std::max(0.0, drop * (2 - drop)));
        const double phi = 2 * M_PI * point.x;
        Light light = sun;
        const glm::vec3 direction = glm::normalize(u * static_cast<float>(sine * std::cos(phi)) +
                                                   v * static_cast<float>(sine * std::sin(phi)) +
                                                   xyz(sun.direction) * static_cast<float>(1 - drop));
        light.direction = glm::vec4(direction, 0);
        light.strength *= share;
        target.push_back({light, cut});
    }
}

/// Adds points of a rectangle or a disc.
void add_area(const Light& area, const Strata& strata, const DeviceCut* cut,
              std::vector<SharpLight>& target) {
    const glm::vec3 normal = xyz(area.direction);
    glm::vec3 u, v;
    float square_metres = 0;
    if (area.kind == kDiscLight) {
        across(normal, u, v);
        square_metres = kPi * area.extent.w * area.extent.w;
    } else {
        const float half = glm::length(xyz(area.extent));
        if (!(half > 0)) return;
        u = xyz(area.extent) / half;
        v = glm::cross(normal, u);
        square_metres = 4 * half * area.extent.w;
    }
    if (!(square_metres > 0)) return;
    const bool disc = area.kind == kDiscLight;
    const float width = disc ? area.extent.w : glm::length(xyz(area.extent));
    const AreaPoints points = strata.area_points();
    for (uint32_t i = 0; i < strata.count(); ++i) {
        const glm::dvec2 square = 2.0 * points.at(strata.first() + i) - 1.0;
        const glm::vec2 at(disc ? on_disc(square) : square);
        Light light{};
        light.kind = kCosineLight;
        light.position = area.position + glm::vec4(u * (width * at.x) + v * (area.extent.w * at.y), 0.0f);
        light.direction = area.direction;
        light.strength = area.strength * (square_metres / static_cast<float>(strata.count()));
        light.extent = glm::vec4(u, 0);
        target.push_back({light, cut});
    }
}

}  // namespace

bool shines(const Light& light) {
    return light.strength.x > 0 || light.strength.y > 0 || light.strength.z > 0;
}

uint32_t light_faces(const Light& light) {
    if (light.kind == kDirectionalLight) return std::max(light.nested, 1u);
    return light.kind == kPointLight ? 6 : light.kind == kCosineLight ? 4 : 1;
}

std::vector<Light> sky_lights(const SkyDirections& sky, uint32_t count, uint64_t index, uint64_t seed,
                              uint64_t light) {
    const Strata strata(count, index, seed, light);
    std::vector<Light> lights;
    for (uint32_t i = 0; i < count; ++i) {
        const auto [direction, flux] = sky.draw(strata.lattice(i));
        Light drawn{};
        drawn.kind = kDirectionalLight;
        drawn.direction = glm::vec4(-direction, 0);
        drawn.strength = glm::vec4(flux / static_cast<float>(count), 0);
        lights.push_back(drawn);
    }
    return lights;
}

std::vector<SharpLight> sharp_lights(const Frame& frame, const SkyDirections& sky, uint64_t index) {
    std::vector<SharpLight> result;
    std::vector<size_t> areas, suns;
    std::vector<Light> own = frame.lights;
    for (size_t i = 0; i < own.size(); ++i) {
        Light& light = own[i];
        if (light.kind == kDirectionalLight && frame.gl.cuts.light)
            set_nested_views(glm::vec3(frame.camera.origin), frame.bounds, *frame.gl.cuts.light,
                             frame.settings[kLightResolution], light);
        if (!has_size(light))
            result.push_back({light, frame.gl.cuts.light_views[i]});
        else if (shines(light))
            (light.kind == kDirectionalLight ? suns : areas).push_back(i);
    }
    // Every light with a size gets an even share of the views; views that narrow suns do not need go to the
    // others.
    uint32_t views = frame.settings[kLightSamples];
    auto takers = static_cast<uint32_t>(suns.size() + areas.size() + (sky.dark() ? 0 : 1));
    const auto share = [&](uint32_t most, uint32_t faces) {
        const uint32_t samples = std::clamp(views / takers-- / faces, 1u, most);
        views -= std::min(views, samples * faces);
        return samples;
    };
    const auto strata = [&](size_t i, uint32_t count) {
        return Strata(count, index, frame.settings[kSeed], i);
    };
    for (const size_t i : suns) {
        const uint32_t most = most_samples(own[i], frame.settings[kLightResolution]);
        const uint32_t count = share(most, light_faces(own[i]));
        add_sun(own[i], strata(i, count), frame.gl.cuts.light_views[i], result);
    }
    for (const size_t i : areas)
        add_area(own[i], strata(i, share(UINT32_MAX, 4)), frame.gl.cuts.light_views[i], result);
    if (!sky.dark()) {
        const size_t beyond = frame.lights.size();
        for (const Light& light : sky_lights(sky, share(UINT32_MAX, 1), index, frame.settings[kSeed], beyond))
            result.push_back({light, frame.gl.cuts.light, true});
    }
    return result;
}

}  // namespace lucarne::gi
