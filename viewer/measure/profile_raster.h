#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "viewer/measure/section.h"

namespace lucarne::viewer {

/// A section as dots on a grid, however many points it has: equal scales along and up, the whole of it in the
/// middle.
struct ProfileRaster {
    struct Dot {
        uint16_t x = 0, y = 0;  ///< row 0 on top
        std::array<uint8_t, 3> color{};
    };
    std::vector<Dot> dots;        ///< at most one a cell
    double scale = 1;             ///< cells a world unit
    double left = 0, bottom = 0;  ///< world: along and height at the lower left corner of the grid
};

/// Columns and rows up to 4096.
ProfileRaster rasterize(const Section& section, uint32_t columns, uint32_t rows);

}  // namespace lucarne::viewer
