#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/core/error.h"
#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// Returns a CSV table of points and results (RFC 4180) with the columns measurement, kind, what, value,
/// unit, x, y, z, attributes. Each point has a row with its coordinates as in its file. Each quantity has a
/// row with its value in the chosen unit. Lines end with LF.
std::string measurements_csv(std::span<const Measurement> all, const UnitChoice& units);
/// Returns a readable text with one paragraph for each measurement.
std::string measurements_text(std::span<const Measurement> all, const UnitChoice& units);

/// Returns the JSON that data/README.md describes. Coordinates keep full precision. Results are written for
/// other programs, in the file's unit and degrees.
std::string measurements_json(std::span<const Measurement> all, double metres_per_unit);
/// Reads measurements. Results are not read, because they follow from the points. Errors
/// (ErrorKind::input_rejected) name the place in the file. If `metres_per_unit` is known, another unit is an
/// error.
Result<std::vector<Measurement>> parse_measurements(std::string_view text, const std::string& name,
                                                    std::optional<double> metres_per_unit);
Result<std::vector<Measurement>> load_measurements(const std::filesystem::path& path,
                                                   std::optional<double> metres_per_unit);

/// Saves measurements as .csv or .json, by the extension. Errors: another extension (arguments); the file
/// cannot be written.
Result<void> save_measurements(const std::filesystem::path& path, std::span<const Measurement> all,
                               const UnitChoice& units, bool overwrite);

/// Returns a field of a CSV row, quoted if necessary.
std::string csv_field(std::string_view text);

}  // namespace lucarne::viewer
