#include "viewer/flythrough/flicker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "gi/compare/metrics.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::viewer {
namespace {

constexpr double kLeastAlbedo = 0.02;
constexpr double kMostOff = 2;          // pixels
constexpr float kLeastCosine = 0.906f;  // 25 degrees

glm::dvec3 wide(const glm::vec4& v) {
    return {v.x, v.y, v.z};
}

/// Returns the point that a pixel shows, in metres relative to the local origin.
glm::dvec3 point_at(const SeenFrame& frame, size_t index) {
    const gi::CameraView& c = frame.camera;
    const glm::vec2 pixel(static_cast<float>(index % c.width), static_cast<float>(index / c.width));
    const glm::vec3 offset = gi::view_offset(c, pixel + 0.5f, frame.texels[index].depth);
    return wide(c.origin) + glm::dvec3(offset);
}

/// Returns the pixel that a point falls into.
std::optional<size_t> pixel_of(const gi::CameraView& c, const glm::dvec3& point) {
    const glm::dvec3 offset = point - wide(c.origin), right = wide(c.right), up = wide(c.up);
    const double depth = glm::dot(offset, wide(c.forward));
    if (!(depth > 0)) return std::nullopt;
    const double x = glm::dot(offset, right) / glm::dot(right, right) / depth;
    const double y = -glm::dot(offset, up) / glm::dot(up, up) / depth;
    if (!(std::abs(x) < 1) || !(std::abs(y) < 1)) return std::nullopt;
    return static_cast<size_t>((y + 1) / 2 * c.height) * c.width + static_cast<size_t>((x + 1) / 2 * c.width);
}

double light(const SeenFrame& frame, size_t index) {
    const glm::vec3 albedo = gi::decode_albedo(frame.texels[index].albedo);
    return gi::luminance(frame.radiance[index]) /
           std::max(gi::luminance(glm::vec4(albedo.x, albedo.y, albedo.z, 0)), kLeastAlbedo);
}

}  // namespace

SeenFrame seen_frame(const Pipeline& pipeline) {
    const gi::GBuffer& gbuffer = pipeline.gbuffer();
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    return {pipeline.camera(), pipeline.local_origin(), pipeline.source().header().metres_per_unit,
            gbuffer.texels.download_all<gi::GBufferTexel>(pixels),
            pipeline.surface_radiance().download_all<glm::vec4>(pixels)};
}

Flicker flicker_between(const SeenFrame& before, const SeenFrame& now) {
    const glm::dvec3 shift = (now.local_origin - before.local_origin) * now.metres_per_unit;
    const double pixel_width =
        2 * glm::length(wide(before.camera.up)) / std::max(before.camera.height, 1u);  // at a depth of 1
    std::vector<std::pair<double, double>> pairs;
    size_t shown = 0;
    double sum = 0;
    for (size_t i = 0; i < now.texels.size(); ++i) {
        if (!(now.texels[i].depth > 0)) continue;
        ++shown;
        const glm::dvec3 point = point_at(now, i) + shift;
        const auto there = pixel_of(before.camera, point);
        if (!there || !(before.texels[*there].depth > 0)) continue;
        const glm::vec3 normal = gi::decode_octahedral(now.texels[i].normal);
        const double off = std::abs(glm::dot(glm::dvec3(normal), point_at(before, *there) - point));
        if (off > kMostOff * pixel_width * before.texels[*there].depth) continue;
        if (glm::dot(normal, gi::decode_octahedral(before.texels[*there].normal)) < kLeastCosine) continue;
        pairs.emplace_back(light(before, *there), light(now, i));
        sum += pairs.back().first + pairs.back().second;
    }
    if (pairs.empty() || !(sum > 0)) return {0, 0};
    const double mean = sum / 2 / static_cast<double>(pairs.size());
    double change = 0;
    for (const auto& [a, b] : pairs) change += 2 * std::abs(b - a) / (a + b + mean / 5);
    return {change / static_cast<double>(pairs.size()),
            static_cast<double>(pairs.size()) / static_cast<double>(shown)};
}

}  // namespace lucarne::viewer
