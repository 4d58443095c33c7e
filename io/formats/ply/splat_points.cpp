#include "io/formats/ply/splat_points.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "io/formats/ply/splats.h"

namespace lucarne::io::ply {
namespace {

/// Where the attributes are, counted from the first.
constexpr size_t kAxisAt = 3, kRadiusAt = 15, kOpacityAt = 19;
/// A splat whose shortest axis exceeds this share of the middle one has no clear normal.
constexpr float kFlat = 0.6f;

/// Returns the direction of the shortest axis; zero if it is not clearly the shortest.
glm::vec3 shortest_axis(const Splat& splat) {
    const glm::vec3& s = splat.scale;
    const int shortest = s.x <= s.y && s.x <= s.z ? 0 : s.y <= s.z ? 1 : 2;
    const float middle = std::max(std::min(s.x, s.y), std::min(std::max(s.x, s.y), s.z));
    if (!(s[shortest] <= kFlat * middle)) return glm::vec3(0.0f);
    const float length = glm::length(splat.rotation);
    if (!(length > 1e-12f) || !std::isfinite(length)) return glm::vec3(0.0f);
    glm::vec3 axis(0.0f);
    axis[shortest] = 1;
    return splat.rotation / length * axis;
}

}  // namespace

void add_splat_attributes(Schema& schema) {
    schema.add(std::string(names::color), ScalarType::u8, 3);
    schema.add(std::string(names::splat_axis), ScalarType::f32, 3);
    schema.add(std::string(names::splat_radius), ScalarType::f32);
    schema.add("opacity", ScalarType::f32);
}

bool write_splat(const Splat& splat, std::byte* attributes) {
    if (!(splat.opacity >= kLeastOpacity)) return false;
    for (int c = 0; c < 3; ++c) {
        const float value = splat.color[c] >= 0 ? std::min(splat.color[c], 1.0f) : 0.0f;
        store(attributes + c, static_cast<uint8_t>(std::lround(255 * value)));
    }
    store(attributes + kAxisAt, shortest_axis(splat));
    // The integral of the opacity over the splat's plane, 2 pi s1 s2 o, is the area of the disc.
    const glm::vec3& s = splat.scale;
    const float longest = std::max({s.x, s.y, s.z}), shortest = std::min({s.x, s.y, s.z});
    const float middle = s.x + s.y + s.z - longest - shortest;
    const float radius = std::sqrt(2 * std::min(splat.opacity, 1.0f) * longest * std::max(middle, 0.0f));
    store(attributes + kRadiusAt, radius < 1e15f ? radius : 0.0f);  // not a number either
    store(attributes + kOpacityAt, std::min(splat.opacity, 1.0f));
    return true;
}

}  // namespace lucarne::io::ply
