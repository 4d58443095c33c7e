#include "io/formats/las_target.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/log.h"
#include "io/formats/format.h"
#include "io/formats/las_crs.h"
#include "io/formats/stations.h"

namespace lucarne::io::las {
namespace {

constexpr double kLargestInteger = std::numeric_limits<int32_t>::max();
constexpr uint16_t kWktBit = 1 << 4;

bool is_float(ScalarType t) {
    return t == ScalarType::f32 || t == ScalarType::f64;
}
bool is_signed(ScalarType t) {
    return t == ScalarType::i8 || t == ScalarType::i16 || t == ScalarType::i32 || t == ScalarType::i64;
}
/// Whether `wide` can hold every value of `narrow`.
bool holds(ScalarType wide, ScalarType narrow) {
    if (wide == narrow) return true;
    const size_t w = scalar_bytes(wide), n = scalar_bytes(narrow);
    if (is_float(wide)) return w > n;  // f64 holds f32 and integers up to 32 bits, f32 those up to 16
    if (is_float(narrow)) return false;
    return w > n && (is_signed(wide) || !is_signed(narrow));
}

/// Whether a field of a point format takes the attribute as it is; `color` may be scaled to 16 bits.
bool fits(const Attribute& field, const Attribute& attribute) {
    return field.components == attribute.components && holds(field.type, attribute.type);
}

/// The point format for a schema: that of the file it came from, or a larger one where it lacks a field.
void choose_format(Header& header, const Schema& schema, bool from_las, bool compress) {
    const auto has = [&](std::string_view name) { return schema.find(name) != nullptr; };
    bool extended = compress || has(names::scan_angle) || has(names::scanner_channel) || has(names::nir);
    if (from_las)
        extended = extended || extended_format(header.point_format);
    else if (!has(names::scan_angle_rank))  // not out of an older LAS file: let every class and return fit
        extended = extended || has(names::classification) || has(names::return_number) ||
                   has(names::number_of_returns);
    const bool gps = has(names::gps_time) || (from_las && has_gps_time(header.point_format));
    const bool color = has(names::color) || (from_las && has_color(header.point_format));
    const bool nir = has(names::nir) || (from_las && header.point_format == 8);
    if (extended) {
        if (!from_las) header.global_encoding |= kWktBit;
        header.minor = 4;
        header.point_format = nir ? 8 : color ? 7 : 6;
    } else {
        header.point_format = static_cast<uint8_t>((gps ? 1 : 0) + (color ? 2 : 0));
    }
}

/// The entry of the extra bytes record for an attribute: the source's own where it had one.
Result<std::vector<std::byte>> descriptor_of(const std::string& path, const Attribute& attribute,
                                             const Vlr* kept) {
    for (size_t at = 0; kept && kept->data.size() - at >= kDescriptorBytes; at += kDescriptorBytes) {
        const auto entry = std::span(kept->data).subspan(at, kDescriptorBytes);
        const auto type = extra_type(entry);
        if (printable(extra_name(entry)) == attribute.name && type && type->type == attribute.type &&
            type->components == attribute.components)
            return std::vector<std::byte>(entry.begin(), entry.end());
    }
    std::vector<std::byte> entry(kDescriptorBytes);
    const size_t bytes = attribute.bytes();
    if (attribute.components <= 3) {
        store(&entry[2],
              static_cast<uint8_t>(static_cast<unsigned>(attribute.type) + 10 * (attribute.components - 1)));
    } else if (bytes <= 255) {
        store(&entry[3], static_cast<uint8_t>(bytes));  // undocumented: its size instead of its type
    } else {
        return failed(path,
                      fmt::format("LAS cannot hold the attribute {} of {} bytes", attribute.name, bytes),
                      "choose PLY");
    }
    std::memcpy(&entry[4], attribute.name.data(), std::min<size_t>(32, attribute.name.size()));
    return entry;
}

/// The attributes that go to extra bytes, in record order; bytes that nobody described come last.
std::vector<Attribute> extra_attributes(const Header& header, const Schema& schema) {
    Header bare;
    bare.point_format = header.point_format;
    bare.record_length = record_bytes(header.point_format);
    const Schema fields = make_schema(bare);
    std::vector<Attribute> extra;
    for (const Attribute& a : schema.attributes) {
        const Attribute* field = fields.find(a.name);
        if (!field || !fits(*field, a)) extra.push_back(a);
    }
    std::stable_partition(extra.begin(), extra.end(),
                          [](const Attribute& a) { return a.name != "extra_bytes"; });
    return extra;
}

/// The record, made if it is not there yet.
Vlr& record_of(Header& header, std::string_view user, uint16_t id) {
    const auto found =
        std::find_if(header.vlrs.begin(), header.vlrs.end(), [&](const Vlr& v) { return v.is(user, id); });
    if (found != header.vlrs.end()) return *found;
    header.vlrs.push_back({std::string(user), id, "", false, {}});
    return header.vlrs.back();
}

Result<void> describe_extras(const std::string& path, Header& header, const std::vector<Attribute>& extra) {
    std::vector<std::byte> described;
    size_t bytes = record_bytes(header.point_format);
    for (const Attribute& a : extra) {
        bytes += a.bytes();
        if (a.name == "extra_bytes" && a.type == ScalarType::u8) continue;
        LUCARNE_ASSIGN(const auto entry, descriptor_of(path, a, header.find(kSpecUser, kExtraBytesRecord)));
        described.insert(described.end(), entry.begin(), entry.end());
    }
    if (bytes > 0xffff || described.size() > 0xffff)
        return failed(path, "has more attributes than a LAS record can hold", "choose PLY");
    header.record_length = static_cast<uint16_t>(bytes);
    if (described.empty())
        std::erase_if(header.vlrs, [](const Vlr& v) { return v.is(kSpecUser, kExtraBytesRecord); });
    else
        record_of(header, kSpecUser, kExtraBytesRecord).data = std::move(described);
    return {};
}

/// For positions that are not integers yet.
Result<Lattice> choose_lattice(const Schema& schema, const WriteOptions& options) {
    if (options.lattice) return *options.lattice;
    if (!options.bounds) return Lattice{glm::dvec3(1e-4), glm::dvec3(0.0)};
    DecimalSearch search(schema, *options.bounds);
    if (options.preview)
        LUCARNE_TRY(options.preview([&](std::span<const std::byte> records) { return search.add(records); }));
    return search.found();
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
    record.extended = json.size() > 0xffff;  // more than an ordinary record can hold
    if (record.extended) header.minor = 4;
}

/// Says the unit of length where the header would be read as saying another. Without a coordinate system it gets a
/// local one of that unit (OGC 01-009, LOCAL_CS; the datum's type is the largest of local ones); its own is kept.
void state_unit(const std::string& path, Header& header, double metres) {
    const double stated = metres_per_unit(path, header);
    if (std::abs(stated / metres - 1) < 1e-9) return;
    if (header.find(kProjectionUser, kWktRecord) || header.find(kProjectionUser, kGeoKeyRecord)) {
        log::warn("{}: its coordinate system says units of {} m, but they were read as {} m; say --unit {} to open it",
                  path, stated, metres, metres);
        return;
    }
    const std::string wkt = fmt::format(
        R"(LOCAL_CS["local",LOCAL_DATUM["local",32767],UNIT["{0} metres",{0}],AXIS["X",EAST],AXIS["Y",NORTH]])", metres);
    const auto bytes = std::as_bytes(std::span(wkt.c_str(), wkt.size() + 1));  // with its final zero
    Vlr& record = record_of(header, kProjectionUser, kWktRecord);
    record.description = "coordinate system";
    record.data.assign(bytes.begin(), bytes.end());
    header.global_encoding |= kWktBit;
    header.minor = 4;
}

Converter make_converter(const Schema& from, const Schema& to, const std::vector<Attribute>& extra,
                         uint32_t color_bits) {
    Converter converter(from, to);
    const size_t fields = to.attributes.size() - extra.size();
    for (size_t i = 0; i < fields; ++i) {
        const Attribute& field = to.attributes[i];
        const Attribute* a = from.find(field.name);
        if (!a || a->components != field.components) continue;
        // Colours of 16 bits stay as they are; the specification wants all others spread over 16 bits.
        const bool spread = field.name == names::color && a->type != ScalarType::u16;
        converter.map(*a, field, spread ? 65535.0 / color_white(color_bits) : 1.0);
    }
    for (size_t k = 0; k < extra.size(); ++k) {
        const Attribute& target = to.attributes[fields + k];  // the same bytes, but maybe without their type
        converter.map({extra[k].name, target.type, target.components, extra[k].offset}, target);
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
            if (f.factor == 1.0 && f.from.type == f.to.type) {
                std::memcpy(out + f.to.offset, in + f.from.offset, f.to.bytes());
                continue;
            }
            const size_t step = scalar_bytes(f.from.type), out_step = scalar_bytes(f.to.type);
            for (size_t c = 0; c < f.to.components; ++c)
                store_scalar(f.to.type, out + f.to.offset + c * out_step,
                             scalar_at(f.from.type, in + f.from.offset + c * step) * f.factor);
        }
    }
    return good;
}

Result<Target> make_target(const std::string& path, const Schema& schema, const ScanInfo& info,
                           const WriteOptions& options, bool compress) {
    const auto details = nlohmann::json::parse(info.details, nullptr, false);
    const bool from_las = details.is_object() && details.value("format", nlohmann::json()) == "las";
    Target target;
    Header& header = target.header;
    if (from_las) {
        LUCARNE_ASSIGN(header, from_details(path, details));
    } else {
        header.software = "Lucarne";
    }
    header.compressed = compress;
    choose_format(header, schema, from_las, compress);
    Lattice lattice{schema.scale, schema.offset};
    if (schema.position != PositionType::i32_scaled) {
        LUCARNE_ASSIGN(lattice, choose_lattice(schema, options));
    }
    header.scale = lattice.scale;
    header.offset = lattice.offset;
    if (options.expected_points > std::numeric_limits<uint32_t>::max()) header.minor = 4;
    add_stations(header, info.stations);
    state_unit(path, header, info.metres_per_unit);

    const auto extra = extra_attributes(header, schema);
    LUCARNE_TRY(describe_extras(path, header, extra));
    target.schema = make_schema(header);
    target.converter = make_converter(schema, target.schema, extra, info.color_bits);
    return target;
}

}  // namespace lucarne::io::las
