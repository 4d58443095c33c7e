#include "io/formats/wkt.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include <fmt/format.h>

namespace lucarne::io {
namespace {

constexpr size_t kMostDepth = 32, kLongestName = 256, kLongestText = size_t{64} << 10;

std::string_view word_before(std::string_view text, size_t bracket) {
    size_t first = bracket;
    while (first > 0 && ((text[first - 1] >= 'A' && text[first - 1] <= 'Z') || text[first - 1] == '_')) --first;
    return text.substr(first, bracket - first);
}

/// Calls visit(words, place) for every bracket with the keywords around it, its own last, until that is true
/// or brackets stand too deep.
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

/// The quoted text that follows the bracket at `at`, which is moved behind it.
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

bool is_projected(std::string_view word) {
    return word == "PROJCS" || word == "PROJCRS" || word == "PROJECTEDCRS";
}
bool holds_lengths(std::string_view word) {
    return is_projected(word) || word == "LOCAL_CS" || word == "ENGCRS" || word == "ENGINEERINGCRS" ||
           word == "GEOCCS";
}
bool is_horizontal(std::string_view word) {
    return holds_lengths(word) || word == "GEOGCS" || word == "GEOGCRS" || word == "GEODCRS";
}

}  // namespace

std::optional<double> wkt_metres_per_unit(std::string_view wkt) {
    wkt = wkt.substr(0, kLongestText);
    std::optional<double> found;
    walk(wkt, [&](std::span<const std::string_view> words, size_t bracket) {
        // UNIT["name",factor,...] or LENGTHUNIT of the system itself or of one of its axes.
        const size_t depth = words.size();
        if ((words.back() != "UNIT" && words.back() != "LENGTHUNIT") || depth < 2) return false;
        const auto parent = words[depth - 2];
        if (!holds_lengths(parent) && !(parent == "AXIS" && depth > 2 && holds_lengths(words[depth - 3])))
            return false;
        size_t at = bracket;
        if (!quoted(wkt, at)) return false;
        const auto metres = number_behind<double>(wkt, at);
        if (metres > 1e-9 && metres < 1e9) found = metres;
        return found.has_value();
    });
    return found;
}

CoordinateSystem wkt_system(std::string_view wkt) {
    wkt = wkt.substr(0, kLongestText);
    CoordinateSystem system;
    uint32_t horizontal = 0;
    walk(wkt, [&](std::span<const std::string_view> words, size_t bracket) {
        const size_t depth = words.size();
        size_t at = bracket;
        if (depth == 1) {
            for (const char c : quoted(wkt, at).value_or("").substr(0, kLongestName))
                system.name += c >= ' ' && c < 0x7f ? c : '?';
        } else if (words.back() == "AUTHORITY" || words.back() == "ID") {
            const bool epsg = quoted(wkt, at) == std::optional<std::string_view>("EPSG");
            const auto code = epsg ? number_behind<uint32_t>(wkt, at) : 0;
            if (depth == 2 && system.epsg == 0) system.epsg = code;
            if (depth == 3 && is_horizontal(words[1]) && horizontal == 0) horizontal = code;
        }
        return false;
    });
    // The horizontal part of a system that is not compound is that of its base, in degrees.
    const bool compound = wkt.find("COMPD_CS") != wkt.npos || wkt.find("COMPOUNDCRS") != wkt.npos;
    if (system.epsg == 0 && compound) system.epsg = horizontal;
    return system;
}

std::optional<std::string> utm_wkt(uint32_t epsg) {
    struct Datum {
        uint32_t first, zone, zones;  ///< code of the first zone, its number, how many
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
