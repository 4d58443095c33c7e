#pragma once

#include <optional>
#include <string_view>

#include "io/formats/crs/wkt.h"
#include "io/formats/las/header.h"

// The coordinate system: its name, and its unit of length, which converts lengths to metres for the lighting.
namespace lucarne::io::las {

struct Units : SystemUnits {
    std::string unknown;  ///< why the unit of the horizontal coordinates is unknown, if there is a system
    double metres() const { return horizontal.value_or(1.0); }
};

/// Returns the units from well-known text or from GeoTIFF keys (OGC 19-008r4), whichever is in effect. The
/// key for horizontal lengths is ProjLinearUnitsGeoKey 3076, or 3077 for a user-defined unit; otherwise the
/// EPSG registry gives the unit of ProjectedCRSGeoKey 3072. The keys for heights are 4099 and 4096.
Units units_of(const Header& header);

/// Warns about an unknown unit (unless the user has `given` one), and about heights in another unit than the
/// horizontal coordinates.
void warn_of_units(const std::string& file, const Units& units, bool given);

/// The name of a system that states only a unit of length. It is written for files that have no coordinate
/// system and are not in metres.
inline constexpr const char* kLocalSystem = "local";

/// Returns the name and code of the coordinate system from whichever of the two the header has. GeoTIFF keys:
/// 3072 ProjectedCRS or 2048 GeodeticCRS, and their citations 3073, 1026, 2049.
CoordinateSystem coordinate_system(const Header& header);

/// Returns the records of the coordinate system in the notes of a scan: a LAS file's own, those of
/// merged_info, or the well-known text of an E57. Empty if the notes have none.
std::vector<Vlr> projection_records(const FormatNotes& notes);

/// Replaces the header's records of the coordinate system.
void set_projection(Header& header, std::vector<Vlr> records);

/// Returns a record with well-known text.
Vlr wkt_record(const std::string& wkt);

/// Prepares the header for point formats 6 and up, which require well-known text and a header that says so.
/// If there are only GeoTIFF keys, adds the text for systems whose text is built in (UTM of WGS 84, ETRS89
/// and NAD83, in metres). Keeps the keys of other systems alone, with a warning.
void prefer_wkt(const std::string& file, Header& header);

}  // namespace lucarne::io::las
