#include "io/formats/e57/layout.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/formats/common/color_depth.h"
#include "io/formats/common/format.h"

namespace lucarne::io::e57 {
namespace {

using Names = std::array<std::string_view, 3>;
constexpr Names kCartesian = {"cartesianX", "cartesianY", "cartesianZ"};
constexpr Names kSpherical = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr Names kColor = kColorFields;
constexpr Names kNormal = {"nor:normalX", "nor:normalY", "nor:normalZ"};

/// The range of the values that an attribute must hold, over all scans.
struct Range {
    bool any_float = false, any_double = false;
    int64_t low = 0, high = 0;  ///< of the integer fields; both 0 if there are none

    void include(const Field& field) {
        switch (field.kind) {
            case Field::Kind::f32:
                any_float = true;
                return;
            case Field::Kind::f64:
                any_double = true;
                return;
            case Field::Kind::integer:
                low = std::min(low, field.minimum);
                high = std::max(high, field.largest());
                return;
            default:
                break;
        }
        const auto at = [&](int64_t whole) {
            return std::abs(static_cast<double>(whole) * field.scale + field.offset);
        };
        // A float is enough if it keeps neighbouring values apart.
        const double largest = std::max(at(field.minimum), at(field.largest()));
        (largest * 0x1p-22 < std::abs(field.scale) ? any_float : any_double) = true;
    }
    ScalarType type() const {
        const bool whole = low != 0 || high != 0;
        if (any_double || (any_float && whole)) return ScalarType::f64;
        if (any_float) return ScalarType::f32;
        if (low < 0) {
            const int64_t most = std::max(high, -(low + 1));
            return most < 1 << 7             ? ScalarType::i8
                   : most < 1 << 15          ? ScalarType::i16
                   : most < int64_t{1} << 31 ? ScalarType::i32
                                             : ScalarType::i64;
        }
        return high < 1 << 8             ? ScalarType::u8
               : high < 1 << 16          ? ScalarType::u16
               : high < int64_t{1} << 32 ? ScalarType::u32
                                         : ScalarType::i64;
    }
};

/// How a scan stores its colours: as `type` with `bits` of full intensity (ScanInfo::color_bits). Without
/// `bits` they must be rescaled.
struct ColorKind {
    ScalarType type = ScalarType::u16;
    std::optional<uint32_t> bits;
    double white = 255.0;
    bool same(const ColorKind& other) const { return bits && type == other.type && bits == other.bits; }
};

ColorKind color_kind(const Scan& scan, const std::array<size_t, 3>& fields) {
    Range range;
    bool whole = true;
    for (const size_t i : fields) {
        range.include(scan.fields[i]);
        whole = whole && scan.fields[i].kind == Field::Kind::integer;
    }
    ColorKind kind;
    kind.type = range.type();
    kind.white =
        scan.states_color() ? *scan.color_maximum : color_white(color_bits_of(scan.largest_color, whole));
    // Some files state the limits of the data instead. Limits that need all of 8 or 16 bits therefore count
    // as the full range.
    if (kind.white > 127 && kind.white <= 255)
        kind.white = 255, kind.bits = 8;
    else if (kind.white > 32767 && kind.white <= 65535)
        kind.white = 65535, kind.bits = 16;
    else if (!whole && kind.white <= 1)
        kind.white = 1, kind.bits = 0;
    const bool small = kind.type == ScalarType::u8 || kind.type == ScalarType::u16;
    if ((whole && !small) || (kind.type == ScalarType::u8 && kind.bits != 8u)) kind.bits.reset();
    return kind;
}

class LayoutMaker {
 public:
    LayoutMaker(const std::string& file, const Document& document) : file_(file), document_(document) {}

    Result<Layout> make() {
        layout_.scans.resize(document_.scans.size());
        LUCARNE_TRY(find_coordinates());
        position();
        color();
        normal();
        LUCARNE_TRY(others());
        if (stations_ || filled_.size() > 1) station();
        return std::move(layout_);
    }

 private:
    Result<void> find_coordinates() {
        for (size_t i = 0; i < document_.scans.size(); ++i) {
            const Scan& scan = document_.scans[i];
            ScanLayout& layout = layout_.scans[i];
            if (scan.records == 0) continue;
            filled_.push_back(i);
            auto found = scan.find(kCartesian);
            layout.spherical = !found;
            if (!found) found = scan.find(kSpherical);
            if (!found) return rejected(file_, "has a scan whose points have no coordinates");
            layout.coordinates = *found;
            layout.invalid = scan.find(layout.spherical ? "sphericalInvalidState" : "cartesianInvalidState");
            layout.color_invalid = scan.find(kColor) ? scan.find("isColorInvalid") : std::nullopt;
            if (scan.pose && scan.pose->moves()) layout.pose = scan.pose;
            layout.station = static_cast<uint16_t>(i + 1);
            stations_ = stations_ || scan.pose || layout.spherical;
        }
        return {};
    }

