#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "gi/scene/look.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

/// Where a record holds the value that a look shows.
struct ValueColumn {
    io::ScalarType type = io::ScalarType::u8;
    uint32_t offset = 0;
    double at(const std::byte* record) const { return io::scalar_at(type, record + offset); }
};
/// Returns none if the records have no such attribute or the look needs none.
std::optional<ValueColumn> value_column(const io::Schema& schema, const Look& look);

/// Packs an sRGB colour of three channels, 0 to 1, as PackedSurfel.d holds it, without flags.
uint32_t pack_colour(const glm::dvec3& srgb);

/// Replaces the colours of points of one record layout by those that a look asks for.
class Colouring {
 public:
    /// `first_scan` is added to the scan numbers of the records.
    Colouring(const io::Schema& schema, const Look& look, uint32_t first_scan);
    /// Returns the colour as PackedSurfel.d holds it; empty: use the point's own colour. `scan` and `normal`
    /// are those of the record.
    std::optional<uint32_t> colour(const std::byte* record, double z, uint32_t scan,
                                   const glm::vec3& normal) const;

 private:
    static constexpr size_t kShades = 1024;
    uint32_t shade(double value) const;

    ColourBy by_;
    std::optional<ValueColumn> column_;
    ValueRange range_;
    uint32_t first_scan_;
    std::array<uint32_t, kShades> shades_{};  ///< colours along the colour map, or of the numbers 0 to 255
};

/// The values that a look shows of a source, measured on its coarsest nodes, which are an even sample. The
/// result is the same on every run.
struct ShownValues {
    /// The range of the look, or else the 1st and 99th percentiles; elevations in the source's unit. Empty
    /// if no point has the attribute or the look needs no range.
    std::optional<ValueRange> range;
    std::bitset<256> numbers;  ///< the classes, return numbers or scans that occur
    std::bitset<256> classes;  ///< the classes that occur, whatever the look shows
};
/// Measures these values. Skips nodes that cannot be read.
ShownValues measured_values(const octree::NodeSource& source, const Look& look);

/// Errors (ErrorKind::arguments): no part of the source has the attribute; the message lists the attributes
/// that exist.
Result<void> check_attribute(const octree::NodeSource& source, const Look& look);

}  // namespace lucarne::gi
