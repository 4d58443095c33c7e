// Based on: Preetham, Shirley & Smits 1999, "A Practical Analytic Model for Daylight", SIGGRAPH 99.
#include "gi/scene/sky_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "gi/scene/photometry.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;

constexpr double kSkyPi = std::numbers::pi;
/// Texels are so small that neighbours look alike, and the sky is smooth: a texel's middle is its mean.
constexpr uint32_t kSkyWidth = 384, kSkyHeight = 192;
/// Twilight: illuminance falls from 3.4 lx at -6 degrees to .008 lx at -12 and .0007 lx at night (Seidelmann
/// 1992, "Explanatory Supplement to the Astronomical Almanac", section 9.3).
constexpr double kDegreesPerTenth = 2, kNightElevation = -14;

/// One curve of Perez et al. 1993, for Y, x and y at once.
struct PerezCurves {
    dvec3 a, b, c, d, e;

    /// Appendix A.2.
    explicit PerezCurves(double t)
        : a(dvec3(.1787, -.0193, -.0167) * t + dvec3(-1.4630, -.2592, -.2608)),
          b(dvec3(-.3554, -.0665, -.0950) * t + dvec3(.4275, .0008, .0092)),
          c(dvec3(-.0227, -.0004, -.0079) * t + dvec3(5.3251, .2125, .2102)),
          d(dvec3(.1206, -.0641, -.0441) * t + dvec3(-2.5771, -.8989, -1.6537)),
          e(dvec3(-.0670, -.0033, -.0109) * t + dvec3(.3703, .0452, .0529)) {}

    /// Eq. 3 in two factors. `cosine` is of the angle from the zenith.
    dvec3 by_height(double cosine) const { return 1.0 + a * glm::exp(b / std::max(cosine, 1e-3)); }
    dvec3 by_angle_from_sun(double cosine) const {
        return 1.0 + c * glm::exp(d * std::acos(std::clamp(cosine, -1.0, 1.0))) + e * cosine * cosine;
    }
};

/// Returns Y (cd/m^2), x and y of the zenith; `s` is the sun's angle from the zenith (appendix A.2).
dvec3 zenith(double t, double s) {
    const double chi = (4.0 / 9 - t / 120) * (kSkyPi - 2 * s);
    const double luminance = (4.0453 * t - 4.9710) * std::tan(chi) - .2155 * t + 2.4192;
    const auto cubic = [&](double c3, double c2, double c1, double c0) {
        return ((c3 * s + c2) * s + c1) * s + c0;
    };
    const double x = (cubic(.00166, -.00375, .00209, 0) * t + cubic(-.02903, .06377, -.03202, .00394)) * t +
                     cubic(.11693, -.21196, .06052, .25886);
    const double y = (cubic(.00275, -.00610, .00317, 0) * t + cubic(-.04214, .08970, -.04153, .00516)) * t +
                     cubic(.15346, -.26756, .06670, .26688);
    return {1000 * luminance, x, y};
}

/// Returns the share of light that is left `elevation` degrees above (below: negative) the horizon.
double twilight(double elevation) {
    return std::pow(10, std::clamp(elevation, kNightElevation, 0.0) / kDegreesPerTenth);
}

double elevation_of(const dvec3& direction) {
    return glm::degrees(std::asin(std::clamp(direction.z, -1.0, 1.0)));
}

/// Watts of white light for X, Y, Z in lumens. Colours out of gamut keep their luminance nearly.
dvec3 watts_of(const dvec3& xyz) {
    return glm::max(rec709_of(xyz), 0.0) / kLumensPerWatt;
}

/// A sky for one position of the sun.
class PreethamSky {
 public:
    explicit PreethamSky(const SkySettings& sky) : curves_(sky.turbidity), sun_(sky.sun) {
        sun_.z = std::max(sun_.z, 0.0);
        const double length = glm::length(sun_);
        sun_ = length > 0 ? sun_ / length : dvec3(1, 0, 0);  // straight below: as good as any
        zenith_ = zenith(sky.turbidity, std::acos(std::min(sun_.z, 1.0)));
        zenith_.x *= twilight(elevation_of(sky.sun));
        scale_ = zenith_ / (curves_.by_height(1) * curves_.by_angle_from_sun(sun_.z));
    }

