#include "io/formats/las/layout.h"

#include <algorithm>

#include "io/formats/common/format.h"
#include "io/formats/las/extras.h"

namespace lucarne::io::las {
namespace {

// Offsets of the tail in a LAS record and in a record of the schema.
constexpr size_t kLegacyTail = 20, kLegacyOutTail = 24;
constexpr size_t kExtendedTail = 22, kExtendedOutTail = 26;

struct Legacy {  // point formats 0-3, LAS 1.4 R15 table 7
    static constexpr size_t tail = kLegacyTail, out_tail = kLegacyOutTail;
    static void unpack(const std::byte* in, std::byte* out) {
        std::memcpy(out, in, 14);  // position, intensity
        const auto flags = load<uint8_t>(in + 14), classes = load<uint8_t>(in + 15);
        const uint8_t fields[] = {static_cast<uint8_t>(flags & 7),      static_cast<uint8_t>(flags >> 3 & 7),
                                  static_cast<uint8_t>(flags >> 6 & 1), static_cast<uint8_t>(flags >> 7),
                                  static_cast<uint8_t>(classes & 31),   static_cast<uint8_t>(classes >> 5)};
        std::memcpy(out + 14, fields, sizeof fields);
        std::memcpy(out + 20, in + 16, 4);  // scan angle rank, user data, point source id
    }
    /// Packs the bit fields. Returns the bits that did not fit.
    static unsigned pack(const std::byte* in, std::byte* out) {
        std::memcpy(out, in, 14);
        uint8_t f[6];
        std::memcpy(f, in + 14, sizeof f);
        store(out + 14, static_cast<uint8_t>((f[0] & 7) | (f[1] & 7) << 3 | (f[2] & 1) << 6 | f[3] << 7));
        store(out + 15, static_cast<uint8_t>((f[4] & 31) | f[5] << 5));
        std::memcpy(out + 16, in + 20, 4);
        return ((f[0] | f[1]) & ~7u) | ((f[2] | f[3]) & ~1u) | (f[4] & ~31u) | (f[5] & ~7u);
    }
};

struct Extended {  // point formats 6-8, LAS 1.4 R15 table 16
    static constexpr size_t tail = kExtendedTail, out_tail = kExtendedOutTail;
    static void unpack(const std::byte* in, std::byte* out) {
        std::memcpy(out, in, 14);
        const auto returns = load<uint8_t>(in + 14), flags = load<uint8_t>(in + 15);
        const uint8_t fields[] = {static_cast<uint8_t>(returns & 15),   static_cast<uint8_t>(returns >> 4),
                                  static_cast<uint8_t>(flags & 15),     static_cast<uint8_t>(flags >> 4 & 3),
                                  static_cast<uint8_t>(flags >> 6 & 1), static_cast<uint8_t>(flags >> 7)};
        std::memcpy(out + 14, fields, sizeof fields);
        std::memcpy(out + 20, in + 16, 6);  // classification, user data, scan angle, point source id
    }
    static unsigned pack(const std::byte* in, std::byte* out) {
        std::memcpy(out, in, 14);
        uint8_t f[6];
        std::memcpy(f, in + 14, sizeof f);
        store(out + 14, static_cast<uint8_t>((f[0] & 15) | f[1] << 4));
        store(out + 15, static_cast<uint8_t>((f[2] & 15) | (f[3] & 3) << 4 | (f[4] & 1) << 6 | f[5] << 7));
        std::memcpy(out + 16, in + 20, 6);
        return ((f[0] | f[1] | f[2]) & ~15u) | (f[3] & ~3u) | ((f[4] | f[5]) & ~1u);
    }
};

/// If `tail_bytes` is a constant, the compiler unrolls the copy.
template <class Kind>
void unpack_all(const std::byte* in, size_t in_stride, size_t count, std::byte* out, size_t out_stride,
                size_t tail_bytes) {
    for (; count-- > 0; in += in_stride, out += out_stride) {
        Kind::unpack(in, out);
        std::memcpy(out + Kind::out_tail, in + Kind::tail, tail_bytes);
    }
}

template <class Kind>
bool pack_all(const std::byte* in, size_t in_stride, size_t count, std::byte* out, size_t out_stride) {
    unsigned lost = 0;
    for (; count-- > 0; in += in_stride, out += out_stride) {
        lost |= Kind::pack(in, out);
        std::memcpy(out + Kind::tail, in + Kind::out_tail, out_stride - Kind::tail);
    }
    return lost == 0;
}

void unpack_records(uint8_t point_format, size_t stride, const std::byte* in, size_t count, std::byte* out,
                    size_t out_stride) {
    if (extended_format(point_format)) {
        const size_t tail = stride - Extended::tail;
        if (tail == 8) return unpack_all<Extended>(in, stride, count, out, out_stride, 8);
        if (tail == 14) return unpack_all<Extended>(in, stride, count, out, out_stride, 14);
        return unpack_all<Extended>(in, stride, count, out, out_stride, tail);
    }
    const size_t tail = stride - Legacy::tail;
    if (tail == 0) return unpack_all<Legacy>(in, stride, count, out, out_stride, 0);
    if (tail == 6) return unpack_all<Legacy>(in, stride, count, out, out_stride, 6);
    if (tail == 8) return unpack_all<Legacy>(in, stride, count, out, out_stride, 8);
    if (tail == 14) return unpack_all<Legacy>(in, stride, count, out, out_stride, 14);
    return unpack_all<Legacy>(in, stride, count, out, out_stride, tail);
}

/// Decodes record by record and leaves out the wave packet between the fields and the extra bytes.
void decode_around_waves(const Header& header, const std::byte* in, size_t count, std::byte* out,
                         size_t out_stride) {
    const size_t fields = record_bytes(header.point_format), wave = header.wave_bytes;
    const size_t stride = header.record_length, extra = stride - fields - wave;
    std::vector<std::byte> record(fields + extra);
    for (; count-- > 0; in += stride, out += out_stride) {
        std::memcpy(record.data(), in, fields);
        std::memcpy(record.data() + fields, in + fields + wave, extra);
        unpack_records(header.point_format, record.size(), record.data(), 1, out, out_stride);
    }
}

void add_core(Schema& schema, bool extended) {
    const auto u8 = [&](std::string_view name) { schema.add(std::string(name), ScalarType::u8); };
    schema.add(std::string(names::intensity), ScalarType::u16);
    u8(names::return_number);
    u8(names::number_of_returns);
    if (extended) {
        u8(names::class_flags);
        u8(names::scanner_channel);
    }
    u8(names::scan_direction);
    u8(names::edge_of_flight_line);
    u8(names::classification);
    if (extended) {
        u8(names::user_data);
        schema.add(std::string(names::scan_angle), ScalarType::i16);
    } else {
        u8(names::class_flags);
        schema.add(std::string(names::scan_angle_rank), ScalarType::i8);
        u8(names::user_data);
    }
    schema.add(std::string(names::point_source_id), ScalarType::u16);
}

/// Renames the field of this name among the first `fields` attributes: it only approximates an extra, which
/// gets the name.
void rename_field(Schema& schema, size_t fields, std::string_view name) {
    for (size_t i = 0; i < fields; ++i)
        if (schema.attributes[i].name == name)
            schema.attributes[i].name = unique_name(schema, std::string(kNearPrefix) + std::string(name));
}

void add_extra(Schema& schema, const Header& header) {
    const Schema fields = schema;
    size_t left = header.record_length - record_bytes(header.point_format) - header.wave_bytes;
    if (const Vlr* vlr = header.find(kSpecUser, kExtraBytesRecord)) {
        const auto entries = entries_of(vlr->data);
        for (size_t at = 0; left > 0 && at < entries.size(); at += kDescriptorBytes) {
            const auto descriptor = entries.subspan(at, kDescriptorBytes);
            if (descriptor[2] == std::byte{0} && descriptor[3] == std::byte{0}) continue;  // no bytes
            const auto type = extra_type(descriptor);
            if (!type || type->components * scalar_bytes(type->type) > left) break;
            if (is_normal(entries.subspan(at)) && 3 * scalar_bytes(type->type) <= left &&
                !schema.find(names::normal)) {
                schema.add(std::string(names::normal), type->type, 3);
                left -= schema.attributes.back().bytes();
                at += 2 * kDescriptorBytes;
                continue;
            }
            const ExtraName extra = name_of_extra(fields, descriptor);
            if (extra.original) rename_field(schema, fields.attributes.size(), extra.name);
            schema.add(unique_name(schema, extra.name), type->type, type->components);
            left -= schema.attributes.back().bytes();
        }
    }
    if (left > 0) schema.add(unique_name(schema, "extra_bytes"), ScalarType::u8, static_cast<uint32_t>(left));
}

}  // namespace

std::span<const std::byte> entries_of(std::span<const std::byte> record) {
    return record.first(std::min(record.size() / kDescriptorBytes, kMostEntries) * kDescriptorBytes);
}

std::optional<ExtraType> extra_type(std::span<const std::byte> descriptor) {
    // LAS 1.4 R15, table 24: types 1-10 are scalars; 11-20 and 21-30 (deprecated) are the same with two and
    // three components.
    constexpr std::array kTypes = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                   ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                   ScalarType::f32, ScalarType::f64};
    const auto type = std::to_integer<uint8_t>(descriptor[2]),
               options = std::to_integer<uint8_t>(descriptor[3]);
    if (type == 0 && options > 0) return ExtraType{ScalarType::u8, options};  // undocumented: `options` bytes
    if (type == 0 || type > 30) return std::nullopt;
    return ExtraType{kTypes[(type - 1u) % 10u], (type - 1u) / 10u + 1u};
}

