#include "viewer/opening/colour_cast.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::viewer {
namespace {

/// Chosen on four scans: two of white rooms, one of yellow walls,
/// and a cellar photographed by tungsten light.
constexpr double kShare = .6;
constexpr double kWeakest = .01;  ///< component's square over that of the strongest

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
}

glm::dvec3 ColourCast::result() const {
    const double most = std::max({sum_.x, sum_.y, sum_.z});
    if (!(most > 0)) return glm::dvec3(1.0);
    const glm::dvec3 light = glm::pow(glm::max(sum_ / most, kWeakest), glm::dvec3(kShare / 2));
    return light / gi::luminance(light);
}

}  // namespace lucarne::viewer
