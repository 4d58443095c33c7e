#include "io/formats/las/target.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/format.h"
#include "io/formats/common/stations.h"
#include "io/formats/common/value_range.h"
#include "io/formats/las/crs.h"
#include "io/formats/las/extras.h"
#include "io/formats/merged_info.h"

namespace lucarne::io::las {
namespace {

constexpr double kLargestInteger = std::numeric_limits<int32_t>::max();

/// Chooses the point format for a schema: that of the source file, or a larger one if that lacks a field.
void choose_format(Header& header, const Schema& schema, bool from_las, Container container) {
    const auto has = [&](std::string_view name) { return schema.find(name) != nullptr; };
    bool extended = container == Container::copc || has(names::scan_angle) || has(names::scanner_channel) ||
                    has(names::nir);
    if (from_las)
        extended = extended || extended_format(header.point_format);
    else if (!has(names::scan_angle_rank))  // not from an older LAS file: make room for all classes
        extended = extended || has(names::classification) || has(names::return_number) ||
                   has(names::number_of_returns);
    const bool gps = has(names::gps_time);
    const bool color = has(names::color);
    const bool nir = has(names::nir);
    if (extended) {
        header.minor = 4;
        header.point_format = nir ? 8 : color ? 7 : 6;
    } else {
        header.point_format = static_cast<uint8_t>((gps ? 1 : 0) + (color ? 2 : 0));
        if (color) header.minor = std::max<uint8_t>(header.minor, 2);  // LAS 1.0 and 1.1 have no colour
    }
}

/// Returns the record, and creates it if it is missing.
Vlr& record_of(Header& header, std::string_view user, uint16_t id) {
    const auto found =
        std::find_if(header.vlrs.begin(), header.vlrs.end(), [&](const Vlr& v) { return v.is(user, id); });
    if (found != header.vlrs.end()) return *found;
    header.vlrs.push_back({std::string(user), id, "", false, {}});
    return header.vlrs.back();
}

/// What a writer must know about the values in advance.
struct Survey {
    Lattice lattice;                 ///< the lattice of the positions
    std::optional<Range> intensity;  ///< the range of intensities that must be spread over 16 bits
};

/// Returns an intensity that the field cannot hold; null if there is none, or if the schema has the field's
/// own value as well.
const Attribute* wide_intensity(const Schema& schema, const std::vector<Attribute>& extra) {
    if (schema.find(std::string(kNearPrefix) + std::string(names::intensity))) return nullptr;
    const auto found = std::find_if(extra.begin(), extra.end(), [](const Attribute& a) {
        return a.name == names::intensity && a.components == 1;
    });
    return found == extra.end() ? nullptr : &*found;
}

/// Finds the lattice for positions that are not integers yet: the one in `options`, otherwise the decimals
/// that they have. Finds the range of intensities: the one that their format states, otherwise that of their
/// values; whole numbers that fit the field stay unchanged.
Result<Survey> survey_of(const Schema& schema, const FormatNotes& notes, const Attribute* intensity,
                         const WriteOptions& options) {
    Survey survey{{schema.scale, schema.offset}, {}};
    if (intensity) survey.intensity = stated_range(notes);
    const bool floats = schema.position != PositionType::i32_scaled;
    if (floats) survey.lattice = options.lattice.value_or(Lattice{glm::dvec3(1e-4), glm::dvec3(0.0)});
    std::optional<DecimalSearch> search;
    if (floats && !options.lattice && options.bounds) search.emplace(schema, *options.bounds);
    std::optional<RangeSearch> range;
    if (intensity && !survey.intensity) range.emplace(schema, *intensity);
    bool positions = search.has_value(), values = range.has_value();
    if (options.preview && (positions || values))
        LUCARNE_TRY(options.preview([&](std::span<const std::byte> records) {
            positions = positions && search->add(records);
            values = values && range->add(records);
            return positions || values;
        }));
    if (search) survey.lattice = search->found();
    if (range) survey.intensity = range->found();
    return survey;
}

void add_stations(Header& header, const std::vector<Station>& stations) {
    if (stations.empty()) {
        std::erase_if(header.vlrs, [](const Vlr& v) { return v.is(kOurUser, kStationsRecord); });
        return;
    }
    const std::string json = stations_to_json(stations);
    const auto bytes = std::as_bytes(std::span(json));
    Vlr& record = record_of(header, kOurUser, kStationsRecord);
    record.description = "scanner positions";
    record.data.assign(bytes.begin(), bytes.end());
    record.extended = json.size() > 0xffff;  // too large for an ordinary record
    if (record.extended) header.minor = 4;
}

/// Adds the coordinate system if the source was not LAS or several scans were merged, and the merged extra
/// bytes.
void state_merged(const std::string& path, Header& header, const FormatNotes& notes) {
    for (const std::string& note : {notes.system_note, notes.extras_note})
        if (!note.empty()) log::warn("{}: {}", path, note);
    if (const auto extras = extras_record(notes))
        record_of(header, kSpecUser, kExtraBytesRecord).data = extras->data;
    if (!notes.las || notes.projection) set_projection(header, projection_records(notes));
}

/// States the unit of length if the header would otherwise be read in another unit. A header without a
/// coordinate system gets a local one with that unit (OGC 01-009, LOCAL_CS; 32767 is the largest datum type
/// for local ones). A header with a coordinate system keeps it.
void state_unit(const std::string& path, Header& header, double metres) {
    const double stated = units_of(header).metres();
    if (same_unit(stated, metres)) return;
    if (header.find(kProjectionUser, kWktRecord) || header.find(kProjectionUser, kGeoKeyRecord)) {
        log::warn(
            "{}: its coordinate system states units of {} m, but the points are in units of {} m; use --unit "
            "{} to open it",
            path, stated, metres, metres);
        return;
    }
    const std::string wkt = fmt::format(
        R"(LOCAL_CS["{1}",LOCAL_DATUM["{1}",32767],UNIT["{0} metres",{0}],AXIS["X",EAST],AXIS["Y",NORTH]])",
        metres, kLocalSystem);
    set_projection(header, {wkt_record(wkt)});
}

/// Derives a scan angle from the whole degrees of older formats.
std::optional<Converter::Field> angle_of_rank(const Schema& from, const Attribute& field) {
    constexpr double kAngleUnit = 0.006;  // degrees (LAS 1.4 R15, table 16)
    const Attribute* rank = from.find(names::scan_angle_rank);
    if (!rank || rank->components != 1) return std::nullopt;
    return Converter::Field{.from = *rank, .to = field, .factor = 1 / kAngleUnit, .fills = true};
}

/// Returns how to fill a field to which no attribute corresponds by name and type: with an approximation, or
/// with a value derived from another attribute.
std::optional<Converter::Field> derived_field(const Schema& from, const Attribute& field, bool extended,
                                              const std::optional<Range>& intensity) {
    const bool near = field.name.starts_with(kNearPrefix);
    const std::string name = near ? field.name.substr(kNearPrefix.size()) : field.name;
    if (const Attribute* a = from.find(name); near && a && a->components == field.components) {
        Converter::Field made{*a, field};
        if (const uint32_t most = largest_value(extended, name); most != UINT32_MAX) made.most = most;
        if (name == names::intensity && intensity) {
            made.factor = 65535.0 / (intensity->high - intensity->low);
            made.shift = -intensity->low * made.factor;
        }
        return made;
    }
    return name == names::scan_angle ? angle_of_rank(from, field) : std::nullopt;
}

Converter make_converter(const Schema& from, const Schema& to, const std::vector<Attribute>& extra,
                         bool extended, double white, const std::optional<Range>& intensity) {
    Converter converter(from, to);
    const size_t fields = to.attributes.size() - extra.size();
    for (size_t i = 0; i < fields; ++i) {
        const Attribute& field = to.attributes[i];
        const Attribute* a = from.find(field.name);
        if (!a || a->components != field.components) {
            if (const auto made = derived_field(from, field, extended, intensity)) converter.map(*made);
            continue;
        }
        converter.map({*a, field, field.name == names::color ? 65535.0 / white : 1.0});
        if (field.name != names::scan_angle) continue;
        // If scans of both kinds are merged, each point has only one of the two angles.
        if (const auto angle = angle_of_rank(from, field)) converter.map(*angle);
    }
    for (size_t k = 0; k < extra.size(); ++k) {
        const Attribute& target = to.attributes[fields + k];  // the same bytes, but the type may be lost
        converter.map({{extra[k].name, target.type, target.components, extra[k].offset}, target});
    }
    return converter;
}

}  // namespace

bool Converter::convert_position(const std::byte* in, std::byte* out) {
    if (from_.position == PositionType::i32_scaled) {
        std::memcpy(out, in, 12);
        return true;
    }
    const glm::dvec3 position = position_of(from_, in);
    const glm::dvec3 at = (position - to_.offset) / to_.scale;
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double whole = std::nearbyint(at[axis]);
        good = good && std::abs(whole) <= kLargestInteger;
        store(out + 4 * axis, static_cast<int32_t>(good ? whole : 0));
        const double back = whole * to_.scale[axis] + to_.offset[axis], x = position[axis];
        const bool same = from_.position == PositionType::f32
                              ? static_cast<float>(back) == static_cast<float>(x)
                              : std::abs(back - x) <= 0x1p-50 * (std::abs(x) + std::abs(to_.offset[axis]));
        if (!same) rounded_ = std::max(rounded_, std::abs(back - x));
    }
    return good;
}

