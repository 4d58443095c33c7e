#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/host_frame.h"

namespace lucarne::gi {

/// The pixels of a picture that gather: one in each square of `step` x `step` pixels, at (x, y) of it.
struct GatherGrid {
    uint32_t width, height;  ///< of the picture, pixels
    uint32_t step;
    uint32_t x, y;

    uint32_t columns() const { return (width + step - 1) / step; }
    uint32_t rows() const { return (height + step - 1) / step; }
    /// Returns the pixel of a place of the grid, inside the picture.
    uint32_t pixel(uint32_t column, uint32_t row) const;
    /// Returns those of all places, by row and column.
    std::vector<uint32_t> pixels() const;
};

/// Of the weights with which places count for a pixel: the least sum with which they do, and what is added to
/// the share of each, so that one that is far away counts where no other does.
inline constexpr float kLeastUpsampleWeight = 0.05f, kLeastUpsampleShare = 1e-3f;

/// Interpolates light between the pixels that gathered it (joint bilateral upsampling: Sloan et al. 2007;
/// Ritschel et al. 2009, section 2.4): of the four places about a pixel, those count that lie in its plane
/// and have its normal. Sets `light` of all pixels from `gathered` (by row and column of the grid). Returns
/// the pixels for which none counts; they have to gather themselves.
std::vector<uint32_t> upsample(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                               const GatherGrid& grid, std::span<const glm::vec4> gathered,
                               std::span<glm::vec4> light);

}  // namespace lucarne::gi
