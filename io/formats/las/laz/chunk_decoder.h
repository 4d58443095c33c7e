#pragma once

#include <memory>
#include <optional>

#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

/// Decodes the points of one chunk to records of a LAS file, any number at a time. Different chunks can be
/// decoded by different threads.
class ChunkDecoder {
 public:
    /// `bytes` is the whole chunk; the caller must keep it. Errors: a chunk that is cut off or contradicts
    /// itself.
    static Result<ChunkDecoder> create(const std::string& file, const Compression& compression,
                                       uint64_t points, std::span<const std::byte> bytes);
    ChunkDecoder(ChunkDecoder&&) noexcept;
    ChunkDecoder& operator=(ChunkDecoder&&) noexcept;
    ~ChunkDecoder();

    /// Decodes the next `count` records, one after the other. Errors: the bytes end before the points do.
    Result<void> decode(uint64_t count, std::byte* records);
    /// Call after the last point. Returns how many of the bytes belong to the chunk.
    uint64_t consumed() const;
    /// Call after the last point. Returns whether the code ends exactly where the chunk does. If not,
    /// something in between was decoded wrongly.
    bool ends_well() const;

 private:
    struct State;
    explicit ChunkDecoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Returns how many points a point-wise chunk holds: the number nearest to `expected` after which the code
/// ends exactly where the chunk does. Nothing if there is no such number up to `most`: the chunk is damaged,
/// or its records take over 32 MiB.
std::optional<uint64_t> count_points(const Compression& compression, std::span<const std::byte> chunk,
                                     uint64_t most, uint64_t expected);

/// Returns an upper estimate of the memory for a chunk's models while it is decoded.
uint64_t model_bytes(const Compression& compression);

/// What a layered chunk says about itself in its first layered_head_bytes.
struct LayeredSize {
    uint64_t points = 0, bytes = 0;
};
size_t layered_head_bytes(const Compression& compression);
/// Errors: `head` is cut off.
Result<LayeredSize> layered_size(const std::string& file, const Compression& compression,
                                 std::span<const std::byte> head);

}  // namespace lucarne::io::laz
