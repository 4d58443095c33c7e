// Based on: Andersson et al. 2020, "FLIP: a difference evaluator for alternating images", sec. 4: a colour
// pipeline and a feature pipeline, with the constants and names of the paper. All of its filters are sums of
// separable filters and are applied as such.
#include "gi/compare/flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

using glm::vec3;
using Kernel = std::vector<float>;  // odd, centred
using Plane = std::vector<float>;

constexpr size_t kRows = 16;  // rows in a piece of parallel work

// Linear Rec. 709 to CIE XYZ (IEC 61966-2-1, from the primaries and D65 without rounding); columns of the
// matrix.
const glm::dmat3 kRgbToXyz(10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382,  //
                           8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382,   //
                           4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382);

/// The paper's colour spaces, based on XYZ relative to the white of the screen.
struct ColourSpaces {
    glm::mat3 to_white_relative, from_white_relative;

    ColourSpaces() {
        const glm::dvec3 white = kRgbToXyz * glm::dvec3(1.0);
        glm::dmat3 relative = kRgbToXyz;
        for (int column = 0; column < 3; ++column) relative[column] /= white;
        to_white_relative = glm::mat3(relative);
        from_white_relative = glm::mat3(glm::inverse(relative));
    }

    /// The opponent space Y Cx Cz (Flynn et al.), linear in light.
    vec3 opponent(vec3 rgb) const {
        const vec3 x = to_white_relative * rgb;
        return {116 * x.y - 16, 500 * (x.x - x.y), 200 * (x.y - x.z)};
    }
    vec3 rgb(vec3 opponent) const {
        const float y = (opponent.x + 16) / 116;
        return from_white_relative * vec3(y + opponent.y / 500, y, y - opponent.z / 200);
    }
    /// CIE L*a*b* with the Hunt effect: chroma grows with lightness.
    vec3 hunt_lab(vec3 rgb) const {
        const auto f = [](float t) {
            constexpr float kDelta = 6.0f / 29;
            return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
        };
        const vec3 x = to_white_relative * rgb;
        const float fy = f(x.y), lightness = 116 * fy - 16;
        return {lightness, 0.01f * lightness * 500 * (f(x.x) - fy), 0.01f * lightness * 200 * (fy - f(x.z))};
    }
};

/// HyAB (Abasi et al. 2020), a distance that also holds for large colour differences.
float hyab(vec3 a, vec3 b) {
    const vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

/// Returns exp(-x^2 / (2 variance)) * factor(x) at the pixels up to `radius` from the centre.
template <class Factor>
Kernel bell(double variance, int radius, const Factor& factor) {
    Kernel kernel;
    for (int x = -radius; x <= radius; ++x)
        kernel.push_back(static_cast<float>(factor(x) * std::exp(-x * x / (2 * variance))));
    return kernel;
}

double sum(const Kernel& kernel) {
    double total = 0;
    for (const float weight : kernel) total += weight;
    return total;
}

/// Scales the kernel so that positive weights add up to 1 and negative ones to -1.
Kernel normalised(Kernel kernel) {
    double positive = 0, negative = 0;
    for (const float weight : kernel) (weight > 0 ? positive : negative) += weight;
    for (float& weight : kernel)
        weight = static_cast<float>(weight > 0 ? weight / positive : -weight / negative);
    return kernel;
}

/// Applies `columns` along x, then `rows` along y. The picture's edge pixels are repeated beyond its edge.
Plane convolve(const Plane& in, size_t width, const Kernel& columns, const Kernel& rows) {
    const size_t height = in.size() / width;
    Plane across(in.size()), out(in.size());
    const auto clamped = [](size_t at, size_t offset, size_t radius, size_t size) {
        return std::min(std::max(at + offset, radius) - radius, size - 1);
    };
    parallel_ranges(height, kRows, [&](size_t first, size_t last) {
        const size_t radius = columns.size() / 2;
        Plane padded(width + 2 * radius);
        for (size_t y = first; y < last; ++y) {
            for (size_t x = 0; x < padded.size(); ++x)
                padded[x] = in[y * width + clamped(x, 0, radius, width)];
            for (size_t k = 0; k < columns.size(); ++k)
                for (size_t x = 0; x < width; ++x) across[y * width + x] += columns[k] * padded[x + k];
        }
    });
    parallel_ranges(height, kRows, [&](size_t first, size_t last) {
        for (size_t y = first; y < last; ++y)
            for (size_t k = 0; k < rows.size(); ++k) {
                const float* from = &across[clamped(y, k, rows.size() / 2, height) * width];
                for (size_t x = 0; x < width; ++x) out[y * width + x] += rows[k] * from[x];
            }
    });
    return out;
}

/// A contrast sensitivity function: a sum of Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
    struct Term {
        double a, b;
    } terms[2];
};
// Achromatic, red-green, blue-yellow (Johnson and Fairchild 2003, as fitted by Andersson et al.).
constexpr Sensitivity kSensitivities[] = {
    {{{1, 0.0047}, {0, 1e-5}}}, {{{1, 0.0053}, {0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}};

/// Removes what the eye does not resolve at this distance.
Plane filter(const Plane& channel, size_t width, const Sensitivity& sensitivity, double pixels_per_degree) {
    constexpr double kPi = std::numbers::pi, kWidest = 0.04;  // the largest b: one radius for all channels
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * pixels_per_degree));
    Plane out(channel.size());
    double total = 0;
    for (const auto& [a, b] : sensitivity.terms) {
        if (a == 0) continue;
        const Kernel kernel = bell(b * pixels_per_degree * pixels_per_degree / (2 * kPi * kPi), radius,
                                   [](double) { return 1.0; });
        const double factor = a * std::sqrt(kPi / b);
        total += factor * sum(kernel) * sum(kernel);
        const Plane term = convolve(channel, width, kernel, kernel);
        for (size_t i = 0; i < out.size(); ++i) out[i] += static_cast<float>(factor) * term[i];
    }
    for (float& value : out) value /= static_cast<float>(total);
    return out;
}

