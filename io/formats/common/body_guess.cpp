#include "io/formats/common/body_guess.h"

#include <algorithm>
#include <cmath>

#include "io/core/log.h"
#include "io/formats/common/surplus.h"

namespace lucarne::io {
namespace {

constexpr uint64_t kSamples = 64;
constexpr uint64_t kFewest = 8;  ///< records; a body of fewer may have any length by chance

uint64_t bytes_of(std::span<const ScalarType> types, bool doubles) {
    uint64_t bytes = 0;
    for (const ScalarType type : types)
        bytes += doubles && type == ScalarType::f32 ? sizeof(double) : scalar_bytes(type);
    return bytes;
}

/// Reads some records of `length` bytes from all over the body.
Result<std::vector<std::vector<std::byte>>> sample(const ByteSource& file, const StatedBody& body,
                                                   uint64_t length) {
    std::vector<std::vector<std::byte>> records;
    const uint64_t samples = std::min(kSamples, body.count);
    for (uint64_t i = 0; i < samples; ++i) {
        const uint64_t index = samples > 1 ? i * (body.count - 1) / (samples - 1) : 0;
        records.emplace_back(static_cast<size_t>(length));
        LUCARNE_TRY(file.read_at(body.begin + index * length, records.back()));
    }
    return records;
}

template <class T>
T value_at(const std::vector<std::byte>& record, uint64_t offset, bool big_endian) {
    std::array<std::byte, sizeof(T)> bytes{};
    std::copy_n(record.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    return load<T>(bytes.data());
}

/// Returns whether this may be a coordinate: zero, or of a size that is neither absurdly small nor large.
bool usual(double value) {
    return value == 0 || (std::abs(value) >= 1e-9 && std::abs(value) <= 1e9);
}

/// Returns whether all coordinates of the sample are usual, if floats are doubles or are not.
bool all_usual(const StatedBody& body, const std::vector<std::vector<std::byte>>& records, bool doubles) {
    for (const size_t axis : body.axes) {
        const uint64_t offset = bytes_of(body.types.first(axis), doubles);
        const ScalarType type = body.types[axis];
        for (const auto& record : records) {
            const bool real = type == ScalarType::f32 || type == ScalarType::f64;
            const double value = !real ? 0
                                 : doubles || type == ScalarType::f64
                                     ? value_at<double>(record, offset, body.big_endian)
                                     : value_at<float>(record, offset, body.big_endian);
            if (!usual(value)) return false;
        }
    }
    return true;
}

bool same_padding(const std::vector<std::vector<std::byte>>& records, uint64_t length) {
    return std::ranges::all_of(records, [&](const auto& record) {
        return std::equal(record.begin() + static_cast<std::ptrdiff_t>(length), record.end(),
                          records[0].begin() + static_cast<std::ptrdiff_t>(length));
    });
}

/// Returns how many whole records follow those that are counted.
Result<uint64_t> more_records(const ByteSource& file, const StatedBody& body, uint64_t stated) {
    const uint64_t surplus = body.bytes - stated * body.count;
    if (surplus % stated != 0) return 0u;
    StatedBody rest = body;
    rest.begin += stated * body.count;
    rest.count = surplus / stated;
    LUCARNE_ASSIGN(const auto records, sample(file, rest, stated));
    const bool empty = std::ranges::all_of(records, [](const auto& record) {
        return std::ranges::all_of(record, [](std::byte b) { return b == std::byte{0}; });
    });
    return empty || !all_usual(rest, records, false) ? 0 : rest.count;
}

}  // namespace

Result<BodyGuess> guess_body(const ByteSource& file, const StatedBody& body) {
    const uint64_t stated = bytes_of(body.types, false), with_doubles = bytes_of(body.types, true);
    BodyGuess guess;
    const uint64_t length = body.count < kFewest || body.bytes % body.count ? 0 : body.bytes / body.count;
    if (length == with_doubles && with_doubles > stated) {
        LUCARNE_ASSIGN(const auto as_doubles, sample(file, body, with_doubles));
        LUCARNE_ASSIGN(const auto as_stated, sample(file, body, stated));
        guess.doubles = all_usual(body, as_doubles, true) && !all_usual(body, as_stated, false);
        if (guess.doubles) return guess;
    }
    // Structures are padded to the size of their largest member, or to that of vector registers.
    for (const uint64_t unit : {4, 8, 16}) {
        const uint64_t padded = (stated + unit - 1) / unit * unit;
        if (length != padded || padded == stated) continue;
        LUCARNE_ASSIGN(const auto records, sample(file, body, padded));
        if (!same_padding(records, stated) || !all_usual(body, records, false)) continue;
        guess.padding = static_cast<size_t>(padded - stated);
        return guess;
    }
    LUCARNE_ASSIGN(guess.more, more_records(file, body, stated));
    return guess;
}

Result<BodyGuess> fit_body(const ByteSource& file, const StatedBody& body, bool salvage) {
    const uint64_t stated = bytes_of(body.types, false);
    if (stated == 0 || body.bytes / stated < body.count || body.bytes == stated * body.count)
        return BodyGuess{};
    LUCARNE_ASSIGN(BodyGuess guess, guess_body(file, body));
    const std::string name = file.path().string();
    if (guess.doubles)
        log::warn("{}: its header states floats, but its points are doubles and are read as such", name);
    else if (guess.padding > 0)
        log::warn("{}: its points take {} bytes each instead of {}; the last {} of each are padding", name,
                  stated + guess.padding, stated, guess.padding);
    else if (guess.more == 0 || !salvage)
        warn_of_surplus(name, body.bytes - stated * body.count, guess.more);
    if (!salvage) guess.more = 0;
    return guess;
}

}  // namespace lucarne::io
