#pragma once

#include <optional>
#include <string>

namespace lucarne::viewer {

enum class Dimension { length, area, angle };

/// In which units measurements are shown and written: metres, or the scan file's own.
struct UnitChoice {
    bool metres = true;
    double metres_per_unit = 1;  ///< of the file

    /// `value` is in the file's unit, its square, or radians; the result in the chosen one, or degrees.
    double convert(double value, Dimension dimension) const;
    std::string name(Dimension dimension) const;  ///< "m", "m2", "degrees"
    /// For people: "12.3457 m".
    std::string text(double value, Dimension dimension) const;
};

/// Of a file's unit: "m", "ft", "US ft"; "units of 0.5 m" where it has no name.
std::string unit_name(double metres_per_unit);
/// The metres of a unit by its name ("ft", "us-ft" for "US ft"), or as a number of metres; none where it is
/// neither.
std::optional<double> metres_of(const std::string& unit);

}  // namespace lucarne::viewer