    dvec3 by_height(double z) const { return curves_.by_height(z); }
    /// Returns the radiance from a direction above the horizon, of which `by_height` is known.
    dvec3 radiance(const dvec3& direction, const dvec3& by_height) const {
        const dvec3 yxy = scale_ * by_height * curves_.by_angle_from_sun(glm::dot(direction, sun_));
        const double luminance = std::max(yxy.x, 0.0), x = yxy.y, y = yxy.z;
        return watts_of(dvec3(x / y, 1, (1 - x - y) / y) * luminance);
    }

 private:
    PerezCurves curves_;
    dvec3 sun_, zenith_{0.0}, scale_{0.0};
};

// Table 2 of the paper from 380 to 750 nm in steps of 10.
constexpr int kFirstWavelength = 380, kWavelengthStep = 10;  ///< nm
/// Radiance of the sun outside the atmosphere, 10 W/(m^2 nm sr).
constexpr std::array kSunSpectrum = {1655.90, 1623.37, 2112.75, 2588.82, 2582.91, 2423.23, 2676.05, 2965.83,
                                     3054.54, 3005.75, 3066.37, 2883.04, 2871.21, 2782.50, 2710.06, 2723.36,
                                     2636.13, 2550.38, 2506.02, 2531.16, 2535.59, 2513.42, 2463.15, 2417.32,
                                     2368.53, 2321.21, 2282.77, 2233.98, 2197.02, 2152.67, 2109.79, 2072.83,
                                     2024.04, 1987.08, 1942.72, 1907.24, 1862.89, 1825.92};
constexpr double kSpectrumUnit = 10;
/// Absorption by ozone and by water vapour, 1/cm. Mixed gases absorb only from 759 nm on, where eyes see
/// nothing.
constexpr std::array kOzone = {0.,   0.,   0.,   0.,   0.,   0.,   0.,   .003, .006, .009, .014, .021, .03,
                               .04,  .048, .063, .075, .085, .103, .12,  .12,  .115, .125, .12,  .105, .09,
                               .079, .067, .057, .048, .036, .028, .023, .018, .014, .011, .010, .009};
constexpr std::array kVapour = {.016, .024, .0125, 1., .87, .061, .001};  ///< the last of the wavelengths
constexpr double kOzoneDepth = .35, kVapourDepth = 2;                     ///< cm of ozone, of liquid water

/// CIE 1931 colour matching functions. Source: Wyman, Sloan & Shirley 2013, "Simple Analytic Approximations
/// to the CIE XYZ Color Matching Functions", eq. 4 and table 1 (the fit in several lobes).
dvec3 colour_matching(double nm) {
    const auto lobe = [nm](double middle, double below, double above) {
        const double t = (nm - middle) / (nm < middle ? below : above);
        return std::exp(-.5 * t * t);
    };
    return {1.056 * lobe(599.8, 37.9, 31.0) + .362 * lobe(442.0, 16.0, 26.7) - .065 * lobe(501.1, 20.4, 26.2),
            .821 * lobe(568.8, 46.9, 40.5) + .286 * lobe(530.9, 16.3, 31.1),
            1.217 * lobe(437.0, 11.8, 36.0) + .681 * lobe(459.0, 26.0, 13.8)};
}

/// Returns the share of the sun's light of a wavelength that passes `mass` times the air above (appendix
/// A.1). `haze` is Angstrom's turbidity coefficient.
double transmitted_share(size_t wavelength, double mass, double haze) {
    const double um = (kFirstWavelength + kWavelengthStep * static_cast<double>(wavelength)) / 1000;
    const double molecules = .008735 * std::pow(um, -4.08), aerosol = haze * std::pow(um, -1.3);
    double share = std::exp(-mass * (molecules + aerosol + kOzone[wavelength] * kOzoneDepth));
    const size_t first = kSunSpectrum.size() - kVapour.size();
    if (wavelength >= first) {
        const double water = kVapour[wavelength - first] * kVapourDepth * mass;
        share *= std::exp(-.2385 * water / std::pow(1 + 20.07 * water, .45));
    }
    return share;
}

dvec3 direction_to(const SceneLight& sun) {
    // Not from its position, which may be so far from the origin that its last digits are lost.
    if (sun.sun) return towards(solar_position(*sun.sun), sun.sun->north);
    return glm::normalize(sun.position - sun.target);
}

}  // namespace

