#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <zstd.h>

#include "octree/codec/bits.h"

namespace lucarne::octree::codec {

/// How a column's numbers are stored. The values of the enumerators are part of the cache format
/// (octree/FORMAT.md).
enum class Method : uint8_t {
    constant = 0,
    packed = 1,      ///< each number in as many bits as the largest needs
    tokens = 2,      ///< each number as a token and extra bits
    differences = 3  ///< each number's difference to the previous one as a token and extra bits
};

/// The head of a column. Each number is base + step * k, where k is stored by the method.
struct ColumnHead {
    Method method = Method::constant;
    uint64_t base = 0, step = 1;
    uint8_t width = 0;  ///< packed: bits per k
    /// Tokens, differences: bytes of the tokens and of the extra bits.
    uint64_t plane_bytes = 0, extra_bytes = 0;

    /// Bytes of the body of a column of `count` numbers.
    uint64_t body_bytes(uint64_t count) const {
        return method == Method::packed ? (count * width + 7) / 8 : plane_bytes + extra_bytes;
    }
};

/// Writes columns of unsigned 64-bit numbers by the cheapest method.
class ColumnEncoder {
 public:
    ColumnEncoder();
    /// Appends one column's head and body. Overwrites `values`.
    void encode(std::vector<uint64_t>& values, std::vector<std::byte>& heads, std::vector<std::byte>& bodies);

 private:
    void encode_tokens(ColumnHead& head, std::span<const uint64_t> values, std::vector<std::byte>& bodies);
    std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context_;
    std::vector<std::byte> tokens_, compressed_, extra_;
};

/// Reads the next column's head and removes it from `rest`. Empty if the head is damaged or announces a body
/// larger than `rest`.
std::optional<ColumnHead> read_head(std::span<const std::byte>& rest, uint64_t count);

/// Reads the bodies of columns from untrusted bytes.
class ColumnDecoder {
 public:
    ColumnDecoder();
    /// `body` must have the size that the head gives and be followed by kReadAhead readable bytes. Returns
    /// false if it is damaged.
    bool decode(const ColumnHead& head, std::span<const std::byte> body, size_t count,
                std::vector<uint64_t>& values);

 private:
    bool decode_tokens(const ColumnHead& head, std::span<const std::byte> body, std::span<uint64_t> values);
    std::unique_ptr<ZSTD_DCtx, size_t (*)(ZSTD_DCtx*)> context_;
    std::vector<uint8_t> tokens_;
};

}  // namespace lucarne::octree::codec
