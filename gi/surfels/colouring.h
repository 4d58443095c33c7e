#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "gi/scene/look.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

/// Where the value that a look asks for lies in a record.
struct ValueColumn {
    io::ScalarType type = io::ScalarType::u8;
    uint32_t offset = 0;
    double at(const std::byte* record) const { return io::scalar_at(type, record + offset); }
};
/// None where the records have no such attribute, or where the look asks for none.
std::optional<ValueColumn> value_column(const io::Schema& schema, const Look& look);

/// sRGB of three channels, 0 to 1, as PackedSurfel.d holds it, without flags.
uint32_t pack_colour(const glm::dvec3& srgb);

/// Gives the points of one layout of records the colours that a look asks for, in the place of their own.
class Colouring {
 public:
    /// `first_scan`: what is added to the records' scan numbers.
    Colouring(const io::Schema& schema, const Look& look, uint32_t first_scan);
    /// As PackedSurfel.d holds it; empty: the point's own colour. `scan` and `normal` as the records have
    /// them.
    std::optional<uint32_t> colour(const std::byte* record, double z, uint32_t scan,
                                   const glm::vec3& normal) const;

 private:
    static constexpr size_t kShades = 1024;
    uint32_t shade(double value) const;

    ColourBy by_;
    std::optional<ValueColumn> column_;
    ValueRange range_;
    uint32_t first_scan_;
    std::array<uint32_t, kShades> shades_{};  ///< along the colour map, or of the numbers 0 to 255
};

/// What a look shows of a source, measured on its coarsest nodes, which are an even sample. The same on every
/// run.
struct ShownValues {
    /// The look's; or the 1st and the 99th percentile, of elevations in the source's unit. Empty where no
    /// point has the attribute, or where the look needs no range.
    std::optional<ValueRange> range;
    std::bitset<256> numbers;  ///< that classes, return numbers or scans have
    std::bitset<256> classes;  ///< that there are, whatever is shown
};
/// Nodes that cannot be read are left out.
ShownValues measured_values(const octree::NodeSource& source, const Look& look);

/// Errors (ErrorKind::arguments) where no part of the source has the attribute; the message lists what there
/// is.
Result<void> check_attribute(const octree::NodeSource& source, const Look& look);

}  // namespace lucarne::gi
