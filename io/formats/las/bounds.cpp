#include "io/formats/las/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/formats/common/format.h"
#include "io/points.h"

namespace lucarne::io::las {
namespace {

int32_t clamped(double value) {
    using Limits = std::numeric_limits<int32_t>;
    return static_cast<int32_t>(std::clamp<double>(value, Limits::min(), Limits::max()));
}

}  // namespace

std::optional<std::array<glm::dvec3, 2>> stated_box(const Header& header) {
    for (int axis = 0; axis < 3; ++axis)
        if (!usable(header.low[axis]) || !usable(header.high[axis]) || header.low[axis] > header.high[axis])
            return std::nullopt;
    return std::array{header.low, header.high};
}

StatedBounds::StatedBounds(const Header& header) {
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double side = header.high[axis] - header.low[axis];
        if (!(side >= 0) || !usable(header.low[axis]) || !usable(header.high[axis])) return;
        longest = std::max(longest, side);
    }
    stated_ = longest > 0;
    for (int axis = 0; axis < 3 && stated_; ++axis) {
        const auto integer = [&](double at) {
            return clamped((at - header.offset[axis]) / header.scale[axis]);
        };
        range_[static_cast<size_t>(axis)] =
            std::minmax({integer(header.low[axis] - longest), integer(header.high[axis] + longest)});
    }
}

std::optional<size_t> StatedBounds::outside(const std::byte* records, size_t count, size_t stride,
                                            size_t step) const {
    if (!stated_) return std::nullopt;
    for (size_t i = 0; i < count; i += step)
        for (size_t axis = 0; axis < 3; ++axis) {
            const auto at = load<int32_t>(records + i * stride + 4 * axis);
            if (at < range_[axis].first || at > range_[axis].second) return i;
        }
    return std::nullopt;
}

}  // namespace lucarne::io::las
