#pragma once

#include <optional>
#include <string_view>

#include "io/formats/las_header.h"
#include "io/formats/wkt.h"

// The coordinate system: its unit of length, to bring the light to metres, and what it is called.
namespace lucarne::io::las {

/// Metres per unit from GeoTIFF keys (OGC 19-008r4): ProjLinearUnitsGeoKey 3076, or 3077 for a user's own unit.
/// `directory` and `doubles` are the data of the records 34735 and 34736.
std::optional<double> geotiff_metres_per_unit(std::span<const std::byte> directory,
                                              std::span<const std::byte> doubles);

/// From whichever the header has; 1 where neither says. Warns when the coordinates are angles.
double metres_per_unit(const std::string& file, const Header& header);

/// Its name and code from whichever the header has. GeoTIFF keys: 3072 ProjectedCRS or 2048 GeodeticCRS, and
/// their citations 3073, 1026, 2049.
CoordinateSystem coordinate_system(const Header& header);

}  // namespace lucarne::io::las
