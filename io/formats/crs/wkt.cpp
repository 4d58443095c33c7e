#include "io/formats/crs/wkt.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <span>

#include <fmt/format.h>

#include "io/formats/common/text.h"

namespace lucarne::io {
namespace {

constexpr size_t kMostDepth = 32, kLongestName = 256, kLongestText = size_t{64} << 10;

std::string_view word_before(std::string_view text, size_t bracket) {
    size_t first = bracket;
    const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; };
    while (first > 0 && letter(text[first - 1])) --first;
    return text.substr(first, bracket - first);
}

/// Calls visit(words, place) for every bracket, where `words` are the keywords around it, its own last. Stops
/// when `visit` returns true or the brackets nest too deeply.
template <class Visit>
void walk(std::string_view text, const Visit& visit) {
    std::array<std::string_view, kMostDepth> stack{};
    size_t depth = 0;
    for (size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (c == '"') {
            at = text.find('"', at + 1);
            if (at == std::string_view::npos) return;
        } else if (c == '[' || c == '(') {
            if (depth == kMostDepth) return;
            stack[depth++] = word_before(text, at);
            if (visit(std::span<const std::string_view>(stack).first(depth), at)) return;
        } else if ((c == ']' || c == ')') && depth > 0) {
            --depth;
        }
    }
}

/// Returns the quoted text after the bracket at `at`, and moves `at` behind it.
std::optional<std::string_view> quoted(std::string_view text, size_t& at) {
    const size_t open = text.find_first_not_of(" \t\r\n", at + 1);
    if (open == text.npos || text[open] != '"') return std::nullopt;
    const size_t close = text.find('"', open + 1);
    if (close == text.npos) return std::nullopt;
    at = close + 1;
    return text.substr(open + 1, close - open - 1);
}

template <class T>
T number_behind(std::string_view text, size_t at) {
    at = text.find_first_not_of(" \t\r\n,\"", at);
    T value{};
    if (at != text.npos) std::from_chars(text.data() + at, text.data() + text.size(), value);
    return value;
}

bool is_any(std::string_view word, std::initializer_list<std::string_view> keywords) {
    return std::ranges::any_of(keywords,
                               [&](std::string_view keyword) { return same_letters(word, keyword); });
}
bool holds_lengths(std::string_view word) {
    return is_any(word,
                  {"PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS", "GEOCCS"});
}
bool is_geographic(std::string_view word) {
    return is_any(word, {"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"});
}
bool is_vertical(std::string_view word) {
    return is_any(word, {"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"});
}
bool is_compound(std::string_view word) {
    return is_any(word, {"COMPD_CS", "COMPOUNDCRS"});
}

}  // namespace

SystemUnits wkt_units(std::string_view wkt) {
    wkt = wkt.substr(0, kLongestText);
    SystemUnits units;
    walk(wkt, [&](std::span<const std::string_view> words, size_t bracket) {
        const size_t depth = words.size();
        // The base of a projected system is geographic as well, but does not count.
        const bool outer = depth == 1 || (depth == 2 && is_compound(words[0]));
        if (outer && is_geographic(words.back())) units.degrees = true;
        // UNIT["name",factor,...] or LENGTHUNIT of the system itself or of one of its axes.
        if (depth < 2 || !is_any(words.back(), {"UNIT", "LENGTHUNIT"})) return false;
        auto parent = words[depth - 2];
        if (same_letters(parent, "AXIS") && depth > 2) parent = words[depth - 3];
        auto& unit = is_vertical(parent) ? units.vertical : units.horizontal;
        if (unit || !(holds_lengths(parent) || is_vertical(parent))) return false;
        size_t at = bracket;
        if (!quoted(wkt, at)) return false;
        const auto metres = number_behind<double>(wkt, at);
        if (metres > 1e-9 && metres < 1e9) unit = metres;
        return units.horizontal && units.vertical;
    });
    return units;
}

CoordinateSystem wkt_system(std::string_view wkt) {
    wkt = wkt.substr(0, kLongestText);
    CoordinateSystem system;
    uint32_t horizontal = 0;
    bool compound = false;
    walk(wkt, [&](std::span<const std::string_view> words, size_t bracket) {
        const size_t depth = words.size();
        size_t at = bracket;
        if (depth == 1) {
            compound = compound || is_compound(words[0]);
            for (const char c : quoted(wkt, at).value_or("").substr(0, kLongestName))
                system.name += c >= ' ' && c < 0x7f ? c : '?';
        } else if (is_any(words.back(), {"AUTHORITY", "ID"})) {
            const bool epsg = quoted(wkt, at) == std::optional<std::string_view>("EPSG");
            const auto code = epsg ? number_behind<uint32_t>(wkt, at) : 0;
            if (depth == 2 && system.epsg == 0) system.epsg = code;
            if (depth == 3 && (holds_lengths(words[1]) || is_geographic(words[1])) && horizontal == 0)
                horizontal = code;
        }
        return false;
    });
    // Without a compound system, the "horizontal part" is the base of a projected system, which is in
    // degrees.
    if (system.epsg == 0 && compound) system.epsg = horizontal;
    return system;
}

std::optional<std::string> utm_wkt(uint32_t epsg) {
    struct Datum {
        uint32_t first, zone, zones;  ///< code of the first zone, its number, number of zones
        char half;                    ///< N or S of the equator
        const char *name, *datum, *spheroid;
        uint32_t code, datum_code;
    };
    constexpr const char* kWgs = R"("WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"])";
    constexpr const char* kGrs = R"("GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"])";
    constexpr std::array kDatums = {
        Datum{32601, 1, 60, 'N', "WGS 84", "WGS_1984", kWgs, 4326, 6326},
        Datum{32701, 1, 60, 'S', "WGS 84", "WGS_1984", kWgs, 4326, 6326},
        Datum{25828, 28, 11, 'N', "ETRS89", "European_Terrestrial_Reference_System_1989", kGrs, 4258, 6258},
        Datum{26901, 1, 23, 'N', "NAD83", "North_American_Datum_1983", kGrs, 4269, 6269}};
    for (const Datum& d : kDatums) {
        if (epsg < d.first || epsg >= d.first + d.zones) continue;
        const uint32_t zone = d.zone + epsg - d.first;
        return fmt::format(
            R"(PROJCS["{0} / UTM zone {1}{2}",GEOGCS["{0}",DATUM["{3}",SPHEROID[{4}],AUTHORITY["EPSG","{5}"]],)"
            R"(PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],)"
            R"(UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","{6}"]],)"
            R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
            R"(PARAMETER["central_meridian",{7}],PARAMETER["scale_factor",0.9996],)"
            R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",{8}],)"
            R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH],)"
            R"(AUTHORITY["EPSG","{9}"]])",
            d.name, zone, d.half, d.datum, d.spheroid, d.datum_code, d.code, 6 * static_cast<int>(zone) - 183,
            d.half == 'S' ? 10'000'000 : 0, epsg);
    }
    return std::nullopt;
}

}  // namespace lucarne::io
