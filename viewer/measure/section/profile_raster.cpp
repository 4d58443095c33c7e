#include "viewer/measure/section/profile_raster.h"

#include <algorithm>
#include <cmath>

namespace lucarne::viewer {

ProfileRaster rasterize(const Section& section, uint32_t columns, uint32_t rows) {
    columns = std::clamp(columns, 1u, 4096u);
    rows = std::clamp(rows, 1u, 4096u);
    const Slice& slice = section.slice;
    const double length = std::hypot(slice.to.x - slice.from.x, slice.to.y - slice.from.y);
    const double height = section.highest - section.lowest;
    ProfileRaster raster;
    raster.scale = std::min(columns / std::max(length, 1e-9), rows / std::max(height, 1e-9)) * 0.98;
    raster.left = length / 2 - columns / raster.scale / 2;
    raster.bottom = section.lowest + height / 2 - rows / raster.scale / 2;
    std::vector<bool> taken(size_t{columns} * rows);
    for (const SectionPoint& p : section.points) {
        const double x = (p.along - raster.left) * raster.scale,
                     y = rows - (p.height - raster.bottom) * raster.scale;
        if (!(x >= 0 && x < columns && y >= 0 && y < rows)) continue;
        const auto column = static_cast<uint16_t>(x), line = static_cast<uint16_t>(y);
        const size_t cell = size_t{line} * columns + column;
        if (taken[cell]) continue;
        taken[cell] = true;
        raster.dots.push_back({column, line, p.color});
    }
    return raster;
}

}  // namespace lucarne::viewer
