#pragma once

#include <optional>
#include <string_view>

#include "io/formats/crs/wkt.h"
#include "io/formats/las/header.h"

// The coordinate system: its unit of length, to bring the light to metres, and what it is called.
namespace lucarne::io::las {

struct Units : SystemUnits {
    std::string
        unknown;  ///< why the unit of the horizontal coordinates is not known, where there is a system
    double metres() const { return horizontal.value_or(1.0); }
};

/// From well-known text or GeoTIFF keys (OGC 19-008r4), whichever counts: ProjLinearUnitsGeoKey 3076, or 3077
/// for a user's own unit, else the unit that the EPSG registry has for ProjectedCRSGeoKey 3072; heights by
/// 4099 or 4096.
Units units_of(const Header& header);

/// Warns of degrees, of a unit that is not known (unless the user has given it), and of heights in another
/// unit than the horizontal coordinates.
void warn_of_units(const std::string& file, const Units& units, bool given);

/// What a system is called that says a unit of length and nothing else: of files that have none, but are no
/// metres.
inline constexpr const char* kLocalSystem = "local";

/// Its name and code from whichever the header has. GeoTIFF keys: 3072 ProjectedCRS or 2048 GeodeticCRS, and
/// their citations 3073, 1026, 2049.
CoordinateSystem coordinate_system(const Header& header);

/// The records of the coordinate system in the notes of a scan: a LAS file's own, those of merged_info, or
/// the well-known text of an E57. Empty where they have none.
std::vector<Vlr> projection_records(const FormatNotes& notes);

/// Gives the header these records instead of its own.
void set_projection(Header& header, std::vector<Vlr> records);

/// A record of well-known text.
Vlr wkt_record(const std::string& wkt);

/// Point formats 6 and up want well-known text, and that their header says so; where there are GeoTIFF keys
/// only, the text is added for the systems that are known by heart (UTM of WGS 84, ETRS89 and NAD83, in
/// metres). Else the keys stay alone, with a warning.
void prefer_wkt(const std::string& file, Header& header);

}  // namespace lucarne::io::las
