#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/core/error.h"
#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// A table of points and results, RFC 4180: measurement, kind, what, value, unit, x, y, z, attributes. A row
/// a point, with its coordinates as its file has them, and a row a quantity, in the chosen unit. Lines end
/// with LF.
std::string measurements_csv(std::span<const Measurement> all, const UnitChoice& units);
/// For people: a paragraph a measurement.
std::string measurements_text(std::span<const Measurement> all, const UnitChoice& units);

/// As data/README.md describes them; coordinates lose nothing. Results are written for other readers, in the
/// file's unit and degrees.
std::string measurements_json(std::span<const Measurement> all, double metres_per_unit);
/// Results are not read: they follow from the points. Errors (ErrorKind::input_rejected) name the place;
/// another unit than `metres_per_unit`, where that is known, is one.
Result<std::vector<Measurement>> parse_measurements(std::string_view text, const std::string& name,
                                                    std::optional<double> metres_per_unit);
Result<std::vector<Measurement>> load_measurements(const std::filesystem::path& path,
                                                   std::optional<double> metres_per_unit);

/// By the extension: .csv or .json. Errors: another extension (arguments), the file cannot be written.
Result<void> save_measurements(const std::filesystem::path& path, std::span<const Measurement> all,
                               const UnitChoice& units, bool overwrite);

/// A field of a CSV row: quoted where it must be.
std::string csv_field(std::string_view text);

}  // namespace lucarne::viewer
