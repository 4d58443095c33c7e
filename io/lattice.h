#pragma once

#include <array>
#include <optional>
#include <span>

#include "io/points.h"

// Where positions of 32-bit integers stand, and which such places hold given coordinates to their last digit.
namespace lucarne::io {

/// Axis by axis: integer * scale + offset.
struct Lattice {
    glm::dvec3 scale{1.0}, offset{0.0};
    bool operator==(const Lattice&) const = default;
};
using PositionBox = std::array<glm::dvec3, 2>;  ///< lowest and highest corner

/// One that has every place of all of them, with offsets that bring the box into 32 bits: the finest scale
/// has to divide the others and the distances of the offsets. Empty where there is none.
std::optional<Lattice> common_lattice(std::span<const Lattice> lattices, const PositionBox& box);

/// Finds out how many decimals positions have that are floats or doubles now, and were decimal fractions
/// once.
class DecimalSearch {
 public:
    /// Positions that `schema` stores, all in `box`.
    DecimalSearch(const Schema& schema, const PositionBox& box);

    /// False once more positions would change nothing.
    bool add(std::span<const std::byte> records);
    /// Of the fewest decimals that all have, millimetres at least where the box is not too large for them. An
    /// axis that no decimals hold, or none that were added, has the finest that its box allows.
    Lattice found() const;

 private:
    struct Axis {
        double low = 0, high = 0;
        double tolerance = 0;      ///< what computing integer * scale + offset may differ by
        int most = 0, digits = 0;  ///< that its box allows, and that are needed so far
        double factor = 1;         ///< 10^digits
        bool exact = true;
    };
    static Axis axis_of(double low, double high);

    Schema schema_;
    std::array<Axis, 3> axes_;
    bool any_ = false;
};

}  // namespace lucarne::io