std::string extra_name(std::span<const std::byte> descriptor) {
    const auto field = descriptor.subspan(4, 32);
    const auto end = std::find(field.begin(), field.end(), std::byte{0});
    return {reinterpret_cast<const char*>(field.data()), static_cast<size_t>(end - field.begin())};
}

Schema make_schema(const Header& header) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.scale = header.scale;
    schema.offset = header.offset;
    add_core(schema, extended_format(header.point_format));
    if (has_gps_time(header.point_format)) schema.add(std::string(names::gps_time), ScalarType::f64);
    if (has_color(header.point_format)) schema.add(std::string(names::color), ScalarType::u16, 3);
    if (header.point_format == 8) schema.add(std::string(names::nir), ScalarType::u16);
    add_extra(schema, header);
    return schema;
}

uint32_t largest_value(bool extended, std::string_view name) {
    if (name == names::return_number || name == names::number_of_returns) return extended ? 15 : 7;
    if (name == names::scan_direction || name == names::edge_of_flight_line) return 1;
    if (name == names::class_flags) return extended ? 15 : 7;
    if (name == names::classification) return extended ? 255 : 31;
    return name == names::scanner_channel ? 3 : UINT32_MAX;
}

void decode(const Header& header, const std::byte* in, size_t count, std::byte* out, size_t out_stride) {
    if (header.wave_bytes) return decode_around_waves(header, in, count, out, out_stride);
    unpack_records(header.point_format, header.record_length, in, count, out, out_stride);
}

bool encode(const Header& header, const std::byte* in, size_t in_stride, size_t count, std::byte* out) {
    if (extended_format(header.point_format))
        return pack_all<Extended>(in, in_stride, count, out, header.record_length);
    return pack_all<Legacy>(in, in_stride, count, out, header.record_length);
}

}  // namespace lucarne::io::las
