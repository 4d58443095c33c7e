#include "viewer/opening/colour_cast.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::viewer {
namespace {

/// The share that counts as cast, by the ratio of the strongest component to the weakest: paint rarely
/// colours a whole scan as strongly as tungsten light does. .6 was chosen on scans of white rooms
/// and of yellow walls, .85 on a cellar photographed by tungsten light, whose ceiling was red with .6.
constexpr double kShareOfWeak = .6, kShareOfStrong = .85, kWeak = 2, kStrong = 4;
constexpr double kWeakest = .04;  ///< component's square over that of the strongest

/// Root mean square of the luminance, linear, below which a scan is dark. That of 20 scans photographed
/// by day and by lamps was .22 to .9, of two dark ones .07.
constexpr double kDarkScan = .18;

double share_of(double ratio) {
    const double strength = std::clamp((ratio - kWeak) / (kStrong - kWeak), 0.0, 1.0);
    return glm::mix(kShareOfWeak, kShareOfStrong, strength);
}

}  // namespace

void ColourCast::add(const io::Schema& schema, const std::byte* record, double white) {
    const io::Attribute* color = schema.find(io::names::color);
    if (!color || color->components != 3) return;
    const std::byte* at = record + color->offset;
    glm::dvec3 colour;
    for (int c = 0; c < 3; ++c, at += io::scalar_bytes(color->type)) {
        const double share = io::scalar_at(color->type, at) / white;
        if (!(share >= 0 && share <= 1)) return;
        colour[c] = gi::srgb_to_linear(static_cast<float>(share));
    }
    sum_ += colour * colour;
    ++count_;
}

double ColourCast::brightness() const {
    if (!coloured()) return 1;
    const double mean = std::sqrt(gi::luminance(sum_) / static_cast<double>(count_));
    return std::clamp(kDarkScan / mean, 1.0, kMostBrightness);
}

glm::dvec3 ColourCast::result() const {
    const double most = std::max({sum_.x, sum_.y, sum_.z});
    if (!(most > 0)) return glm::dvec3(1.0);
    const glm::dvec3 squares = glm::max(sum_ / most, kWeakest);
    const double ratio = 1 / std::sqrt(std::min({squares.x, squares.y, squares.z}));
    const glm::dvec3 light = glm::pow(squares, glm::dvec3(share_of(ratio) / 2));
    return light / gi::luminance(light);
}

}  // namespace lucarne::viewer
