#include "io/formats/las/bounds.h"

#include <algorithm>
#include <cmath>
#include <cstring>
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

std::optional<std::array<glm::dvec3, 2>> stated_box(const std::filesystem::path& path) {
    constexpr size_t kBox = 179;  // in the header: max x, min x, max y, min y, max z, min z
    const auto file = InputFile::open(path);
    std::array<std::byte, kBox + 48> header{};
    if (!file || !file->read_at(0, header) || std::memcmp(header.data(), "LASF", 4) != 0) return std::nullopt;
    std::array<glm::dvec3, 2> box{};
    for (int axis = 0; axis < 3; ++axis) {
        box[1][axis] = load<double>(&header[kBox + 16 * static_cast<size_t>(axis)]);
        box[0][axis] = load<double>(&header[kBox + 16 * static_cast<size_t>(axis) + 8]);
        if (!usable(box[0][axis]) || !usable(box[1][axis]) || box[0][axis] > box[1][axis]) return std::nullopt;
    }
    return box;
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
        const auto integer = [&](double at) { return clamped((at - header.offset[axis]) / header.scale[axis]); };
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
