#include "viewer/picking/exact_point.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "gi/scene/colour_map.h"
#include "octree/tree/attributes.h"
#include "octree/tree/scan_number.h"
#include "octree/tree/stored_names.h"

namespace lucarne::viewer {
namespace {

using Wide = __int128;

/// A scale with more decimals was not chosen as a decimal number; an example is 1/3 of a millimetre.
constexpr int kMostDecimals = 12;
constexpr int kMostShift = 18;  ///< powers of ten by which a 54-bit mantissa times 32 bits stays in 128 bits

/// The number mantissa * 10^exponent.
struct Decimal {
    Wide mantissa = 0;
    int exponent = 0;
};

/// Returns the shortest decimal that reads back as the same number.
template <class Float>
std::string shortest(Float value, std::chars_format format) {
    std::array<char, 400> text;  // the widest double without an exponent has 327 characters
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, format);
    return {text.data(), end.ptr};
}

Decimal decimal_of(double value) {
    Decimal result;
    bool negative = false, fraction = false;
    const std::string text = shortest(value, std::chars_format::scientific);
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '-') negative = true;
        if (c == '.') fraction = true;
        if (c == 'e') {
            result.exponent += std::atoi(&text[i + 1]);
            break;
        }
        if (c < '0' || c > '9') continue;
        result.mantissa = result.mantissa * 10 + (c - '0');
        if (fraction) --result.exponent;
    }
    if (negative) result.mantissa = -result.mantissa;
    return result;
}

Wide power_of_ten(int exponent) {
    Wide power = 1;
    while (exponent-- > 0) power *= 10;
    return power;
}

std::string text_of(Wide number, int decimals) {
    const bool negative = number < 0;
    if (negative) number = -number;
    std::string digits;
    for (; number > 0; number /= 10) digits += static_cast<char>('0' + static_cast<int>(number % 10));
    while (static_cast<int>(digits.size()) <= decimals) digits += '0';
    if (decimals > 0) digits.insert(static_cast<size_t>(decimals), 1, '.');
    if (negative) digits += '-';
    std::ranges::reverse(digits);
    return digits;
}

/// Returns integer * scale + offset as exact text, or nothing if scale or offset has no short decimal.
std::optional<std::string> scaled_text(int32_t integer, double scale, double offset) {
    Decimal product = decimal_of(scale), shift = decimal_of(offset);
    product.mantissa *= integer;
    if (shift.mantissa == 0) shift.exponent = product.exponent;
    const int exponent = std::min({product.exponent, shift.exponent, 0});
    if (-exponent > kMostDecimals || product.exponent - exponent > kMostShift ||
        shift.exponent - exponent > kMostShift)
        return std::nullopt;
    return text_of(product.mantissa * power_of_ten(product.exponent - exponent) +
                       shift.mantissa * power_of_ten(shift.exponent - exponent),
                   -exponent);
}

std::string number_text(io::ScalarType type, const std::byte* at) {
    using io::ScalarType;
    switch (type) {
        case ScalarType::u64:
            return std::to_string(io::load<uint64_t>(at));
        case ScalarType::i64:
            return std::to_string(io::load<int64_t>(at));
        case ScalarType::f32:
            return fmt::format("{}", io::load<float>(at));
        case ScalarType::f64:
            return fmt::format("{}", io::load<double>(at));
        default:
            return fmt::format("{:.0f}", io::scalar_at(type, at));
    }
}

std::string plain_value(const io::Attribute& attribute, const std::byte* record) {
    std::string text;
    for (uint32_t c = 0; c < attribute.components; ++c) {
        if (c) text += ' ';
        text += number_text(attribute.type, record + attribute.offset + c * io::scalar_bytes(attribute.type));
    }
    return text;
}

std::string file_name(const std::vector<io::ScanInfo>& scans, size_t index) {
    return index < scans.size() ? std::filesystem::path(scans[index].path).filename().string()
                                : std::string();
}

/// Returns an attribute as a field, or nothing if the attribute is not a property of the scanned point.
std::optional<PointField> field_of(const octree::SourceHeader& header, const io::Attribute& attribute,
                                   const std::byte* record) {
    const std::byte* at = record + attribute.offset;
    const bool bytes = attribute.type == io::ScalarType::u8;
    const bool estimated_normal = attribute.name == io::names::normal_oct;
    if (octree::is_estimate(attribute.name) && !estimated_normal) return std::nullopt;
    if (estimated_normal && bytes && attribute.components == 3) {
        const auto normal = octree::decode_normal(io::load<octree::NormalCode>(at));
        if (!normal) return PointField{std::string(kEstimatedNormal), "none"};
        return PointField{std::string(kEstimatedNormal),
                          fmt::format("{:.3f} {:.3f} {:.3f}", normal->x, normal->y, normal->z)};
    }
    PointField field{attribute.name, plain_value(attribute, record)};
    if (attribute.components != 1) return field;
    if (attribute.name == io::names::classification) {
        const double code = io::scalar_at(attribute.type, at);
        if (code >= 0 && code <= 255)
            field.value += fmt::format(" {}", gi::class_name(static_cast<uint8_t>(code)));
    }
    if (attribute.name == io::names::scan)
        if (const std::string name = file_name(header.scans, octree::ScanNumber(header.schema).of(record));
            !name.empty())
            field.value.append(" ").append(name);
    return field;
}

}  // namespace

std::array<std::string, 3> coordinate_texts(const io::Schema& schema, const std::byte* record) {
    std::array<std::string, 3> texts;
    const glm::dvec3 position = io::position_of(schema, record);
    for (int axis = 0; axis < 3; ++axis) {
        std::string& text = texts[static_cast<size_t>(axis)];
        if (schema.position == io::PositionType::i32_scaled)
            text = scaled_text(io::load<int32_t>(record + 4 * axis), schema.scale[axis], schema.offset[axis])
                       .value_or("");
        if (!text.empty()) continue;
        text = schema.position == io::PositionType::f32
                   ? shortest(static_cast<float>(position[axis]), std::chars_format::fixed)
                   : shortest(position[axis], std::chars_format::fixed);
    }
    return texts;
}

ExactPoint exact_point(const octree::NodeSource& source, uint32_t node, const std::byte* record) {
    const octree::SourcePart part = source.part_of(node);
    const io::Schema& schema = part.header.schema;
    ExactPoint point;
    point.coordinates = coordinate_texts(schema, record);
    for (int axis = 0; axis < 3; ++axis) {
        // Take the double nearest to the exact text, since integer * scale + offset in doubles is rounded
        // twice.
        const std::string& text = point.coordinates[static_cast<size_t>(axis)];
        std::from_chars(text.data(), text.data() + text.size(), point.position[axis]);
    }
    point.position *= part.scale;
    for (const io::Attribute& attribute : schema.attributes)
        if (auto field = field_of(part.header, attribute, record)) point.fields.push_back(std::move(*field));
    if (!schema.find(io::names::scan))
        if (std::string name = file_name(part.header.scans, 0); !name.empty())
            point.fields.push_back({std::string(io::names::scan), std::move(name)});
    return point;
}

}  // namespace lucarne::viewer
