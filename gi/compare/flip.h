#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

namespace lucarne::gi {

/// Pixels per degree of visual angle: a 4K screen .7 m wide seen from .7 m (the paper's
/// default).
inline constexpr double kFlipPixelsPerDegree = 67.0206;

/// Returns the FLIP error of every pixel, 0 (no visible difference) to 1, between two tone-mapped pictures
/// of width x height pixels: linear Rec. 709 light, clamped to [0, 1], as it is shown on an sRGB screen.
/// Symmetric. Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Aastroem, Fairchild 2020, "FLIP: a
/// difference evaluator for alternating images".
std::vector<float> flip_errors(std::span<const glm::vec4> a, std::span<const glm::vec4> b, uint32_t width,
                               double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace lucarne::gi
