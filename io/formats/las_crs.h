#pragma once

#include <optional>
#include <string_view>

#include "io/formats/las_header.h"

// The unit of length of a coordinate system: all we need of it to bring the light to metres.
namespace lucarne::io::las {

/// Metres per unit of a well-known text (OGC 01-009 "WKT 1" or ISO 19162 "WKT 2"): the unit of its projected,
/// local or geocentric system. Empty where it has none (geographic systems count in degrees).
std::optional<double> wkt_metres_per_unit(std::string_view wkt);

/// The same from GeoTIFF keys (OGC 19-008r4): ProjLinearUnitsGeoKey 3076, or 3077 for a user's own unit.
/// `directory` and `doubles` are the data of the records 34735 and 34736.
std::optional<double> geotiff_metres_per_unit(std::span<const std::byte> directory,
                                              std::span<const std::byte> doubles);

/// From whichever the header has; 1 where neither says. Warns when the coordinates are angles.
double metres_per_unit(const std::string& file, const Header& header);

}  // namespace lucarne::io::las
