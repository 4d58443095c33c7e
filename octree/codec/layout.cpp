#include "octree/codec/layout.h"

#include <cassert>

namespace lucarne::octree::codec {
namespace {

using Kind = Column::Kind;
using io::load;
using io::store;

template <class Use>
void with_type(uint32_t bytes, const Use& use) {
    switch (bytes) {
        case 1:
            return use(uint8_t{});
        case 2:
            return use(uint16_t{});
        case 4:
            return use(uint32_t{});
        default:
            assert(bytes == 8);
            return use(uint64_t{});
    }
}

template <class T>
constexpr T kTop = static_cast<T>(T{1} << (8 * sizeof(T) - 1));

/// Returns the three bytes of normal_oct as one number.
uint32_t normal_word(const std::byte* at) {
    return load<uint16_t>(at) | static_cast<uint32_t>(load<uint8_t>(at + 2)) << 16;
}

[[maybe_unused]] bool fits(const Column& column, uint32_t stride) {
    const bool normal = column.kind == Kind::normal_low || column.kind == Kind::normal_high;
    return column.offset + (normal ? 3 : column.bytes) <= stride && column.green + column.bytes <= stride;
}

/// Converts a stored number to an unsigned one of the same order, and back.
template <class T>
T to_ordered(Kind kind, bool is_signed, T bits) {
    if (kind == Kind::real) return static_cast<T>(bits & kTop<T> ? ~bits : bits | kTop<T>);
    return is_signed ? static_cast<T>(bits ^ kTop<T>) : bits;
}
template <class T>
T from_ordered(Kind kind, bool is_signed, T value) {
    if (kind == Kind::real) return static_cast<T>(value & kTop<T> ? value ^ kTop<T> : ~value);
    return is_signed ? static_cast<T>(value ^ kTop<T>) : value;
}

void add_numbers(io::ScalarType type, uint32_t components, uint32_t offset, std::vector<Column>& columns) {
    using enum io::ScalarType;
    const auto bytes = static_cast<uint32_t>(io::scalar_bytes(type));
    const bool real = type == f32 || type == f64;
    const bool is_signed = type == i8 || type == i16 || type == i32 || type == i64;
    for (uint32_t i = 0; i < components; ++i)
        columns.push_back({real ? Kind::real : Kind::integer, offset + i * bytes, bytes, is_signed, 0});
}

}  // namespace

std::vector<Column> columns_of(const io::Schema& schema) {
    using enum io::ScalarType;
    std::vector<Column> columns;
    const auto position = schema.position == io::PositionType::i32_scaled ? i32
                          : schema.position == io::PositionType::f32      ? f32
                                                                          : f64;
    add_numbers(position, 3, 0, columns);
    for (const auto& a : schema.attributes) {
        const bool color = a.name == io::names::color && a.components == 3 && (a.type == u8 || a.type == u16);
        if (color) {
            const auto bytes = static_cast<uint32_t>(io::scalar_bytes(a.type));
            const uint32_t green = a.offset + bytes;
            columns.push_back({Kind::integer, green, bytes, false, 0});
            columns.push_back({Kind::difference, a.offset, bytes, false, green});
            columns.push_back({Kind::difference, a.offset + 2 * bytes, bytes, false, green});
        } else if (a.name == io::names::normal_oct && a.components == 3 && a.type == u8) {
            columns.push_back({Kind::normal_low, a.offset, 1, false, 0});
            columns.push_back({Kind::normal_high, a.offset, 1, false, 0});
        } else {
            add_numbers(a.type, a.components, a.offset, columns);
        }
    }
    return columns;
}

void gather(const Column& column, std::span<const std::byte> records, uint32_t stride,
            std::vector<uint64_t>& values) {
    assert(fits(column, stride) && records.size() % stride == 0);
    const size_t count = records.size() / stride;
    values.resize(count);
    if (count == 0) return;  // `records` may have no address to start from
    const std::byte* at = records.data() + column.offset;
    const auto each = [&](const auto& number) {
        for (size_t i = 0; i < count; ++i, at += stride) values[i] = number(at);
    };
    if (column.kind == Kind::normal_low)
        return each([](const std::byte* p) { return normal_word(p) & 0xfff; });
    if (column.kind == Kind::normal_high)
        return each([](const std::byte* p) { return normal_word(p) >> 12; });
    with_type(column.bytes, [&](auto type) {
        using T = decltype(type);
        if (column.kind == Kind::difference) {
            const ptrdiff_t green = static_cast<ptrdiff_t>(column.green) - column.offset;
            each([green](const std::byte* p) {
                return (uint64_t{1} << (8 * sizeof(T) % 64)) + load<T>(p) - load<T>(p + green);
            });
        } else {
            each([&](const std::byte* p) { return to_ordered(column.kind, column.is_signed, load<T>(p)); });
        }
    });
}

void scatter(const Column& column, std::span<const uint64_t> values, std::span<std::byte> records,
             uint32_t stride) {
    assert(fits(column, stride));
    assert(records.size() == values.size() * stride);
    if (values.empty()) return;  // `records` may have no address to start from
    std::byte* at = records.data() + column.offset;
    const auto each = [&](const auto& put) {
        for (const uint64_t value : values) {
            put(at, value);
            at += stride;
        }
    };
    const auto put_word = [](std::byte* p, uint32_t word) {
        store(p, static_cast<uint16_t>(word));
        store(p + 2, static_cast<uint8_t>(word >> 16));
    };
    if (column.kind == Kind::normal_low)
        return each([&](std::byte* p, uint64_t v) { put_word(p, static_cast<uint32_t>(v) & 0xfff); });
    if (column.kind == Kind::normal_high)
        return each([&](std::byte* p, uint64_t v) {
            put_word(p, (normal_word(p) & 0xfff) | (static_cast<uint32_t>(v) & 0xfff) << 12);
        });
    with_type(column.bytes, [&](auto type) {
        using T = decltype(type);
        if (column.kind == Kind::difference) {
            const ptrdiff_t green = static_cast<ptrdiff_t>(column.green) - column.offset;
            each([green](std::byte* p, uint64_t v) { store(p, static_cast<T>(v + load<T>(p + green))); });
        } else {
            each([&](std::byte* p, uint64_t v) {
                store(p, from_ordered(column.kind, column.is_signed, static_cast<T>(v)));
            });
        }
    });
}

}  // namespace lucarne::octree::codec
