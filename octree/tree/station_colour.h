#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "io/points.h"
#include "octree/tree/scan_number.h"

namespace lucarne::octree {

/// A gain is at most this, and at least 1 / this.
inline constexpr double kMostGain = 16;

/// What a cache knows about the colours of one station's points. Drawing uses it; the points keep their
/// colours.
struct StationColour {
    uint32_t scan = 0;                ///< index in SourceHeader::scans
    std::optional<uint32_t> station;  ///< point_source_id of the points; empty: all points of the scan
    glm::dvec3 gain{1.0};             ///< factors of the linear colour that make the stations agree
    /// Set if points with the colour 0,0,0 were never photographed: the mean linear colour of the others.
    std::optional<glm::dvec3> unphotographed;

    bool operator==(const StationColour&) const = default;
};

/// The station that recorded a point.
struct StationKey {
    uint32_t scan = 0, station = 0;
    auto operator<=>(const StationKey&) const = default;
};

/// Tells the station of records: their input, and their point_source_id (0 if they have none).
class StationKeys {
 public:
    /// `schema` outlives this object.
    explicit StationKeys(const io::Schema& schema) : scan_(schema) {
        const auto* source = schema.find(io::names::point_source_id);
        if (source && source->type == io::ScalarType::u16 && source->components == 1) source_ = source;
    }
    bool has_stations() const { return source_; }
    StationKey of(const std::byte* record) const {
        return {scan_.of(record), source_ ? io::load<uint16_t>(record + source_->offset) : 0u};
    }

 private:
    ScanNumber scan_;
    const io::Attribute* source_ = nullptr;
};

/// Returns the entry that applies to the points of a station, null if there is none. `colours` is sorted by
/// scan and station, as caches have it.
const StationColour* find_colour(const std::vector<StationColour>& colours, const StationKey& key);

}  // namespace lucarne::octree
