// Converts columns of bits to records.
#include <algorithm>
#include <cmath>

#include "io/formats/common/format.h"
#include "io/formats/e57/layout.h"

namespace lucarne::io::e57 {
namespace {

using Column = std::array<double, kBlockRecords>;

/// Calls `use(at)`, where at(i) returns the i-th value of a column in the type of its field.
template <class Use>
void with_values(const Field& field, const uint64_t* raw, const Use& use) {
    // Computed modulo 2^64: a sum beyond the range of the field gives an odd value, but no undefined
    // behaviour.
    const auto whole = [raw, minimum = static_cast<uint64_t>(field.minimum)](size_t i) {
        return static_cast<int64_t>(minimum + raw[i]);
    };
    switch (field.kind) {
        case Field::Kind::f32:
            return use([raw](size_t i) { return std::bit_cast<float>(static_cast<uint32_t>(raw[i])); });
        case Field::Kind::f64:
            return use([raw](size_t i) { return std::bit_cast<double>(raw[i]); });
        case Field::Kind::integer:
            return use(whole);
        case Field::Kind::scaled:
            return use([whole, scale = field.scale, offset = field.offset](size_t i) {
                return static_cast<double>(whole(i)) * scale + offset;
            });
        case Field::Kind::text:
            return;
    }
}

void to_doubles(const Field& field, const uint64_t* raw, size_t count, Column& out) {
    with_values(field, raw, [&](const auto& at) {
        for (size_t i = 0; i < count; ++i) out[i] = static_cast<double>(at(i));
    });
}

/// The records of a block that are kept, and where they are written.
struct Kept {
    std::array<uint16_t, kBlockRecords> rows;
    size_t count = 0;
    size_t stride = 0;
    std::byte* to = nullptr;
};

template <class T, class At>
void scatter(const Kept& kept, uint32_t offset, const At& at) {
    for (size_t k = 0; k < kept.count; ++k)
        store(kept.to + k * kept.stride + offset, static_cast<T>(at(kept.rows[k])));
}

template <class At>
void scatter_whole(const Kept& kept, const Target& target, const At& at) {
    switch (target.type) {
        case ScalarType::u8:
            return scatter<uint8_t>(kept, target.offset, at);
        case ScalarType::i8:
            return scatter<int8_t>(kept, target.offset, at);
        case ScalarType::u16:
            return scatter<uint16_t>(kept, target.offset, at);
        case ScalarType::i16:
            return scatter<int16_t>(kept, target.offset, at);
        case ScalarType::u32:
            return scatter<uint32_t>(kept, target.offset, at);
        case ScalarType::i32:
            return scatter<int32_t>(kept, target.offset, at);
        case ScalarType::u64:
            return scatter<uint64_t>(kept, target.offset, at);
        case ScalarType::i64:
            return scatter<int64_t>(kept, target.offset, at);
        case ScalarType::f32:
            return scatter<float>(kept, target.offset, at);
        case ScalarType::f64:
            return scatter<double>(kept, target.offset, at);
    }
}

/// Stores real numbers: as they are, or rounded and clamped for integer types.
template <class At>
void scatter_real(const Kept& kept, const Target& target, const At& at) {
    if (target.type == ScalarType::f32) return scatter<float>(kept, target.offset, at);
    if (target.type == ScalarType::f64) return scatter<double>(kept, target.offset, at);
    for (size_t k = 0; k < kept.count; ++k)
        store_scalar(target.type, kept.to + k * kept.stride + target.offset,
                     static_cast<double>(at(kept.rows[k])));
}

void write_target(const Scan& scan, const RecordReader& reader, const Target& target, const Kept& kept) {
    if (!target.field) return scatter_real(kept, target, [&](size_t) { return target.missing; });
    const Field& field = scan.fields[*target.field];
    with_values(field, reader.column(*target.field), [&](const auto& at) {
        if (target.gain != 1.0)
            scatter_real(kept, target, [&](size_t i) { return static_cast<double>(at(i)) * target.gain; });
        else if constexpr (std::is_same_v<decltype(at(0)), int64_t>)
            scatter_whole(kept, target, at);
        else
            scatter_real(kept, target, at);
    });
}

/// Computes the three coordinates of every record in the scan's own frame.
void find_positions(const Scan& scan, const ScanLayout& layout, const RecordReader& reader, size_t count,
                    std::array<Column, 3>& p) {
    for (size_t axis = 0; axis < 3; ++axis)
        to_doubles(scan.fields[layout.coordinates[axis]], reader.column(layout.coordinates[axis]), count,
                   p[axis]);
    if (layout.spherical)
        for (size_t i = 0; i < count; ++i) {  // ASTM E2807-11, 8.4.3: elevation is 0 at the horizon
            const double range = p[0][i], azimuth = p[1][i], elevation = p[2][i];
            p[0][i] = range * std::cos(elevation) * std::cos(azimuth);
            p[1][i] = range * std::cos(elevation) * std::sin(azimuth);
            p[2][i] = range * std::sin(elevation);
        }
}

bool at_origin(const std::array<Column, 3>& p, size_t i) {
    return p[0][i] == 0 && p[1][i] == 0 && p[2][i] == 0;
}

/// Moves points from the scan's own frame to the file's.
void move_positions(const Pose& pose, size_t count, std::array<Column, 3>& p) {
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 moved = pose.rotation * glm::dvec3(p[0][i], p[1][i], p[2][i]) + pose.translation;
        for (int axis = 0; axis < 3; ++axis) p[static_cast<size_t>(axis)][i] = moved[axis];
    }
}

void write_positions(const Schema& schema, const Scan& scan, const ScanLayout& layout,
                     const RecordReader& reader, const std::array<Column, 3>& p, const Kept& kept) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
        const auto at = [&](size_t i) { return p[axis][i]; };
        if (schema.position == PositionType::f64) scatter<double>(kept, 8 * axis, at);
        if (schema.position == PositionType::f32) scatter<float>(kept, 4 * axis, at);
        if (schema.position != PositionType::i32_scaled) continue;
        const size_t field = layout.coordinates[axis];
        const auto minimum = static_cast<uint64_t>(scan.fields[field].minimum);
        const uint64_t* raw = reader.column(field);
        scatter<int32_t>(kept, 4 * axis, [&](size_t i) { return static_cast<int64_t>(minimum + raw[i]); });
    }
}

