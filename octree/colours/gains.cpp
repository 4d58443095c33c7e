#include "octree/colours/gains.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

namespace lucarne::octree {
namespace {

constexpr size_t kLeastPatches = 24;
/// Least standard error of a pair, in stops. Vignettes, reflections and tone curves, which no gain describes,
/// do not average out.
constexpr double kSystematic = 0.02;

struct Pair {
    size_t a = 0, b = 0;
    std::array<double, 3> median{}, weight{};  ///< weight: 1 / standard error^2
};

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Pair pair_of(std::span<const PatchRatio> ratios) {
    Pair pair{ratios[0].a, ratios[0].b, {}, {}};
    std::vector<double> values;
    for (size_t channel = 0; channel < 3; ++channel) {
        values.clear();
        for (const PatchRatio& r : ratios) values.push_back(r.ratio[channel] / kLogSteps);
        const double middle = median(values);
        for (double& v : values) v = std::abs(v - middle);
        // For a normal distribution, sigma is 1.4826 times the median deviation, and the standard error of
        // the median sqrt(pi / 2) sigma / sqrt(n).
        const double sigma = 1.4826 * median(values);
        const double variance = 1.5708 * sigma * sigma / static_cast<double>(ratios.size());
        pair.median[channel] = middle;
        pair.weight[channel] = 1 / (variance + kSystematic * kSystematic);
    }
    return pair;
}

std::vector<Pair> pairs_of(std::vector<PatchRatio>& ratios) {
    const auto stations = [](const PatchRatio& r) { return std::tie(r.a, r.b); };
    std::ranges::sort(ratios, {}, stations);
    std::vector<Pair> pairs;
    for (size_t first = 0; first < ratios.size();) {
        size_t last = first;
        while (last < ratios.size() && stations(ratios[last]) == stations(ratios[first])) ++last;
        if (last - first >= kLeastPatches)
            pairs.push_back(pair_of(std::span(ratios).subspan(first, last - first)));
        first = last;
    }
    return pairs;
}

/// Solves the normal equations of one channel by conjugate gradients (Hestenes & Stiefel 1952). The matrix is
/// the pairs' Laplacian plus the identity, so it is positive definite.
std::vector<double> solve_channel(const std::vector<Pair>& pairs, size_t stations, size_t channel) {
    const auto multiplied = [&](const std::vector<double>& x) {
        std::vector<double> y = x;
        for (const Pair& pair : pairs) {
            const double pull = pair.weight[channel] * (x[pair.a] - x[pair.b]);
            y[pair.a] += pull;
            y[pair.b] -= pull;
        }
        return y;
    };
    const auto dot = [](const std::vector<double>& x, const std::vector<double>& y) {
        return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
    };
    std::vector<double> solution(stations), rest(stations);
    for (const Pair& pair : pairs) {
        rest[pair.a] -= pair.weight[channel] * pair.median[channel];
        rest[pair.b] += pair.weight[channel] * pair.median[channel];
    }
    std::vector<double> direction = rest;
    double size = dot(rest, rest);
    const double enough = 1e-20 * size;
    for (size_t step = 0; step < 4 * stations + 100 && size > enough; ++step) {
        const auto image = multiplied(direction);
        const double length = size / dot(direction, image);
        for (size_t i = 0; i < stations; ++i) {
            solution[i] += length * direction[i];
            rest[i] -= length * image[i];
        }
        const double next = dot(rest, rest);
        for (size_t i = 0; i < stations; ++i) direction[i] = rest[i] + next / size * direction[i];
        size = next;
    }
    return solution;
}

}  // namespace

std::vector<std::array<double, 3>> solve_gains(std::vector<PatchRatio> ratios, size_t stations) {
    const std::vector<Pair> pairs = pairs_of(ratios);
    std::vector<std::array<double, 3>> gains(stations);
    if (pairs.empty()) return gains;
    for (size_t channel = 0; channel < 3; ++channel) {
        const auto solution = solve_channel(pairs, stations, channel);
        for (size_t i = 0; i < stations; ++i) gains[i][channel] = solution[i];
    }
    return gains;
}

}  // namespace lucarne::octree
