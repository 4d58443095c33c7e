#pragma once

#include "io/formats/crs/wkt.h"

// Units of coordinate systems from the EPSG registry, which PROJ (OSGeo, https://proj.org) keeps in its file
// proj.db. PROJ never uses the network here. Each call opens the registry, which takes milliseconds.
namespace lucarne::io {

/// Returns the units of a projected, geographic, geocentric, vertical or compound system by its EPSG code.
/// Empty if no system has this code, or if the registry is not installed.
std::optional<SystemUnits> registered_units(uint32_t epsg);

/// Returns the metres per unit of a unit of length by its EPSG code: 9003 is the US survey foot.
std::optional<double> registered_unit(uint32_t epsg);

/// Returns the units of a system by its well-known text. Empty if PROJ cannot read the text.
std::optional<SystemUnits> understood_units(std::string_view wkt);

}  // namespace lucarne::io
