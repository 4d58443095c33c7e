#include "io/formats/las_crs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/log.h"

namespace lucarne::io::las {
namespace {

constexpr uint16_t kWktBit = 1 << 4;  // of the global encoding
constexpr uint16_t kModelTypeKey = 1024, kLinearUnitsKey = 3076, kLinearUnitSizeKey = 3077;
constexpr uint16_t kProjectedKey = 3072, kGeodeticKey = 2048, kGeoTextsRecord = 34737;
constexpr std::array<uint16_t, 3> kCitations = {3073, 1026, 2049};
constexpr uint16_t kModelGeographic = 2, kUserDefined = 32767;

bool plausible(double metres) {
    return metres > 1e-9 && metres < 1e9;
}

/// EPSG codes of units of length (EPSG registry, "units of measure").
std::optional<double> epsg_unit(uint16_t code) {
    switch (code) {
        case 9001:
            return 1.0;
        case 9002:
            return 0.3048;  // international foot
        case 9003:
            return 1200.0 / 3937.0;  // US survey foot
        case 9005:
            return 0.3047972654;  // Clarke's foot
        case 9014:
            return 1.8288;  // fathom
        case 9030:
            return 1852.0;  // nautical mile
        case 9036:
            return 1000.0;
        case 9080:
            return 0.304799510248;  // Indian foot
        case 9084:
            return 0.3047995;  // Indian foot of 1975
        default:
            return std::nullopt;
    }
}

struct GeoKeys {
    std::optional<uint16_t> model, unit, projected, geodetic;
    std::array<std::string, 3> names;  ///< of the projected system, of all, of the geodetic system
    std::optional<double> unit_size;
};

/// A citation: `count` characters at `first` of the record, up to its bar.
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

}  // namespace

std::optional<double> geotiff_metres_per_unit(std::span<const std::byte> directory,
                                              std::span<const std::byte> doubles) {
    const GeoKeys keys = geo_keys(directory, doubles);
    if (keys.unit == kUserDefined && keys.unit_size && plausible(*keys.unit_size)) return keys.unit_size;
    return keys.unit ? epsg_unit(*keys.unit) : std::nullopt;
}

std::optional<double> stated_unit(const std::string& file, const Header& header) {
    const Vlr* wkt = header.find(kProjectionUser, kWktRecord);
    const Vlr* keys = header.find(kProjectionUser, kGeoKeyRecord);
    if (wkt && ((header.global_encoding & kWktBit) || !keys)) {
        if (const auto unit = wkt_metres_per_unit(wkt->text())) return unit;
        if (wkt->text().starts_with("GEOGCS"))
            log::warn("{}: its coordinates are degrees, not lengths", file);
    }
    if (!keys) return std::nullopt;
    const auto numbers = doubles_of(header);
    if (geo_keys(keys->data, numbers).model == kModelGeographic)
        log::warn("{}: its coordinates are degrees, not lengths", file);
    return geotiff_metres_per_unit(keys->data, numbers);
}

CoordinateSystem coordinate_system(const Header& header) {
    const Vlr* wkt = header.find(kProjectionUser, kWktRecord);
    const Vlr* directory = header.find(kProjectionUser, kGeoKeyRecord);
    const Vlr* texts = header.find(kProjectionUser, kGeoTextsRecord);
    if (wkt && ((header.global_encoding & kWktBit) || !directory)) return wkt_system(wkt->text());
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

std::vector<Vlr> projection_records(const nlohmann::json& details) {
    if (!details.is_object()) return {};
    const bool merged = details.contains("projection");
    if (merged || details.value("format", nlohmann::json()) == "las") {
        auto records =
            records_from_json(details.value(merged ? "projection" : "records", nlohmann::json::array()));
        if (!records) return {};
        std::erase_if(*records, [](const Vlr& v) { return v.user_id != kProjectionUser; });
        return std::move(*records);
    }
    const auto text = details.value("coordinate_system", nlohmann::json());
    if (!text.is_string() || wkt_system(text.get<std::string>()).name.empty()) return {};
    return {wkt_record(text.get<std::string>())};
}

void set_projection(Header& header, std::vector<Vlr> records) {
    std::erase_if(header.vlrs, [](const Vlr& v) { return v.user_id == kProjectionUser; });
    for (Vlr& record : records) header.vlrs.push_back(std::move(record));
    if (!header.find(kProjectionUser, kWktRecord) || header.find(kProjectionUser, kGeoKeyRecord)) return;
    header.global_encoding |= kWktBit;
    header.minor = 4;
}

Vlr wkt_record(const std::string& wkt) {
    const auto bytes = std::as_bytes(std::span(wkt.c_str(), wkt.size() + 1));  // with its final zero
    return {std::string(kProjectionUser), kWktRecord, "coordinate system", bytes.size() > 0xffff,
            std::vector<std::byte>(bytes.begin(), bytes.end())};
}

void prefer_wkt(const std::string& file, Header& header) {
    header.global_encoding |= kWktBit;
    const Vlr* keys = header.find(kProjectionUser, kGeoKeyRecord);
    if (!keys || header.find(kProjectionUser, kWktRecord)) return;
    const CoordinateSystem system = coordinate_system(header);
    const auto unit = geotiff_metres_per_unit(keys->data, doubles_of(header));
    const auto wkt = unit.value_or(1.0) == 1.0 ? utm_wkt(system.epsg) : std::nullopt;
    if (wkt)
        header.vlrs.push_back(wkt_record(*wkt));
    else
        log::warn(
            "{}: keeps its coordinate system ({}) as GeoTIFF keys; tools that read nothing but well-known "
            "text do "
            "not see it",
            file, system.epsg ? fmt::format("EPSG:{}", system.epsg) : system.name);
}

}  // namespace lucarne::io::las
