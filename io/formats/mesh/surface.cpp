#include "io/formats/mesh/surface.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::io::mesh {
namespace {

/// Largest number of texture samples along one side of a sample's square.
constexpr int kMostTaps = 4;

// IEC 61966-2-1.
float to_linear(float s) {
    return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}
uint8_t to_byte(float linear) {
    const float s = linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
    return static_cast<uint8_t>(std::lround(std::clamp(s, 0.0f, 1.0f) * 255));
}
Color8 to_bytes(const glm::vec3& linear) {
    return {to_byte(linear.x), to_byte(linear.y), to_byte(linear.z)};
}

/// Returns the index of a texel along a side of `count` texels.
size_t wrapped(double number, uint32_t count, bool clamp) {
    if (clamp) return static_cast<size_t>(std::clamp(number, 0.0, count - 1.0));
    const double whole = number - std::floor(number / count) * count;
    return std::min<size_t>(static_cast<size_t>(std::max(whole, 0.0)), count - 1);
}

}  // namespace

Surface::Surface(const Mesh& mesh, double spacing) : mesh_(mesh), spacing_(spacing) {
    for (size_t i = 0; i < linear_.size(); ++i) linear_[i] = to_linear(static_cast<float>(i) / 255);
}

glm::vec3 Surface::normal(const Sample& sample) const {
    const auto [a, b, c] = mesh_.points(sample.triangle);
    const glm::vec3 face = glm::normalize(glm::cross(b - a, c - a));
    if (mesh_.normals.empty()) return face;
    const Corners& corners = mesh_.normal_corners.empty() ? mesh_.triangles[sample.triangle]
                                                          : mesh_.normal_corners[sample.triangle];
    const std::array weights = {1 - sample.share.x - sample.share.y, sample.share.x, sample.share.y};
    glm::vec3 sum(0.0f);
    for (size_t i = 0; i < 3; ++i) {
        if (corners[i] == kNone) return face;
        const glm::vec3& n = mesh_.normals[corners[i]];
        const float length = glm::length(n);
        if (!(length > 0) || !std::isfinite(length)) return face;
        sum += n * (weights[i] / length);
    }
    const float length = glm::length(sum);
    return length > 1e-3f ? sum / length : face;
}

Color8 Surface::color(const Sample& sample) const {
    const uint32_t triangle = sample.triangle;
    const Material* material = nullptr;
    if (!mesh_.face_materials.empty() && mesh_.face_materials[triangle] != kNone)
        material = &mesh_.materials[mesh_.face_materials[triangle]];
    if (material && material->texture != kNone && !mesh_.coordinates.empty()) {
        const Corners& corners =
            mesh_.coordinate_corners.empty() ? mesh_.triangles[triangle] : mesh_.coordinate_corners[triangle];
        const bool whole =
            std::none_of(corners.begin(), corners.end(), [](uint32_t c) { return c == kNone; });
        if (whole) return textured(sample, *material, corners);
    }
    if (!mesh_.face_colors.empty()) return mesh_.face_colors[triangle];
    if (!mesh_.colors.empty()) {
        const auto of = [&](size_t corner) {
            const Color8& c = mesh_.colors[mesh_.triangles[triangle][corner]];
            return glm::vec3(linear_[c[0]], linear_[c[1]], linear_[c[2]]);
        };
        return to_bytes(of(0) * (1 - sample.share.x - sample.share.y) + of(1) * sample.share.x +
                        of(2) * sample.share.y);
    }
    return material && material->color ? *material->color : kNoColor;
}

/// Averages taps on a grid over a square of the spacing in the triangle's plane. Taps outside the triangle
/// are skipped, because the texture may show anything there.
Color8 Surface::textured(const Sample& sample, const Material& material, const Corners& corners) const {
    const Image8& image = mesh_.textures[material.texture];
    const auto [a, b, c] = mesh_.points(sample.triangle);
    const auto coordinate = [&](size_t i) {
        return glm::dvec2(mesh_.coordinates[corners[i]]) * material.scale + material.offset;
    };
    const glm::dvec2 origin = coordinate(0), along_u = coordinate(1) - origin,
                     along_v = coordinate(2) - origin;
    const glm::dvec3 u = b - a, v = c - a;
    const double area = glm::length(glm::cross(u, v));
    const double texels =
        std::abs(along_u.x * along_v.y - along_u.y * along_v.x) * image.width * image.height;
    const double wanted = spacing_ * std::sqrt(texels / area);
    const int taps = wanted < kMostTaps ? std::max(1, static_cast<int>(std::lround(wanted))) : kMostTaps;
    // Two orthogonal directions in the plane, as corner weights.
    const double uu = glm::dot(u, u), uv = glm::dot(u, v);
    const double length = std::sqrt(uu), height = area / length;
    const glm::dvec2 right(spacing_ / length, 0), up(-uv / uu * spacing_ / height, spacing_ / height);
    glm::vec3 sum(0.0f);
    float count = 0;
    for (int i = 0; i < taps * taps; ++i) {
        const double x = (i % taps + 0.5) / taps - 0.5, y = (i / taps + 0.5) / taps - 0.5;
        const glm::dvec2 share = glm::dvec2(sample.share) + right * x + up * y;
        if (taps > 1 && !(share.x >= 0 && share.y >= 0 && share.x + share.y <= 1)) continue;
        sum += texel(image, material, origin + along_u * share.x + along_v * share.y);
        ++count;
    }
    if (count > 0) return to_bytes(sum / count);
    return to_bytes(texel(image, material,
                          origin + along_u * static_cast<double>(sample.share.x) +
                              along_v * static_cast<double>(sample.share.y)));
}

/// Interpolates between four texels in linear light. v points up, rows count down.
glm::vec3 Surface::texel(const Image8& image, const Material& material, const glm::dvec2& at) const {
    const double x = at.x * image.width - 0.5, y = (1 - at.y) * image.height - 0.5;
    if (!(std::abs(x) < 1e15) || !(std::abs(y) < 1e15)) return glm::vec3(linear_[kNoColor[0]]);
    const double left = std::floor(x), top = std::floor(y);
    glm::vec3 sum(0.0f);
    for (int k = 0; k < 4; ++k) {
        const int right = k & 1, down = k >> 1;
        const size_t column = wrapped(left + right, image.width, material.clamp);
        const size_t row = wrapped(top + down, image.height, material.clamp);
        const uint8_t* rgb = &image.bytes[3 * (row * image.width + column)];
        const auto weight =
            static_cast<float>((right != 0 ? x - left : left + 1 - x) * (down != 0 ? y - top : top + 1 - y));
        sum += glm::vec3(linear_[rgb[0]], linear_[rgb[1]], linear_[rgb[2]]) * weight;
    }
    return sum;
}

}  // namespace lucarne::io::mesh
