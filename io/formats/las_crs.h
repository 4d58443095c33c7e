#pragma once

#include <optional>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "io/formats/las_header.h"
#include "io/formats/wkt.h"

// The coordinate system: its unit of length, to bring the light to metres, and what it is called.
namespace lucarne::io::las {

/// Metres per unit from GeoTIFF keys (OGC 19-008r4): ProjLinearUnitsGeoKey 3076, or 3077 for a user's own unit.
/// `directory` and `doubles` are the data of the records 34735 and 34736.
std::optional<double> geotiff_metres_per_unit(std::span<const std::byte> directory,
                                              std::span<const std::byte> doubles);

/// Metres per unit from whichever the header has; none where neither says. Warns when the coordinates are angles.
std::optional<double> stated_unit(const std::string& file, const Header& header);

/// What a system is called that says a unit of length and nothing else: of files that have none, but are no metres.
inline constexpr const char* kLocalSystem = "local";

/// Its name and code from whichever the header has. GeoTIFF keys: 3072 ProjectedCRS or 2048 GeodeticCRS, and
/// their citations 3073, 1026, 2049.
CoordinateSystem coordinate_system(const Header& header);

/// The records of the coordinate system that a scan's details have: a LAS file's own, those of merged_info, or the
/// well-known text of an E57. Empty where they have none.
std::vector<Vlr> projection_records(const nlohmann::json& details);

/// Gives the header these records instead of its own.
void set_projection(Header& header, std::vector<Vlr> records);

/// A record of well-known text.
Vlr wkt_record(const std::string& wkt);

/// Point formats 6 and up want well-known text, and that their header says so; where there are GeoTIFF keys only, the
/// text is added for the systems that are known by heart (UTM of WGS 84, ETRS89 and NAD83, in metres). Else the keys
/// stay alone, with a warning.
void prefer_wkt(const std::string& file, Header& header);

}  // namespace lucarne::io::las
