#include "octree/codec/column.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include "octree/codec/token.h"

namespace lucarne::octree::codec {
namespace {

// Zstandard's fastest level: tokens of noise have no matches to find; its Huffman coder does the work.
constexpr int kZstdLevel = 1;
/// Packed bits are read three times as fast as tokens, so they are used unless tokens take less than this
/// share of their size.
constexpr double kPackedBonus = 0.98;

/// Appends a number in LEB128: seven bits a byte, lowest first, the top bit set in all bytes but the last.
void put_number(uint64_t value, std::vector<std::byte>& out) {
    for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::byte>(value | 0x80));
    out.push_back(static_cast<std::byte>(value));
}

/// The greatest common divisor of all numbers; 0 if all are 0.
uint64_t common_step(std::span<const uint64_t> values) {
    uint64_t step = 0;
    for (const uint64_t v : values) {
        if (step == 1) break;
        const bool narrow = ((v | step) >> 32) == 0;  // a 32-bit division is several times as fast
        if (step == 0 || (narrow ? static_cast<uint32_t>(v) % static_cast<uint32_t>(step) : v % step) != 0)
            step = std::gcd(step, v);
    }
    return step;
}

/// Estimates the bits that tokens would take: Shannon's bound for the tokens, and the extra bits.
double token_cost(std::span<const uint64_t> values, bool differences) {
    std::array<uint32_t, 256> count{};
    uint64_t before = 0;
    for (const uint64_t v : values) {
        ++count[token_of(differences ? fold_sign(v - before) : v)];
        before = v;
    }
    const auto all = static_cast<double>(values.size());
    double bits = 0;
    for (uint32_t token = 0; token < count.size(); ++token)
        if (count[token] != 0) bits += count[token] * (kTokens.bits[token] + std::log2(all / count[token]));
    return bits;
}

}  // namespace

ColumnEncoder::ColumnEncoder() : context_(ZSTD_createCCtx(), ZSTD_freeCCtx) {
    if (!context_) throw std::bad_alloc();
}

void ColumnEncoder::encode(std::vector<uint64_t>& values, std::vector<std::byte>& heads,
                           std::vector<std::byte>& bodies) {
    ColumnHead head;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    head.base = values.empty() ? 0 : *least;
    if (!values.empty() && *most > head.base) {
        for (auto& v : values) v -= head.base;
        head.step = common_step(values);
        assert(head.step > 0);
        if (head.step > 1)
            for (auto& v : values) v /= head.step;
        head.width = static_cast<uint8_t>(std::bit_width(*most));
        const double packed = kPackedBonus * head.width * static_cast<double>(values.size());
        const double plain = token_cost(values, false), differences = token_cost(values, true);
        head.method = packed <= std::min(plain, differences) ? Method::packed
                      : plain <= differences                 ? Method::tokens
                                                             : Method::differences;
        if (head.method == Method::packed) {
            BitWriter bits(bodies);
            for (const uint64_t v : values) bits.put(v, head.width);
            bits.flush();
        } else {
            encode_tokens(head, values, bodies);
        }
    }
    heads.push_back(static_cast<std::byte>(head.method));
    put_number(head.base, heads);
    if (head.method == Method::constant) return;
    put_number(head.step, heads);
    if (head.method == Method::packed) {
        heads.push_back(static_cast<std::byte>(head.width));
    } else {
        put_number(head.plane_bytes, heads);
        put_number(head.extra_bytes, heads);
    }
}

void ColumnEncoder::encode_tokens(ColumnHead& head, std::span<const uint64_t> values,
                                  std::vector<std::byte>& bodies) {
    tokens_.resize(values.size());
    extra_.clear();
    BitWriter bits(extra_);
    uint64_t before = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        const uint64_t v = head.method == Method::differences ? fold_sign(values[i] - before) : values[i];
        before = values[i];
        const uint32_t token = token_of(v);
        tokens_[i] = static_cast<std::byte>(token);
        bits.put(v - kTokens.base[token], kTokens.bits[token]);
    }
    bits.flush();
    compressed_.resize(ZSTD_compressBound(tokens_.size()));
    const size_t bytes = ZSTD_compressCCtx(context_.get(), compressed_.data(), compressed_.size(),
                                           tokens_.data(), tokens_.size(), kZstdLevel);
    const bool smaller = ZSTD_isError(bytes) == 0 && bytes < tokens_.size();
    const std::span<const std::byte> plane =
        smaller ? std::span<const std::byte>(compressed_).first(bytes) : std::span<const std::byte>(tokens_);
    head.plane_bytes = plane.size();
    head.extra_bytes = extra_.size();
    bodies.insert(bodies.end(), plane.begin(), plane.end());
    bodies.insert(bodies.end(), extra_.begin(), extra_.end());
}

