#pragma once

#include <cstddef>
#include <vector>

namespace lucarne::gi::vpl::native {

constexpr int kBorder = 16;  ///< columns and rows around a band: windows reach 4 pixels, vectors up to 16

/// The surfaces of some rows: planes of positions relative to the camera's origin, normals and depths. Depths
/// are 0 outside the picture.
struct Surfaces {
    size_t stride;
    std::vector<float> x, y, z, nx, ny, nz, depth, radius;
    Surfaces(size_t width, size_t rows) : stride(width + 2 * kBorder) {
        for (std::vector<float>* plane : {&x, &y, &z, &nx, &ny, &nz, &depth, &radius})
            plane->resize(stride * rows, 0.0f);
    }
};

}  // namespace lucarne::gi::vpl::native
