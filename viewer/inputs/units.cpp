#include "viewer/inputs/units.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/formats/common/text.h"
#include "io/formats/common/units.h"

namespace lucarne::viewer {

namespace {

constexpr std::array<std::pair<double, std::string_view>, 7> kUnits = {{{1, "m"},
                                                                        {io::kFoot, "ft"},
                                                                        {io::kSurveyFoot, "US ft"},
                                                                        {0.01, "cm"},
                                                                        {0.001, "mm"},
                                                                        {1000, "km"},
                                                                        {0.0254, "in"}}};

}  // namespace

std::optional<double> metres_of(const std::string& unit) {
    const auto metres = io::parse_number<double>(unit);
    if (!metres) return io::metres_of_name(unit);
    return *metres > 1e-9 && *metres < 1e9 ? metres : std::nullopt;
}

std::string unit_name(double metres_per_unit) {
    for (const auto& [metres, name] : kUnits)
        if (std::abs(metres_per_unit / metres - 1) < 1e-7) return std::string(name);
    return fmt::format("units of {} m", metres_per_unit);
}

double UnitChoice::convert(double value, Dimension dimension) const {
    if (dimension == Dimension::angle) return value * 180 / std::numbers::pi;
    if (!metres) return value;
    return dimension == Dimension::length ? value * metres_per_unit
                                          : value * metres_per_unit * metres_per_unit;
}

std::string UnitChoice::name(Dimension dimension) const {
    if (dimension == Dimension::angle) return "degrees";
    const std::string length = metres ? "m" : unit_name(metres_per_unit);
    return dimension == Dimension::length ? length : length + "2";
}

std::string UnitChoice::text(double value, Dimension dimension) const {
    return fmt::format("{:.{}f} {}", convert(value, dimension), dimension == Dimension::angle ? 3 : 4,
                       name(dimension));
}

}  // namespace lucarne::viewer