std::optional<ColumnHead> read_head(std::span<const std::byte>& rest, uint64_t count) {
    const auto byte = [&rest]() -> std::optional<uint8_t> {
        if (rest.empty()) return std::nullopt;
        const auto value = std::to_integer<uint8_t>(rest[0]);
        rest = rest.subspan(1);
        return value;
    };
    const auto number = [&byte](uint64_t& value) {
        value = 0;
        for (uint32_t shift = 0; shift < 64; shift += 7) {
            const auto next = byte();
            if (!next) return false;
            value |= uint64_t{*next & 0x7fu} << shift;
            if (*next < 0x80) return true;
        }
        return false;
    };
    ColumnHead head;
    const auto method = byte();
    if (!method || *method > static_cast<uint8_t>(Method::differences) || !number(head.base))
        return std::nullopt;
    head.method = static_cast<Method>(*method);
    if (head.method == Method::constant) return head;
    if (!number(head.step)) return std::nullopt;
    if (head.method == Method::packed) {
        const auto width = byte();
        if (!width || *width > 64) return std::nullopt;
        head.width = *width;
    } else if (!number(head.plane_bytes) || !number(head.extra_bytes) || head.plane_bytes > rest.size() ||
               head.extra_bytes > rest.size()) {
        return std::nullopt;
    }
    return head.body_bytes(count) <= rest.size() ? std::optional(head) : std::nullopt;
}

ColumnDecoder::ColumnDecoder() : context_(ZSTD_createDCtx(), ZSTD_freeDCtx) {
    if (!context_) throw std::bad_alloc();
}

bool ColumnDecoder::decode(const ColumnHead& head, std::span<const std::byte> body, size_t count,
                           std::vector<uint64_t>& values) {
    assert(body.size() == head.body_bytes(count));
    values.resize(count);
    if (head.method == Method::constant) {
        std::fill(values.begin(), values.end(), head.base);
        return true;
    }
    if (head.method == Method::packed) {
        BitReader bits(body.data());
        for (auto& v : values) v = head.base + head.step * bits.take(head.width);
        return true;
    }
    return decode_tokens(head, body, values);
}

bool ColumnDecoder::decode_tokens(const ColumnHead& head, std::span<const std::byte> body,
                                  std::span<uint64_t> values) {
    const auto plane = body.first(head.plane_bytes);
    const size_t count = values.size();
    tokens_.resize(count);
    if (plane.size() == count)
        std::copy_n(reinterpret_cast<const uint8_t*>(plane.data()), count, tokens_.data());
    else if (ZSTD_decompressDCtx(context_.get(), tokens_.data(), count, plane.data(), plane.size()) != count)
        return false;
    uint64_t needed = 0;
    for (const uint8_t token : tokens_) needed += kTokens.bits[token];
    if ((needed + 7) / 8 != head.extra_bytes) return false;
    BitReader bits(body.data() + head.plane_bytes);
    if (head.method == Method::differences) {
        uint64_t value = head.base;
        for (size_t i = 0; i < count; ++i) {
            const uint8_t token = tokens_[i];
            value += head.step * unfold_sign(kTokens.base[token] + bits.take(kTokens.bits[token]));
            values[i] = value;
        }
    } else {
        for (size_t i = 0; i < count; ++i) {
            const uint8_t token = tokens_[i];
            values[i] = head.base + head.step * (kTokens.base[token] + bits.take(kTokens.bits[token]));
        }
    }
    return true;
}

}  // namespace lucarne::octree::codec