dvec3 sky_radiance(const SkySettings& sky, const dvec3& direction) {
    if (direction.z < 0) return dvec3(0);
    const PreethamSky model(sky);
    return model.radiance(direction, model.by_height(direction.z));
}

dvec3 sun_irradiance(double elevation, double turbidity) {
    static_assert(kSunSpectrum.size() == kOzone.size());
    if (!(elevation > 0)) return dvec3(0);
    const double from_zenith = 90 - std::min(elevation, 90.0);
    const double mass =
        1 / (std::sin(glm::radians(elevation)) + .15 * std::pow(93.885 - from_zenith, -1.253));
    const double haze = .04608365822050 * turbidity - .04586025928522;
    dvec3 xyz(0);
    for (size_t i = 0; i < kSunSpectrum.size(); ++i)
        xyz += colour_matching(kFirstWavelength + kWavelengthStep * static_cast<double>(i)) *
               (kSunSpectrum[i] * transmitted_share(i, mass, haze));
    const double solid_angle = kSkyPi * std::sin(kSunRadius) * std::sin(kSunRadius);
    // The disc rises from behind the horizon over its radius, so that the light does not jump.
    const double risen = std::min(glm::radians(elevation) / kSunRadius, 1.0);
    return watts_of(xyz * (683 * kWavelengthStep * kSpectrumUnit * solid_angle * risen));
}

Environment sky_environment(const SkySettings& sky) {
    Environment made;
    made.width = kSkyWidth;
    made.height = kSkyHeight;
    made.sky = sky;
    // The sun is in the middle of the picture, whose halves are mirror images.
    made.rotation =
        sky.sun.x == 0 && sky.sun.y == 0 ? 0.0f : static_cast<float>(-std::atan2(sky.sun.x, sky.sun.y));
    SkySettings turned = sky;
    turned.sun = {0, std::hypot(sky.sun.x, sky.sun.y), sky.sun.z};
    const PreethamSky model(turned);
    dvec3 irradiance = sun_irradiance(elevation_of(sky.sun), sky.turbidity) * std::max(sky.sun.z, 0.0);
    made.texels.resize(size_t{kSkyWidth} * kSkyHeight);
    for (uint32_t row = 0; row < kSkyHeight / 2; ++row) {
        const double top = std::cos(row * kSkyPi / kSkyHeight);
        const double low = std::cos((row + 1) * kSkyPi / kSkyHeight);
        const double z = (top + low) / 2, across = std::sqrt(1 - z * z);
        const dvec3 by_height = model.by_height(z);
        dvec3 sum(0);
        for (uint32_t column = 0; column < kSkyWidth / 2; ++column) {
            const double turns = 2 * kSkyPi * (column + .5) / kSkyWidth;
            const dvec3 radiance =
                model.radiance({across * std::sin(turns), across * std::cos(turns), z}, by_height);
            const size_t middle = size_t{row} * kSkyWidth + kSkyWidth / 2;
            made.texels[middle + column] = made.texels[middle - 1 - column] = glm::vec3(radiance);
            sum += 2.0 * radiance;
        }
        irradiance += sum * ((top * top - low * low) * kSkyPi / kSkyWidth);
    }
    const auto ground = made.texels.begin() + static_cast<ptrdiff_t>(made.texels.size() / 2);
    std::fill(ground, made.texels.end(), glm::vec3(irradiance * (sky.ground / kSkyPi)));
    return made;
}

std::optional<dvec3> direction_to_sun(const std::vector<SceneLight>& lights) {
    const auto sun = std::ranges::find(lights, LightKind::directional, &SceneLight::kind);
    return sun == lights.end() ? std::nullopt : std::optional(direction_to(*sun));
}

void update_daylight(Scene& scene) {
    std::optional<SkySettings> sky = scene.environment ? scene.environment->sky : std::nullopt;
    if (sky) {
        sky->sun = direction_to_sun(scene.lights).value_or(sky->sun);
        if (sky != scene.environment->sky || scene.environment->texels.size() == 1)
            scene.environment = std::make_shared<const Environment>(sky_environment(*sky));
    }
    for (SceneLight& light : scene.lights) {
        if (light.kind != LightKind::directional || !light.daylight) continue;
        light.strength =
            sun_irradiance(elevation_of(direction_to(light)), sky ? sky->turbidity : SkySettings{}.turbidity);
    }
}

}  // namespace lucarne::gi
