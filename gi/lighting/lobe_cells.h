#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/direction_cells.h"

namespace lucarne::gi {

/// The cells of directions from which a lobe reflects light. Lobes are evaluated with an exponent of at most
/// kLargestExponent, about two cells wide: those with exponents over kExactExponent look as wide as that.
class LobeCells {
 public:
    static constexpr float kLargestExponent = kDirectionCells / 4.0f, kExactExponent = 28;

    LobeCells() {
        for (uint32_t cell = 0; cell < kDirectionCells; ++cell) directions_[cell] = direction_of_cell(cell);
    }
    const glm::vec3& direction(uint32_t cell) const { return directions_[cell]; }

    /// A lobe that reflects light in the direction `to`.
    class Lobe {
     public:
        Lobe(float exponent, const glm::vec3& normal, const glm::vec3& to)
            : exponent_(narrowed_by_cells(exponent)),
              normal_(normal),
              mirror_(2 * glm::dot(normal, to) * normal - to),
              least_(std::pow(kLeastLobe, 1 / exponent_)) {}
        /// Returns how much light from a direction counts, as a share of the lobe's peak; 0 from behind the
        /// surface. `from`: of any length.
        float at(const glm::vec3& from) const {
            const float along = glm::dot(mirror_, from);
            if (along <= 0 || glm::dot(normal_, from) <= 0) return 0;
            const float cosine2 = along * along / glm::dot(from, from);
            return cosine2 > least_ * least_ ? std::pow(cosine2, exponent_ / 2) : 0;
        }

     private:
        float exponent_;
        glm::vec3 normal_, mirror_;
        float least_;  ///< cosine to the mirror direction
    };

 private:
    /// Where a lobe has less than this of its peak it counts nothing.
    static constexpr float kLeastLobe = 1e-3f;

    /// Returns the exponent of a lobe that has the width of cos^n once the cells have widened it. Along each
    /// axis cos^n has the variance 1 / n, and a square of the solid angle w that of w / 12.
    static float narrowed_by_cells(float exponent) {
        constexpr float kVariance = 4 * kPi / kDirectionCells / 12;
        return 1 / std::max(1 / exponent - kVariance, 1 / kLargestExponent);
    }

    std::array<glm::vec3, kDirectionCells> directions_{};
};

}  // namespace lucarne::gi