void write_normals(const Schema& schema, const Scan& scan, const ScanLayout& layout,
                   const RecordReader& reader, size_t count, const Kept& kept) {
    std::array<Column, 3> n{};
    if (layout.normal)
        for (size_t axis = 0; axis < 3; ++axis)
            to_doubles(scan.fields[(*layout.normal)[axis]], reader.column((*layout.normal)[axis]), count,
                       n[axis]);
    if (layout.normal && layout.pose)
        for (size_t i = 0; i < count; ++i) {
            const glm::dvec3 turned = layout.pose->rotation * glm::dvec3(n[0][i], n[1][i], n[2][i]);
            for (int axis = 0; axis < 3; ++axis) n[static_cast<size_t>(axis)][i] = turned[axis];
        }
    const Attribute& attribute = *schema.find(names::normal);
    for (uint32_t axis = 0; axis < 3; ++axis) {
        const auto at = [&](size_t i) { return n[axis][i]; };
        const uint32_t offset = attribute.offset + axis * static_cast<uint32_t>(scalar_bytes(attribute.type));
        if (attribute.type == ScalarType::f32)
            scatter<float>(kept, offset, at);
        else
            scatter<double>(kept, offset, at);
    }
}

/// Colours that the file marks as invalid look like those of scans without colours.
void write_colors(const Scan& scan, const ScanLayout& layout, const RecordReader& reader, const Kept& kept) {
    for (const Target& target : layout.color) write_target(scan, reader, target, kept);
    if (!layout.color_invalid) return;
    with_values(
        scan.fields[*layout.color_invalid], reader.column(*layout.color_invalid), [&](const auto& at) {
            for (size_t k = 0; k < kept.count; ++k)
                if (at(kept.rows[k]) != 0)
                    for (const Target& target : layout.color)
                        store_scalar(target.type, kept.to + k * kept.stride + target.offset, target.missing);
        });
}

}  // namespace

double largest_color(const Scan& scan, RecordReader& reader, uint64_t most) {
    const auto fields = scan.find(kColorFields);
    double largest = 0;
    for (uint64_t done = 0; fields && done < most;) {
        const auto count = reader.read(kBlockRecords);
        if (!count || *count == 0) break;  // the pass over the points will report the error
        Column column;
        for (const size_t field : *fields) {
            to_doubles(scan.fields[field], reader.column(field), *count, column);
            for (size_t i = 0; i < *count; ++i)
                if (std::isfinite(column[i])) largest = std::max(largest, column[i]);
        }
        done += *count;
    }
    return largest;
}

size_t count_at_origin(const Scan& scan, const ScanLayout& layout, const RecordReader& reader, size_t count) {
    std::array<Column, 3> p;
    find_positions(scan, layout, reader, count, p);
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) found += at_origin(p, i);
    return found;
}

Converted convert_block(const Schema& schema, const Scan& scan, const ScanLayout& layout,
                        const RecordReader& reader, size_t count, std::byte* to) {
    std::array<Column, 3> p;
    Column states;
    std::array<bool, kBlockRecords> missed{};
    find_positions(scan, layout, reader, count, p);
    if (layout.zero_is_missed)
        for (size_t i = 0; i < count; ++i) missed[i] = at_origin(p, i);
    if (layout.pose) move_positions(*layout.pose, count, p);
    if (layout.invalid)
        to_doubles(scan.fields[*layout.invalid], reader.column(*layout.invalid), count, states);
    Kept kept;
    kept.stride = schema.stride;
    kept.to = to;
    Converted done;
    for (size_t i = 0; i < count; ++i) {
        const bool valid = !layout.invalid || states[i] == 0;
        const bool good = valid && !missed[i] && usable(p[0][i]) && usable(p[1][i]) && usable(p[2][i]);
        done.invalid += !valid;
        done.missed += valid && missed[i];
        kept.rows[kept.count] = static_cast<uint16_t>(i);
        kept.count += good;
    }
    write_positions(schema, scan, layout, reader, p, kept);
    if (schema.find(names::color)) write_colors(scan, layout, reader, kept);
    if (schema.find(names::normal)) write_normals(schema, scan, layout, reader, count, kept);
    for (const Target& target : layout.targets) write_target(scan, reader, target, kept);
    done.kept = kept.count;
    return done;
}

}  // namespace lucarne::io::e57
