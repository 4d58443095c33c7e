#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <zstd.h>

#include "octree/codec/bits.h"

namespace lucarne::octree::codec {

/// How a column's numbers are stored; the numbers are part of the cache format (octree/FORMAT.md).
enum class Method : uint8_t {
    constant = 0,
    packed = 1,      ///< each in as many bits as the largest needs
    tokens = 2,      ///< each as a token and extra bits
    differences = 3  ///< the same of each number's difference to the one before
};

/// What stands before a column's numbers: each is base + step * k, k stored by the method.
struct ColumnHead {
    Method method = Method::constant;
    uint64_t base = 0, step = 1;
    uint8_t width = 0;                          ///< packed: bits of each k
    uint64_t plane_bytes = 0, extra_bytes = 0;  ///< tokens, differences: of the tokens and of the extra bits

    /// What follows the heads for this column of `count` numbers.
    uint64_t body_bytes(uint64_t count) const {
        return method == Method::packed ? (count * width + 7) / 8 : plane_bytes + extra_bytes;
    }
};

/// Writes columns of unsigned 64-bit numbers by the method that takes least.
class ColumnEncoder {
 public:
    ColumnEncoder();
    /// Appends one column's head and body; overwrites `values`.
    void encode(std::vector<uint64_t>& values, std::vector<std::byte>& heads, std::vector<std::byte>& bodies);

 private:
    void encode_tokens(ColumnHead& head, std::span<const uint64_t> values, std::vector<std::byte>& bodies);
    std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context_;
    std::vector<std::byte> tokens_, compressed_, extra_;
};

/// Reads the next column's head and removes it from `rest`. Empty where it is damaged or promises a body that
/// is larger than `rest`.
std::optional<ColumnHead> read_head(std::span<const std::byte>& rest, uint64_t count);

/// Reads the bodies of columns and believes nothing.
class ColumnDecoder {
 public:
    ColumnDecoder();
    /// `body` has the head's size and is followed by kReadAhead readable bytes. False where it is damaged.
    bool decode(const ColumnHead& head, std::span<const std::byte> body, size_t count,
                std::vector<uint64_t>& values);

 private:
    bool decode_tokens(const ColumnHead& head, std::span<const std::byte> body, std::span<uint64_t> values);
    std::unique_ptr<ZSTD_DCtx, size_t (*)(ZSTD_DCtx*)> context_;
    std::vector<uint8_t> tokens_;
};

}  // namespace lucarne::octree::codec
