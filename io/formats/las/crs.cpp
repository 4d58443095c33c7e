#include "io/formats/las/crs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/crs/registry.h"

namespace lucarne::io::las {
namespace {

constexpr uint16_t kWktBit = 1 << 4;  // in the global encoding
constexpr uint16_t kModelTypeKey = 1024, kLinearUnitsKey = 3076, kLinearUnitSizeKey = 3077;
constexpr uint16_t kProjectedKey = 3072, kGeodeticKey = 2048, kGeoTextsRecord = 34737;
constexpr uint16_t kVerticalKey = 4096, kVerticalUnitsKey = 4099;
constexpr std::array<uint16_t, 3> kCitations = {3073, 1026, 2049};
constexpr double kSameHeights = 1e-5;  ///< the two feet count as the same for heights
constexpr uint16_t kModelGeographic = 2, kUserDefined = 32767;

bool plausible(double metres) {
    return metres > 1e-9 && metres < 1e9;
}

/// Returns the usual units of length without the registry (EPSG registry, "units of measure").
std::optional<double> unit_of_code(uint16_t code) {
    if (code == 9001) return 1.0;
    if (code == 9002) return 0.3048;           // international foot
    if (code == 9003) return 1200.0 / 3937.0;  // US survey foot
    return registered_unit(code);
}

struct GeoKeys {
    std::optional<uint16_t> model, unit, projected, geodetic, vertical, vertical_unit;
    std::array<std::string, 3> names;  ///< of the projected system, of the whole, of the geodetic system
    std::optional<double> unit_size;
};

/// Returns a citation: up to `count` characters of the record from `first` on, up to its bar.
std::string citation(std::string_view texts, size_t first, size_t count) {
    std::string name;
    for (const char c : texts.substr(std::min(first, texts.size()), count)) {
        if (c == '|' || c == '\0') break;
        name += c >= ' ' && c < 0x7f ? c : '?';
    }
    return name;
}

GeoKeys geo_keys(std::span<const std::byte> directory, std::span<const std::byte> doubles,
                 std::string_view texts = {}) {
    GeoKeys keys;
    for (size_t at = 8; directory.size() >= 8 && directory.size() - at >= 8; at += 8) {
        const auto id = load<uint16_t>(&directory[at]), location = load<uint16_t>(&directory[at + 2]);
        const auto value = load<uint16_t>(&directory[at + 6]);
        if (id == kProjectedKey && location == 0) keys.projected = value;
        if (id == kGeodeticKey && location == 0) keys.geodetic = value;
        if (id == kVerticalKey && location == 0) keys.vertical = value;
        if (id == kVerticalUnitsKey && location == 0) keys.vertical_unit = value;
        for (size_t i = 0; i < kCitations.size(); ++i)
            if (id == kCitations[i] && location == kGeoTextsRecord)
                keys.names[i] = citation(texts, value, load<uint16_t>(&directory[at + 4]));
        if (id == kModelTypeKey && location == 0) keys.model = value;
        if (id == kLinearUnitsKey && location == 0) keys.unit = value;
        if (id == kLinearUnitSizeKey && location == kGeoDoublesRecord && (value + 1u) * 8u <= doubles.size())
            keys.unit_size = load<double>(&doubles[value * size_t{8}]);
        if (directory.size() - at < 16) break;
    }
    return keys;
}

std::span<const std::byte> doubles_of(const Header& header) {
    const Vlr* doubles = header.find(kProjectionUser, kGeoDoublesRecord);
    return doubles ? std::span<const std::byte>(doubles->data) : std::span<const std::byte>{};
}

/// Returns whether the well-known text is in effect, and not the GeoTIFF keys.
bool text_counts(const Header& header) {
    return (header.global_encoding & kWktBit) || !header.find(kProjectionUser, kGeoKeyRecord);
}

Units units_of_text(std::string_view text) {
    if (text.find_first_not_of(std::string_view(" \t\r\n\0", 5)) == text.npos)
        return {};  // the text states no system
    Units units{wkt_units(text), {}};
    if (units.known()) return units;
    if (const auto understood = understood_units(text)) static_cast<SystemUnits&>(units) = *understood;
    if (!units.known()) units.unknown = "its well-known text has none";
    return units;
}

/// Returns the unit of heights: from its own key, otherwise from the heights' system. Codes below 4096 and
/// user-defined systems give none.
std::optional<double> vertical_unit(const GeoKeys& keys) {
    if (keys.vertical_unit) return unit_of_code(*keys.vertical_unit);
    if (!keys.vertical || *keys.vertical == kUserDefined) return std::nullopt;
    const auto system = registered_units(*keys.vertical);
    return system ? system->vertical : std::nullopt;
}

Units units_of_keys(const GeoKeys& keys) {
    Units units;
    units.vertical = vertical_unit(keys);
    units.degrees = keys.model == kModelGeographic || (!keys.model && !keys.projected && keys.geodetic);
    if (units.degrees) return units;
    if (keys.unit == kUserDefined && keys.unit_size && plausible(*keys.unit_size)) {
        units.horizontal = keys.unit_size;
    } else if (keys.unit && *keys.unit != kUserDefined) {
        units.horizontal = unit_of_code(*keys.unit);
        if (!units.horizontal)
            units.unknown = fmt::format("EPSG:{} is not a known unit of length", *keys.unit);
    } else if (keys.projected && *keys.projected != kUserDefined) {
        const auto system = registered_units(*keys.projected);
        if (system) units.horizontal = system->horizontal;
        if (!units.vertical && system) units.vertical = system->vertical;
        if (!units.horizontal)
            units.unknown = fmt::format("EPSG:{} is not a known projection", *keys.projected);
    } else {
        units.unknown = "its GeoTIFF keys have none";
    }
    return units;
}

}  // namespace

Units units_of(const Header& header) {
    const Vlr* wkt = header.find(kProjectionUser, kWktRecord);
    const Vlr* keys = header.find(kProjectionUser, kGeoKeyRecord);
    if (wkt && text_counts(header)) return units_of_text(wkt->text());
    return keys ? units_of_keys(geo_keys(keys->data, doubles_of(header))) : Units{};
}

void warn_of_units(const std::string& file, const Units& units, bool given) {
    if (!units.unknown.empty() && !given)
        log::warn(
            "{}: its coordinate system does not state its unit ({}); metres are assumed; "
            "use --unit if that is wrong",
            file, units.unknown);
    if (units.vertical && units.horizontal &&
        std::abs(*units.vertical / *units.horizontal - 1) > kSameHeights)
        log::warn(
            "{}: its heights are in units of {:.9g} m, its other coordinates in units of {:.9g} m; "
            "the latter is used for all, and heights are not converted",
            file, *units.vertical, *units.horizontal);
}

CoordinateSystem coordinate_system(const Header& header) {
    const Vlr* wkt = header.find(kProjectionUser, kWktRecord);
    const Vlr* directory = header.find(kProjectionUser, kGeoKeyRecord);
    const Vlr* texts = header.find(kProjectionUser, kGeoTextsRecord);
    if (wkt && text_counts(header)) return wkt_system(wkt->text());
    if (!directory) return {};
    const GeoKeys keys = geo_keys(directory->data, {}, texts ? texts->text() : std::string_view());
    const bool geographic = keys.model == kModelGeographic;
    const uint16_t code = (geographic ? keys.geodetic : keys.projected).value_or(0);
    CoordinateSystem system;
    for (const size_t i : geographic ? std::array<size_t, 3>{2, 1, 0} : std::array<size_t, 3>{0, 1, 2})
        if (system.name.empty()) system.name = keys.names[i];
    system.epsg = code == kUserDefined ? 0 : code;
    return system;
}

std::vector<Vlr> projection_records(const FormatNotes& notes) {
    if (notes.projection || notes.las) {
        auto records = notes.projection ? *notes.projection : notes.las->vlrs;
        std::erase_if(records, [](const Vlr& v) { return v.user_id != kProjectionUser; });
        return records;
    }
    if (!notes.e57 || wkt_system(notes.e57->coordinate_system).name.empty()) return {};
    return {wkt_record(notes.e57->coordinate_system)};
}

void set_projection(Header& header, std::vector<Vlr> records) {
    std::erase_if(header.vlrs, [](const Vlr& v) { return v.user_id == kProjectionUser; });
    for (Vlr& record : records) header.vlrs.push_back(std::move(record));
    if (!header.find(kProjectionUser, kWktRecord) || header.find(kProjectionUser, kGeoKeyRecord)) return;
    header.global_encoding |= kWktBit;
    header.minor = 4;
}

Vlr wkt_record(const std::string& wkt) {
    const auto bytes = std::as_bytes(std::span(wkt.c_str(), wkt.size() + 1));  // including the final zero
    return {std::string(kProjectionUser), kWktRecord, "coordinate system", bytes.size() > 0xffff,
            std::vector<std::byte>(bytes.begin(), bytes.end())};
}

void prefer_wkt(const std::string& file, Header& header) {
    header.global_encoding |= kWktBit;
    const Vlr* keys = header.find(kProjectionUser, kGeoKeyRecord);
    if (!keys || header.find(kProjectionUser, kWktRecord)) return;
    const CoordinateSystem system = coordinate_system(header);
    const bool metres = units_of_keys(geo_keys(keys->data, doubles_of(header))).metres() == 1.0;
    const auto wkt = metres ? utm_wkt(system.epsg) : std::nullopt;
    if (wkt)
        header.vlrs.push_back(wkt_record(*wkt));
    else
        log::warn(
            "{}: keeps its coordinate system ({}) as GeoTIFF keys; tools that read only well-known text "
            "do not see it",
            file, system.epsg ? fmt::format("EPSG:{}", system.epsg) : system.name);
}

}  // namespace lucarne::io::las
