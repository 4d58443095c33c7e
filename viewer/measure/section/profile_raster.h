#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "viewer/measure/section/section.h"

namespace lucarne::viewer {

/// A section as dots on a grid, whatever its number of points. Both axes have the same scale, and the whole
/// section is centred.
struct ProfileRaster {
    struct Dot {
        uint16_t x = 0, y = 0;  ///< row 0 on top
        std::array<uint8_t, 3> color{};
    };
    std::vector<Dot> dots;        ///< at most one for each cell
    double scale = 1;             ///< cells per world unit
    double left = 0, bottom = 0;  ///< world coordinates (along, height) of the grid's lower left corner
};

/// Draws a section on a grid. `columns` and `rows` are at most 4096.
ProfileRaster rasterize(const Section& section, uint32_t columns, uint32_t rows);

}  // namespace lucarne::viewer
