#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Reads what is needed of a coordinate system in well-known text (OGC 01-009 "WKT 1" or ISO 19162 "WKT 2").
namespace lucarne::io {

/// The units of a coordinate system.
struct SystemUnits {
    std::optional<double> horizontal;  ///< metres per unit of a projected, local or geocentric system
    std::optional<double> vertical;    ///< metres per unit of heights, if these have a system of their own
    bool degrees = false;              ///< geographic: horizontal coordinates are angles
    bool known() const { return horizontal || degrees; }
};
/// Returns the units that the text states. Keywords may be in either case.
SystemUnits wkt_units(std::string_view wkt);

struct CoordinateSystem {
    std::string name;   ///< printable ASCII; empty if there is none
    uint32_t epsg = 0;  ///< EPSG code; 0 if there is none
};
/// Returns the name and code of the outermost system. If a compound system has no code, returns that of its
/// horizontal part.
CoordinateSystem wkt_system(std::string_view wkt);

/// Returns the text (WKT 1) of the UTM zones of WGS 84 (EPSG 32601 to 32660 and 32701 to 32760), ETRS89
/// (25828 to 25838) and NAD83 (26901 to 26923); the zone's number determines their parameters. Empty for
/// other codes.
std::optional<std::string> utm_wkt(uint32_t epsg);

}  // namespace lucarne::io
