#pragma once

#include <memory>

#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

/// The points of one chunk, any number at a time, as records of a LAS file. Thread-safe against other chunks.
class ChunkDecoder {
 public:
    /// `bytes` is the whole chunk, kept by the caller. Errors: a chunk that is cut off or contradicts itself.
    static Result<ChunkDecoder> create(const std::string& file, const Compression& compression,
                                       uint64_t points, std::span<const std::byte> bytes);
    ChunkDecoder(ChunkDecoder&&) noexcept;
    ChunkDecoder& operator=(ChunkDecoder&&) noexcept;
    ~ChunkDecoder();

    /// The next `count` records, one after the other. Errors: bytes that end before the points do.
    Result<void> decode(uint64_t count, std::byte* records);
    /// After the last point: how many of the bytes were the chunk.
    uint64_t consumed() const;
    /// After the last point: whether its code ended just where the chunk does. Where it does not, something
    /// in between was read wrongly.
    bool ends_well() const;

 private:
    struct State;
    explicit ChunkDecoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// About the memory of a chunk's models while it is decoded, at most.
uint64_t model_bytes(const Compression& compression);

/// What a layered chunk says of itself, in its first layered_head_bytes.
struct LayeredSize {
    uint64_t points = 0, bytes = 0;
};
size_t layered_head_bytes(const Compression& compression);
/// Errors: `head` is cut off.
Result<LayeredSize> layered_size(const std::string& file, const Compression& compression,
                                 std::span<const std::byte> head);

}  // namespace lucarne::io::laz