/// What the eye sees of a picture: its colours, and how strong an edge and a point each pixel is.
struct Seen {
    std::vector<vec3> colours;  // L*a*b*, Hunt-adjusted
    std::vector<glm::vec2> features;
};

/// Returns the magnitude of the responses along x and y.
Plane feature(const Plane& lightness, size_t width, const Kernel& derivative, const Kernel& smooth) {
    Plane out = convolve(lightness, width, derivative, smooth);
    const Plane down = convolve(lightness, width, smooth, derivative);
    for (size_t i = 0; i < out.size(); ++i) out[i] = std::sqrt(out[i] * out[i] + down[i] * down[i]);
    return out;
}

std::vector<glm::vec2> features(const Plane& lightness, size_t width, double pixels_per_degree) {
    constexpr double kWidth = 0.082;  // of a feature, degrees
    const double sigma = 0.5 * kWidth * pixels_per_degree, variance = sigma * sigma;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const Kernel smooth = normalised(bell(variance, radius, [](double) { return 1.0; }));
    const Kernel first = normalised(bell(variance, radius, [](double x) { return -x; }));
    const Kernel second = normalised(bell(variance, radius, [&](double x) { return x * x / variance - 1; }));
    const Plane edge = feature(lightness, width, first, smooth),
                point = feature(lightness, width, second, smooth);
    std::vector<glm::vec2> both(edge.size());
    for (size_t i = 0; i < both.size(); ++i) both[i] = {edge[i], point[i]};
    return both;
}

Seen see(std::span<const glm::vec4> picture, size_t width, double pixels_per_degree,
         const ColourSpaces& spaces) {
    Plane channels[3];
    Plane lightness;
    for (const glm::vec4& pixel : picture) {
        const vec3 opponent = spaces.opponent(glm::clamp(vec3(pixel), 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c) channels[c].push_back(opponent[c]);
        lightness.push_back((opponent.x + 16) / 116);  // back to [0, 1]
    }
    Seen seen;
    seen.features = features(lightness, width, pixels_per_degree);
    for (int c = 0; c < 3; ++c)
        channels[c] = filter(channels[c], width, kSensitivities[c], pixels_per_degree);
    seen.colours.resize(picture.size());
    parallel_ranges(picture.size(), kRows * width, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const vec3 rgb = spaces.rgb({channels[0][i], channels[1][i], channels[2][i]});
            seen.colours[i] = spaces.hunt_lab(glm::clamp(rgb, 0.0f, 1.0f));
        }
    });
    return seen;
}

/// Compresses large differences. `most` is the difference of green and blue, the largest there is.
float redistribute(float difference, float most) {
    constexpr float kPc = 0.4f, kPt = 0.95f;
    const float bend = kPc * most;
    return difference < bend ? kPt / bend * difference
                             : kPt + (difference - bend) / (most - bend) * (1 - kPt);
}

}  // namespace

std::vector<float> flip_errors(std::span<const glm::vec4> a, std::span<const glm::vec4> b, uint32_t width,
                               double pixels_per_degree) {
    assert(a.size() == b.size() && width > 0 && a.size() % width == 0);
    constexpr float kQc = 0.7f, kQf = 0.5f;
    const ColourSpaces spaces;
    const Seen first = see(a, width, pixels_per_degree, spaces),
               second = see(b, width, pixels_per_degree, spaces);
    const float most = std::pow(hyab(spaces.hunt_lab({0, 1, 0}), spaces.hunt_lab({0, 0, 1})), kQc);
    std::vector<float> errors(a.size());
    parallel_ranges(a.size(), kRows * width, [&](size_t from, size_t to) {
        for (size_t i = from; i < to; ++i) {
            const float colour = redistribute(std::pow(hyab(first.colours[i], second.colours[i]), kQc), most);
            const glm::vec2 apart = glm::abs(first.features[i] - second.features[i]);
            const float detail = std::pow(std::max(apart.x, apart.y) / std::numbers::sqrt2_v<float>, kQf);
            errors[i] = std::pow(colour, 1 - detail);
        }
    });
    return errors;
}

}  // namespace lucarne::gi
