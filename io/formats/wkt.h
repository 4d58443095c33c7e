#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// What is needed of a coordinate system in well-known text (OGC 01-009 "WKT 1" or ISO 19162 "WKT 2").
namespace lucarne::io {

/// Metres per unit: the unit of its projected, local or geocentric system. Empty where it has none
/// (geographic systems count in degrees).
std::optional<double> wkt_metres_per_unit(std::string_view wkt);

struct CoordinateSystem {
    std::string name;   ///< printable ASCII; empty where there is none
    uint32_t epsg = 0;  ///< its code in the EPSG registry; 0 where there is none
};
/// The name of the outermost system, and its code or, where a compound system has none, that of its horizontal
/// part.
CoordinateSystem wkt_system(std::string_view wkt);

/// The text (WKT 1) of the UTM zones of WGS 84 (EPSG 32601 to 32660 and 32701 to 32760), ETRS89 (25828 to 25838) and
/// NAD83 (26901 to 26923), whose parameters follow from their number. Empty for other codes.
std::optional<std::string> utm_wkt(uint32_t epsg);

}  // namespace lucarne::io
