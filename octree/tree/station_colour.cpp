#include "octree/tree/station_colour.h"

#include <algorithm>

namespace lucarne::octree {

const StationColour* find_colour(const std::vector<StationColour>& colours, const StationKey& key) {
    const auto before = [](const StationColour& colour, uint32_t scan) { return colour.scan < scan; };
    auto colour = std::lower_bound(colours.begin(), colours.end(), key.scan, before);
    for (; colour != colours.end() && colour->scan == key.scan; ++colour)
        if (!colour->station || *colour->station == key.station) return &*colour;
    return nullptr;
}

}  // namespace lucarne::octree
