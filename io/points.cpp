#include "io/points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucarne::io {
namespace {

constexpr std::array<std::string_view, 11> kNames = {"",    "u8",  "i8",  "u16", "i16", "u32",
                                                     "i32", "u64", "i64", "f32", "f64"};

template <class T>
void store_rounded(std::byte* at, double value) {
    using Limits = std::numeric_limits<T>;
    if (std::isnan(value)) value = 0;
    // The largest 64-bit integers are not exact as doubles, so compare before converting.
    const double rounded = std::nearbyint(value);
    if (rounded <= static_cast<double>(Limits::lowest())) return store<T>(at, Limits::lowest());
    if (rounded >= static_cast<double>(Limits::max())) return store<T>(at, Limits::max());
    store<T>(at, static_cast<T>(rounded));
}

}  // namespace

std::string_view scalar_name(ScalarType type) {
    return kNames[static_cast<size_t>(type)];
}

std::optional<ScalarType> scalar_type(std::string_view name) {
    const auto found = std::find(kNames.begin() + 1, kNames.end(), name);
    if (found == kNames.end()) return std::nullopt;
    return static_cast<ScalarType>(found - kNames.begin());
}

void Schema::add(std::string name, ScalarType type, uint32_t components) {
    // The stride is that of the position until the first attribute is added.
    const uint32_t at = attributes.empty() ? static_cast<uint32_t>(position_bytes(position)) : stride;
    attributes.push_back({std::move(name), type, components, at});
    stride = at + static_cast<uint32_t>(attributes.back().bytes());
}

const Attribute* Schema::find(std::string_view name) const {
    const auto found = std::find_if(attributes.begin(), attributes.end(),
                                    [&](const Attribute& a) { return a.name == name; });
    return found == attributes.end() ? nullptr : &*found;
}

double scalar_at(ScalarType type, const std::byte* at) {
    switch (type) {
        case ScalarType::u8:
            return load<uint8_t>(at);
        case ScalarType::i8:
            return load<int8_t>(at);
        case ScalarType::u16:
            return load<uint16_t>(at);
        case ScalarType::i16:
            return load<int16_t>(at);
        case ScalarType::u32:
            return load<uint32_t>(at);
        case ScalarType::i32:
            return load<int32_t>(at);
        case ScalarType::u64:
            return static_cast<double>(load<uint64_t>(at));
        case ScalarType::i64:
            return static_cast<double>(load<int64_t>(at));
        case ScalarType::f32:
            return load<float>(at);
        case ScalarType::f64:
            break;
    }
    return load<double>(at);
}

void store_scalar(ScalarType type, std::byte* at, double value) {
    switch (type) {
        case ScalarType::u8:
            return store_rounded<uint8_t>(at, value);
        case ScalarType::i8:
            return store_rounded<int8_t>(at, value);
        case ScalarType::u16:
            return store_rounded<uint16_t>(at, value);
        case ScalarType::i16:
            return store_rounded<int16_t>(at, value);
        case ScalarType::u32:
            return store_rounded<uint32_t>(at, value);
        case ScalarType::i32:
            return store_rounded<int32_t>(at, value);
        case ScalarType::u64:
            return store_rounded<uint64_t>(at, value);
        case ScalarType::i64:
            return store_rounded<int64_t>(at, value);
        case ScalarType::f32:
            return store(at, static_cast<float>(value));
        case ScalarType::f64:
            return store(at, value);
    }
}

void add_loss(Losses& losses, std::string_view what, uint64_t count) {
    if (count == 0) return;
    const auto known =
        std::find_if(losses.begin(), losses.end(), [&](const Loss& l) { return l.what == what; });
    if (known == losses.end())
        losses.push_back({std::string(what), count});
    else
        known->count += count;
}

void add_losses(Losses& losses, const Losses& more) {
    for (const Loss& loss : more) add_loss(losses, loss.what, loss.count);
}

Losses PointReader::losses() const {
    Losses losses;
    add_loss(losses, lost::no_number, dropped());
    return losses;
}

Result<void> PointSource::pick(std::span<const uint64_t>, PointBatch&) const {
    return failed(info().path, "its points can only be read one after the other");
}

Result<void> PointSource::front(size_t, size_t most, PointBatch& batch) const {
    LUCARNE_ASSIGN(const auto reader, open());
    batch.bytes.clear();
    batch.count = 0;
    return read_up_to(*reader, schema(), most, batch);
}

Result<void> read_up_to(PointReader& reader, const Schema& schema, size_t most, PointBatch& batch) {
    PointBatch more;
    while (batch.count < most) {
        LUCARNE_ASSIGN(const size_t count, reader.read(more, most - batch.count));
        if (count == 0) break;
        const auto end = more.bytes.begin() + static_cast<std::ptrdiff_t>(count * schema.stride);
        batch.bytes.insert(batch.bytes.end(), more.bytes.begin(), end);
        batch.count += count;
    }
    return {};
}

}  // namespace lucarne::io
