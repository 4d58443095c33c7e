#include "io/formats/las_crs.h"

#include <array>
#include <charconv>
#include <cmath>

#include "io/core/log.h"

namespace lucarne::io::las {
namespace {

constexpr uint16_t kWktBit = 1 << 4;  // of the global encoding
constexpr uint16_t kModelTypeKey = 1024, kLinearUnitsKey = 3076, kLinearUnitSizeKey = 3077;
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
    std::optional<uint16_t> model, unit;
    std::optional<double> unit_size;
};

GeoKeys geo_keys(std::span<const std::byte> directory, std::span<const std::byte> doubles) {
    GeoKeys keys;
    for (size_t at = 8; directory.size() >= 8 && directory.size() - at >= 8; at += 8) {
        const auto id = load<uint16_t>(&directory[at]), location = load<uint16_t>(&directory[at + 2]);
        const auto value = load<uint16_t>(&directory[at + 6]);
        if (id == kModelTypeKey && location == 0) keys.model = value;
        if (id == kLinearUnitsKey && location == 0) keys.unit = value;
        if (id == kLinearUnitSizeKey && location == kGeoDoublesRecord && (value + 1u) * 8u <= doubles.size())
            keys.unit_size = load<double>(&doubles[value * size_t{8}]);
        if (directory.size() - at < 16) break;
    }
    return keys;
}

/// Walks the brackets of a well-known text and reports every keyword with its depth and parent.
class WktUnits {
 public:
    explicit WktUnits(std::string_view text) : text_(text) {}

    std::optional<double> find() {
        for (size_t at = 0; at < text_.size(); ++at) {
            const char c = text_[at];
            if (c == '"') {
                at = text_.find('"', at + 1);
                if (at == std::string_view::npos) break;
            } else if (c == '[' || c == '(') {
                if (depth_ == kMostDepth) return std::nullopt;
                stack_[depth_++] = word_before(at);
                if (const auto unit = unit_at(at)) return unit;
            } else if (c == ']' || c == ')') {
                if (depth_ > 0) --depth_;
            }
        }
        return std::nullopt;
    }

 private:
    static constexpr size_t kMostDepth = 32;
    static bool holds_lengths(std::string_view word) {
        return word == "PROJCS" || word == "PROJCRS" || word == "PROJECTEDCRS" || word == "LOCAL_CS" ||
               word == "ENGCRS" || word == "ENGINEERINGCRS" || word == "GEOCCS";
    }
    std::string_view word_before(size_t bracket) const {
        size_t first = bracket;
        while (first > 0 && ((text_[first - 1] >= 'A' && text_[first - 1] <= 'Z') || text_[first - 1] == '_'))
            --first;
        return text_.substr(first, bracket - first);
    }
    /// UNIT["name",factor,...] or LENGTHUNIT of the system itself or of one of its axes.
    std::optional<double> unit_at(size_t bracket) const {
        const auto word = stack_[depth_ - 1];
        if ((word != "UNIT" && word != "LENGTHUNIT") || depth_ < 2) return std::nullopt;
        const auto parent = stack_[depth_ - 2];
        if (!holds_lengths(parent) && !(parent == "AXIS" && depth_ > 2 && holds_lengths(stack_[depth_ - 3])))
            return std::nullopt;
        const size_t open = text_.find('"', bracket);
        const size_t close = open == std::string_view::npos ? open : text_.find('"', open + 1);
        size_t at = close == std::string_view::npos ? close : text_.find_first_not_of(" \t\r\n,", close + 1);
        if (at == std::string_view::npos) return std::nullopt;
        double metres = 0;
        std::from_chars(text_.data() + at, text_.data() + text_.size(), metres);
        if (!plausible(metres)) return std::nullopt;
        return metres;
    }

    std::string_view text_;
    std::array<std::string_view, kMostDepth> stack_{};
    size_t depth_ = 0;
};

}  // namespace

std::optional<double> wkt_metres_per_unit(std::string_view wkt) {
    return WktUnits(wkt).find();
}

std::optional<double> geotiff_metres_per_unit(std::span<const std::byte> directory,
                                              std::span<const std::byte> doubles) {
    const GeoKeys keys = geo_keys(directory, doubles);
    if (keys.unit == kUserDefined && keys.unit_size && plausible(*keys.unit_size)) return keys.unit_size;
    return keys.unit ? epsg_unit(*keys.unit) : std::nullopt;
}

double metres_per_unit(const std::string& file, const Header& header) {
    const Vlr* wkt = header.find(kProjectionUser, kWktRecord);
    const Vlr* keys = header.find(kProjectionUser, kGeoKeyRecord);
    const Vlr* doubles = header.find(kProjectionUser, kGeoDoublesRecord);
    if (wkt && ((header.global_encoding & kWktBit) || !keys)) {
        if (const auto unit = wkt_metres_per_unit(wkt->text())) return *unit;
        if (wkt->text().starts_with("GEOGCS"))
            log::warn("{}: its coordinates are degrees, not lengths", file);
    }
    if (!keys) return 1.0;
    const std::span<const std::byte> numbers =
        doubles ? std::span<const std::byte>(doubles->data) : std::span<const std::byte>{};
    if (geo_keys(keys->data, numbers).model == kModelGeographic)
        log::warn("{}: its coordinates are degrees, not lengths", file);
    return geotiff_metres_per_unit(keys->data, numbers).value_or(1.0);
}

}  // namespace lucarne::io::las
