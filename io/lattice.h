#pragma once

#include <array>
#include <optional>
#include <span>

#include "io/points.h"

// Lattices of 32-bit integers on which positions lie, and the search for a lattice that holds given
// coordinates to their last digit.
namespace lucarne::io {

/// A position on a lattice is, axis by axis, integer * scale + offset.
struct Lattice {
    glm::dvec3 scale{1.0}, offset{0.0};
    bool operator==(const Lattice&) const = default;
};
using PositionBox = std::array<glm::dvec3, 2>;  ///< lowest and highest corner

/// Returns a lattice that contains all positions of all given lattices, with offsets that bring the box into
/// 32 bits. The finest scale must divide the other scales and the differences of the offsets. Empty where
/// there is no such lattice.
std::optional<Lattice> common_lattice(std::span<const Lattice> lattices, const PositionBox& box);

/// Finds out how many decimals positions have that are now floats or doubles but were decimal fractions once.
class DecimalSearch {
 public:
    /// The positions are those of records of `schema`; all must lie in `box`.
    DecimalSearch(const Schema& schema, const PositionBox& box);

    /// Looks at more records. Returns false once further records would change nothing.
    bool add(std::span<const std::byte> records);
    /// Returns a lattice with the fewest decimals that hold all positions, but at least millimetres if the
    /// box is not too large for them. An axis whose positions no number of decimals holds gets the finest
    /// scale that its box allows; so do all axes if no record was added.
    Lattice found() const;

 private:
    struct Axis {
        double low = 0, high = 0;
        double tolerance = 0;      ///< rounding error to allow for in integer * scale + offset
        int most = 0, digits = 0;  ///< decimals: the most that the box allows, those needed so far
        double factor = 1;         ///< 10^digits
        bool exact = true;
    };
    static Axis axis_of(double low, double high);

    Schema schema_;
    std::array<Axis, 3> axes_;
    bool any_ = false;
};

}  // namespace lucarne::io
