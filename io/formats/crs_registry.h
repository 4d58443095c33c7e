#pragma once

#include "io/formats/wkt.h"

// What PROJ (OSGeo, https://proj.org) knows of coordinate systems: the EPSG registry in its file proj.db, and how
// well-known text is read. It never asks the network. Each call opens the registry, which takes milliseconds.
namespace lucarne::io {

/// Of a projected, geographic, geocentric, vertical or compound system of the EPSG registry. Empty where no system has
/// this code, or this machine has no registry.
std::optional<SystemUnits> registered_units(uint32_t epsg);

/// Metres per unit of length: EPSG:9003 is the US survey foot.
std::optional<double> registered_unit(uint32_t epsg);

/// Of text that PROJ understands, whatever it leaves to be looked up.
std::optional<SystemUnits> understood_units(std::string_view wkt);

}  // namespace lucarne::io
