#pragma once

#include <array>
#include <memory>
#include <optional>

#include "io/files/file.h"
#include "io/formats/common/buffered_input.h"

// LZF, as PCD's binary_compressed holds it. Source: Marc Lehmann, LibLZF, lzf_d.c: a control byte below 32 is
// followed by that many bytes + 1 as they are; else its upper three bits and, where these are 7, the next
// byte, are a length - 2, its lower five bits and the next byte a distance - 1 backwards, at most 8192.
namespace lucarne::io::pcd {

/// One pass over a compressed stream, from its beginning or from where another pass stood. Holds 8 KiB of
/// what it decoded, whatever the length.
class LzfInput {
 public:
    /// The stream is [begin, end) of the file.
    LzfInput(std::shared_ptr<const ByteSource> file, uint64_t begin, uint64_t end);

    /// Where a pass stands.
    struct State {
        uint64_t position = 0;  ///< in the file
        std::array<std::byte, 8192> history{};
        uint64_t decoded = 0;                             ///< bytes so far
        uint32_t literals = 0, copies = 0, distance = 0;  ///< of what is not all decoded yet
    };
    State state() const;
    void go_to(const State& state);

    /// The next bytes. Errors: the stream ends before, or points back further than its beginning.
    Result<void> read(std::span<std::byte> out);

 private:
    Result<void> next_run();

    std::shared_ptr<const ByteSource> file_;
    uint64_t end_;
    BufferedInput input_;
    State at_;
};

}  // namespace lucarne::io::pcd
