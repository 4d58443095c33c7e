#include "octree/tree/area_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lucarne::octree {
namespace {

/// Returns the least c >= 0 with sum(max(a_i, c)) = surface. Reorders `areas`. Bisects over the values
/// themselves: areas above c stay as they are, those below become c.
double floor_of(std::span<float> areas, double surface) {
    // If the areas add up to the surface except for rounding, the floor is 0, not the least area.
    constexpr double kRounding = 1e-9;
    if (std::accumulate(areas.begin(), areas.end(), 0.0) >= surface * (1 - kRounding)) return 0.0;
    size_t below = 0;    // how many are known to be below c
    double above = 0.0;  // sum of those known to be at least c
    while (!areas.empty()) {
        const size_t middle = areas.size() / 2;
        std::nth_element(areas.begin(), areas.begin() + static_cast<ptrdiff_t>(middle), areas.end());
        const auto upper = areas.subspan(middle);
        const double pivot = upper.front();
        const double upper_sum = std::accumulate(upper.begin(), upper.end(), 0.0);
        if (above + upper_sum + pivot * static_cast<double>(below + middle) >= surface) {
            above += upper_sum;
            areas = areas.first(middle);
        } else {
            below += middle + 1;
            areas = upper.subspan(1);
        }
    }
    return below > 0 ? std::max(0.0, (surface - above) / static_cast<double>(below)) : 0.0;
}

}  // namespace

std::array<float, kPrefixSteps> area_floors(std::span<const float> inherited_areas,
                                            std::span<const float> own_areas_in_prefix_order,
                                            double surface) {
    std::array<float, kPrefixSteps> floors{};
    if (!(surface > 0) || !std::isfinite(surface)) return floors;
    const size_t own = own_areas_in_prefix_order.size();
    const auto is_known = [](float a) { return a > 0 && std::isfinite(a); };
    if (std::none_of(inherited_areas.begin(), inherited_areas.end(), is_known) &&
        std::none_of(own_areas_in_prefix_order.begin(), own_areas_in_prefix_order.end(), is_known)) {
        // All have the same share, as where the cache has no areas: nothing to bisect.
        for (size_t step = 0; step < kPrefixSteps; ++step) {
            const size_t shown = inherited_areas.size() + std::min(own, std::max<size_t>(1, own >> step));
            if (shown > 0) floors[step] = static_cast<float>(surface / static_cast<double>(shown));
        }
        return floors;
    }
    std::vector<float> areas;
    areas.reserve(inherited_areas.size() + own);
    const auto add = [&](std::span<const float> values) {
        for (const float a : values) areas.push_back(is_known(a) ? a : 0.0f);
    };
    float previous = 0.0f;
    for (size_t step = 0; step < kPrefixSteps; ++step) {
        areas.clear();
        add(inherited_areas);
        add(own_areas_in_prefix_order.first(std::min(own, std::max<size_t>(1, own >> step))));
        previous = std::max(previous, static_cast<float>(floor_of(areas, surface)));
        floors[step] = previous;
    }
    return floors;
}

float stored_area(double area) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return area > 0 ? static_cast<float>(std::min(area, kMost)) : 0.0f;
}

std::array<float, kPrefixSteps> stored_floors(const std::array<float, kPrefixSteps>& floors, double edge) {
    std::array<float, kPrefixSteps> stored{};
    for (size_t step = 0; step < kPrefixSteps; ++step) stored[step] = stored_area(floors[step] * edge * edge);
    return stored;
}

}  // namespace lucarne::octree