bool Converter::convert(const std::byte* in, size_t count, std::byte* out) {
    bool good = true;
    for (size_t i = 0; i < count; ++i, in += from_.stride, out += to_.stride) {
        std::memset(out, 0, to_.stride);
        good = convert_position(in, out) && good;
        for (const Field& f : fields_) {
            if (f.factor == 1.0 && f.shift == 0.0 && f.from.type == f.to.type) {
                std::memcpy(out + f.to.offset, in + f.from.offset, f.to.bytes());
                continue;
            }
            if (f.fills && scalar_at(f.to.type, out + f.to.offset) != 0) continue;
            const size_t step = scalar_bytes(f.from.type), out_step = scalar_bytes(f.to.type);
            for (size_t c = 0; c < f.to.components; ++c)
                store_scalar(
                    f.to.type, out + f.to.offset + c * out_step,
                    std::min(scalar_at(f.from.type, in + f.from.offset + c * step) * f.factor + f.shift,
                             f.most));
        }
    }
    return good;
}

Result<Target> make_target(const std::string& path, const Schema& schema, const ScanInfo& info,
                           const WriteOptions& options, Container container) {
    const bool from_las = info.notes.las.has_value();
    Target target;
    Header& header = target.header;
    if (from_las) {
        LUCARNE_ASSIGN(header, header_of(path, info.notes));
    } else {
        header.software = "Lucarne";
    }
    header.compressed = container != Container::las;
    const bool was_extended = from_las && extended_format(header.point_format);
    choose_format(header, schema, from_las, container);
    if (options.expected_points > std::numeric_limits<uint32_t>::max()) header.minor = 4;
    add_stations(header, info.stations);
    state_merged(path, header, info.notes);
    state_unit(path, header, info.metres_per_unit);
    if (extended_format(header.point_format) && (header.compressed || !was_extended))
        prefer_wkt(path, header);

    const auto extra = extra_attributes(header, schema);
    LUCARNE_TRY(describe_extras(path, header, extra));
    LUCARNE_ASSIGN(const Survey survey,
                   survey_of(schema, info.notes, wide_intensity(schema, extra), options));
    header.scale = survey.lattice.scale;
    header.offset = survey.lattice.offset;
    target.schema = make_schema(header);
    // The specification requires colours of 16 bits. Those of a LAS file stay as they are.
    const Attribute* color = schema.find(names::color);
    const bool kept = from_las && color && color->type == ScalarType::u16;
    target.converter = make_converter(schema, target.schema, extra, extended_format(header.point_format),
                                      kept ? 65535.0 : color_white(info.color_bits), survey.intensity);
    return target;
}

}  // namespace lucarne::io::las
