#include "io/formats/far_apart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::io {
namespace {

constexpr double kFar = 100;  ///< in diagonals of the larger group

using Box = std::array<glm::dvec3, 2>;

bool is_box(const Box& box) {
    const glm::dvec3 extent = box[1] - box[0];
    return std::isfinite(extent.x + extent.y + extent.z) && extent.x >= 0 && extent.y >= 0 && extent.z >= 0;
}

Box joined(const Box& a, const Box& b) {
    return {glm::min(a[0], b[0]), glm::max(a[1], b[1])};
}

double diagonal(const Box& box) {
    return glm::distance(box[0], box[1]);
}

}  // namespace

std::string far_apart(std::span<const PlacedScan> scans) {
    std::vector<const PlacedScan*> placed;
    for (const PlacedScan& scan : scans)
        if (is_box(scan.box)) placed.push_back(&scan);
    for (int axis = 0; axis < 3 && placed.size() > 1; ++axis) {
        std::ranges::sort(placed, {}, [&](const PlacedScan* scan) { return scan->box[0][axis]; });
        std::vector<Box> above(placed.size());  // all boxes from this one on
        above.back() = placed.back()->box;
        for (size_t i = placed.size() - 1; i-- > 0;) above[i] = joined(placed[i]->box, above[i + 1]);
        Box below = placed.front()->box;
        for (size_t i = 1; i < placed.size(); below = joined(below, placed[i++]->box)) {
            const double gap = above[i][0][axis] - below[1][axis];
            const double size = std::max(diagonal(below), diagonal(above[i]));
            if (gap > 0 && gap > kFar * size)
                return fmt::format(
                    "{} and {} lie {:.0f} times as far apart as they are large: one of them may have local "
                    "coordinates; open them one by one",
                    placed[i - 1]->name, placed[i]->name,
                    gap / std::max(size, std::numeric_limits<double>::min()));
        }
    }
    return {};
}

std::string far_apart(std::span<const ScanInfo> scans) {
    std::vector<PlacedScan> placed;
    for (const ScanInfo& scan : scans)
        if (scan.stated_box) placed.push_back({scan.path, *scan.stated_box});
    return far_apart(placed);
}

}  // namespace lucarne::io
