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
    /// Calls visit(cell, weight) for the cells in front of a surface whose light its lobe reflects in the
    /// direction `to`, with the lobe's share of its peak.
    template <class Visit>
    void each(float exponent, const glm::vec3& normal, const glm::vec3& to, const Visit& visit) const {
        const glm::vec3 mirror = 2 * glm::dot(normal, to) * normal - to;
        const float narrowed = narrowed_by_cells(exponent);
        for (uint32_t cell = 0; cell < kDirectionCells; ++cell) {
            const float along = glm::dot(mirror, directions_[cell]);
            if (along <= 0 || glm::dot(normal, directions_[cell]) <= 0) continue;
            const float lobe = std::pow(along, narrowed);
            if (lobe >= kLeastLobe) visit(cell, lobe);
        }
    }

 private:
    /// Cells in which a lobe has less than this of its peak are left out.
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
