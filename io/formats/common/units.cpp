#include "io/formats/common/units.h"

#include <array>
#include <string>

#include "io/formats/common/text.h"

namespace lucarne::io {
namespace {

struct Unit {
    std::string_view name;
    double metres;
};
constexpr std::array kUnits = std::to_array<Unit>({
    {"m", 1},
    {"metre", 1},
    {"metres", 1},
    {"meter", 1},
    {"meters", 1},
    {"mm", 0.001},
    {"millimetres", 0.001},
    {"millimeters", 0.001},
    {"cm", 0.01},
    {"centimetres", 0.01},
    {"centimeters", 0.01},
    {"km", 1000},
    {"ft", kFoot},
    {"foot", kFoot},
    {"feet", kFoot},
    {"intft", kFoot},
    {"usft", kSurveyFoot},
    {"ftus", kSurveyFoot},
    {"usfoot", kSurveyFoot},
    {"usfeet", kSurveyFoot},
    {"ussurveyft", kSurveyFoot},
    {"ussurveyfoot", kSurveyFoot},
    {"ussurveyfeet", kSurveyFoot},
    {"surveyfeet", kSurveyFoot},
    {"in", 0.0254},
    {"inch", 0.0254},
    {"inches", 0.0254},
});

}  // namespace

std::optional<double> metres_of_name(std::string_view name) {
    std::string letters;
    for (const char c : lower(name)) {
        if (c >= 'a' && c <= 'z')
            letters += c;
        else if (!is_blank(c) && c != '-' && c != '_' && c != '.')
            return std::nullopt;
    }
    for (const Unit& unit : kUnits)
        if (letters == unit.name) return unit.metres;
    return std::nullopt;
}

}  // namespace lucarne::io
