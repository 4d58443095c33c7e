#include "io/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucarne::io {
namespace {

constexpr double kLargest = std::numeric_limits<int32_t>::max();
constexpr int kUsualDigits = 3, kMostDigits = 12, kFewestDigits = -300;

/// Returns 10^-digits, rounded as if read from text: powers up to 10^22 are exact.
double step_of(int digits) {
    return digits >= 0 ? 1.0 / std::pow(10.0, digits) : std::pow(10.0, -digits);
}

/// Returns 0 if the integers reach the box from there. Otherwise returns the middle of the box, rounded to a
/// multiple of max(1, step).
double offset_of(double low, double high, double step) {
    if (std::max(std::abs(low), std::abs(high)) <= kLargest * step) return 0.0;
    const double unit = std::max(1.0, step);
    return std::nearbyint((low / 2 + high / 2) / unit) * unit;
}

bool reaches(double low, double high, double offset, double step) {
    return std::max(high - offset, offset - low) <= kLargest * step;
}

}  // namespace

std::optional<Lattice> common_lattice(std::span<const Lattice> lattices, const PositionBox& box) {
    if (lattices.empty()) return std::nullopt;
    constexpr double kNear = 1e-6;  // of a step: allows for decimal fractions that are inexact in binary
    const auto whole = [](double steps) { return std::abs(steps - std::nearbyint(steps)) < kNear; };
    Lattice common;
    for (int axis = 0; axis < 3; ++axis) {
        double step = std::abs(lattices[0].scale[axis]);
        for (const Lattice& each : lattices) step = std::min(step, std::abs(each.scale[axis]));
        double offset = lattices[0].offset[axis];
        for (const Lattice& each : lattices)
            if (!(step > 0) || !whole(each.scale[axis] / step) || !whole((each.offset[axis] - offset) / step))
                return std::nullopt;
        const double low = box[0][axis], high = box[1][axis];
        constexpr double kRound = 1000;  // steps; offsets move by multiples of it to stay round
        if (!reaches(low, high, offset, step))
            offset += std::nearbyint((low / 2 + high / 2 - offset) / step / kRound) * kRound * step;
        if (!reaches(low, high, offset, step)) return std::nullopt;
        common.scale[axis] = step;
        common.offset[axis] = offset;
    }
    return common;
}

DecimalSearch::DecimalSearch(const Schema& schema, const PositionBox& box) : schema_(schema) {
    for (int axis = 0; axis < 3; ++axis)
        axes_[static_cast<size_t>(axis)] = axis_of(box[0][axis], box[1][axis]);
}

DecimalSearch::Axis DecimalSearch::axis_of(double low, double high) {
    Axis axis;
    axis.low = low;
    axis.high = high;
    axis.tolerance = std::max(std::abs(low), std::abs(high)) * 0x1p-51;  // four units in the last place
    const auto allowed = [&](int digits) {
        const double step = step_of(digits);
        return step >= 4 * axis.tolerance && reaches(low, high, offset_of(low, high, step), step);
    };
    axis.most = kMostDigits;
    while (axis.most > kFewestDigits && !allowed(axis.most)) --axis.most;
    axis.digits = std::min(kUsualDigits, axis.most);
    axis.factor = std::pow(10.0, axis.digits);
    return axis;
}

bool DecimalSearch::add(std::span<const std::byte> records) {
    const bool single = schema_.position == PositionType::f32;
    any_ = any_ || !records.empty();
    for (size_t at = 0; at < records.size(); at += schema_.stride) {
        const glm::dvec3 position = position_of(schema_, &records[at]);
        for (int i = 0; i < 3; ++i) {
            Axis& axis = axes_[static_cast<size_t>(i)];
            const auto holds = [&axis, x = position[i], single] {
                const double near = std::nearbyint(x * axis.factor) / axis.factor;
                return single ? static_cast<float>(near) == static_cast<float>(x)
                              : std::abs(near - x) <= axis.tolerance;
            };
            while (axis.exact && !holds()) {
                axis.exact = axis.digits < axis.most;
                if (axis.exact) axis.factor = std::pow(10.0, ++axis.digits);
            }
        }
    }
    return axes_[0].exact || axes_[1].exact || axes_[2].exact;
}

Lattice DecimalSearch::found() const {
    int common = kFewestDigits;  // exact axes get the same number of decimals, where their boxes allow it
    for (const Axis& axis : axes_)
        if (axis.exact) common = std::max(common, axis.digits);
    Lattice lattice;
    for (int i = 0; i < 3; ++i) {
        const Axis& axis = axes_[static_cast<size_t>(i)];
        const double step = step_of(any_ && axis.exact ? std::min(common, axis.most) : axis.most);
        lattice.scale[i] = step;
        lattice.offset[i] = offset_of(axis.low, axis.high, step);
    }
    return lattice;
}

}  // namespace lucarne::io
