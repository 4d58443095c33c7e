#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

namespace lucarne::gi {

/// The R2 sequence (Roberts 2018): multiples of it on the torus are even.
inline constexpr glm::dvec2 kR2{0.7548776662466927, 0.5698402909980532};

/// Evenly distributed points of a square for lights with an area: the R2 sequence, shifted on the torus.
///
/// A frame takes `count` points and continues where the last one ended. Any shift is unbiased in the mean of
/// many frames, but in the first frames a pair of points may lie close together or at one edge of the light.
/// So the shift is, of 64 that (seed, stream) draws, the one whose first one, two and four frames are the
/// most even.
class AreaPoints {
 public:
    AreaPoints(uint32_t count, uint64_t seed, uint64_t stream);
    /// Returns point `i` of all frames, in [0, 1)^2.
    glm::dvec2 at(uint64_t i) const;

 private:
    glm::dvec2 shift_;
};

/// Returns point `i` of a Fibonacci lattice of `count` points in [0, 1)^2, shifted on the torus. It is better
/// than the R2 sequence for few points whose number is known.
glm::dvec2 lattice_point(uint32_t i, uint32_t count, const glm::dvec2& shift);

/// Maps the square [-1, 1]^2 to the unit disc: areas keep their ratios, and the middle stays the middle, so
/// even points stay even (Shirley & Chiu 1997, "A low distortion map between disk and square").
glm::dvec2 on_disc(const glm::dvec2& square);

}  // namespace lucarne::gi
