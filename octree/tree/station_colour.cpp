#include "octree/tree/station_colour.h"

#include <algorithm>

namespace lucarne::octree {

const StationColour* find_colour(const std::vector<StationColour>& colours, const StationKey& key) {
    const auto of_scan = std::ranges::equal_range(colours, key.scan, {}, &StationColour::scan);
    for (const StationColour& colour : of_scan)
        if (!colour.station || *colour.station == key.station) return &colour;
    return nullptr;
}

}  // namespace lucarne::octree