    /// Positions keep the scans' own type if all scans use the same one and no pose moves any of them.
    void position() {
        Schema& schema = layout_.schema;
        for (size_t n = 0; n < filled_.size(); ++n) {
            const Schema own = position_of_scan(filled_[n]);
            if (n == 0) schema = own;
            if (schema != own) schema = Schema{};
        }
    }
    Schema position_of_scan(size_t index) const {
        const Scan& scan = document_.scans[index];
        const ScanLayout& layout = layout_.scans[index];
        Schema schema;
        if (layout.spherical || layout.pose) return schema;
        bool floats = true, whole = true;
        for (int axis = 0; axis < 3; ++axis) {
            const Field& field = scan.fields[layout.coordinates[static_cast<size_t>(axis)]];
            floats = floats && field.kind == Field::Kind::f32;
            whole = whole && field.whole() && field.minimum >= std::numeric_limits<int32_t>::min() &&
                    field.largest() <= std::numeric_limits<int32_t>::max() && field.scale > 0 &&
                    usable(0x1p31 * field.scale) && usable(0x1p31 * field.scale + std::abs(field.offset));
            schema.scale[axis] = field.scale;
            schema.offset[axis] = field.offset;
        }
        if (!whole) schema = Schema{};
        schema.position = floats ? PositionType::f32 : whole ? PositionType::i32_scaled : PositionType::f64;
        schema.stride = static_cast<uint32_t>(position_bytes(schema.position));
        return schema;
    }

    void color() {
        std::optional<ColorKind> common;
        bool alike = true;
        for (const size_t i : filled_) {
            const auto fields = document_.scans[i].find(kColor);
            if (!fields) continue;
            const ColorKind kind = color_kind(document_.scans[i], *fields);
            if (!common) common = kind;
            alike = alike && kind.same(*common);
        }
        if (!common) return;
        layout_.schema.add(std::string(names::color), alike ? common->type : ScalarType::u16, 3);
        layout_.color_bits = alike ? *common->bits : 16;
        const Attribute& attribute = layout_.schema.attributes.back();
        // Points without colour get an albedo of .5, which is .735 in sRGB, as in scans without colours.
        const double white = color_white(layout_.color_bits);
        const double missing = attribute.type == ScalarType::u8 || attribute.type == ScalarType::u16
                                   ? std::round(.735 * white)
                                   : .735 * white;
        for (const size_t i : filled_) {
            const auto fields = document_.scans[i].find(kColor);
            const double gain =
                alike || !fields ? 1.0 : white / color_kind(document_.scans[i], *fields).white;
            for (uint32_t c = 0; c < 3; ++c) {
                Target& target = layout_.scans[i].color[c];
                if (fields) target.field = (*fields)[c];
                target.type = attribute.type;
                target.offset = attribute.offset + c * static_cast<uint32_t>(scalar_bytes(attribute.type));
                target.gain = gain;
                target.missing = missing;
            }
        }
    }

    void normal() {
        bool any = false, doubles = false;
        for (const size_t i : filled_) {
            auto& normal = layout_.scans[i].normal;
            normal = document_.scans[i].find(kNormal);
            if (!normal) continue;
            any = true;
            for (const size_t f : *normal)
                doubles = doubles || document_.scans[i].fields[f].kind == Field::Kind::f64;
        }
        if (any)
            layout_.schema.add(std::string(names::normal), doubles ? ScalarType::f64 : ScalarType::f32, 3);
    }

    /// Returns whether a field has become part of the position, the colour or the normal.
    bool is_taken(size_t scan, size_t field) const {
        const ScanLayout& layout = layout_.scans[scan];
        const auto in = [&](const std::array<size_t, 3>& group) {
            return std::find(group.begin(), group.end(), field) != group.end();
        };
        const bool colored = layout_.schema.find(names::color) && layout.color[0].field;
        return in(layout.coordinates) || layout.invalid == field || (layout.normal && in(*layout.normal)) ||
               (colored && (layout.color[0].field == field || layout.color[1].field == field ||
                            layout.color[2].field == field));
    }

    Result<void> others() {
        std::vector<std::pair<std::string, Range>> found;
        for (const size_t i : filled_)
            for (size_t f = 0; f < document_.scans[i].fields.size(); ++f) {
                const Field& field = document_.scans[i].fields[f];
                if (field.kind == Field::Kind::text || is_taken(i, f)) continue;
                auto place = std::find_if(found.begin(), found.end(),
                                          [&](const auto& entry) { return entry.first == field.name; });
                if (place == found.end()) place = found.insert(place, {field.name, Range{}});
                if (found.size() > kMostFields)
                    return rejected(file_,
                                    fmt::format("has points with more than {} attributes", kMostFields));
                place->second.include(field);
            }
        for (const auto& [name, range] : found) {
            // These names imply a shape or a meaning that a field of this file does not have.
            bool reserved = false;
            for (const auto known : {names::color, names::normal, names::normal_oct, names::area, names::scan,
                                     names::point_source_id})
                reserved = reserved || name == known;
            layout_.schema.add(unique_name(layout_.schema, reserved ? "e57_" + name : name), range.type());
            const Attribute& attribute = layout_.schema.attributes.back();
            for (const size_t i : filled_)
                layout_.scans[i].targets.push_back(
                    {document_.scans[i].find(name), attribute.type, attribute.offset});
        }
        return {};
    }

    void station() {
        layout_.schema.add(std::string(names::point_source_id), ScalarType::u16);
        for (const size_t i : filled_)
            layout_.scans[i].targets.push_back({std::nullopt, ScalarType::u16,
                                                layout_.schema.attributes.back().offset, 1.0,
                                                static_cast<double>(layout_.scans[i].station)});
    }

    const std::string& file_;
    const Document& document_;
    Layout layout_;
    std::vector<size_t> filled_;  ///< scans with records
    bool stations_ = false;
};

}  // namespace

Result<Layout> make_layout(const std::string& file, const Document& document) {
    return LayoutMaker(file, document).make();
}

}  // namespace lucarne::io::e57
