#pragma once

#include <optional>
#include <string>

namespace lucarne::viewer {

enum class Dimension { length, area, angle };

/// The unit in which measurements are shown and written: metres, or the scan file's own unit.
struct UnitChoice {
    bool metres = true;
    double metres_per_unit = 1;  ///< metres per unit of the file

    /// Converts `value`, in the file's unit, its square or radians, to the chosen unit, its square or
    /// degrees.
    double convert(double value, Dimension dimension) const;
    std::string name(Dimension dimension) const;  ///< "m", "m2", "degrees"
    /// Returns a text such as "12.3457 m".
    std::string text(double value, Dimension dimension) const;
};

/// Returns the name of a file's unit: "m", "ft", "US ft", or "units of 0.5 m" if it has no name.
std::string unit_name(double metres_per_unit);
/// Returns the length of a unit in metres. `unit` is a name ("ft", "us-ft" for "US ft") or a number of
/// metres. Returns nothing if it is neither.
std::optional<double> metres_of(const std::string& unit);

}  // namespace lucarne::viewer
