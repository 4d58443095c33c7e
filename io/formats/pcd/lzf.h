#pragma once

#include <array>
#include <memory>
#include <optional>

#include "io/files/file.h"
#include "io/formats/common/buffered_input.h"

// LZF, the compression of PCD's binary_compressed. Source: Marc Lehmann, LibLZF, lzf_d.c. After a control
// byte c below 32, c + 1 literal bytes follow. Any other control byte is a back reference: its upper three
// bits, plus the next byte if they are 7, are the length - 2; its lower five bits and the next byte are the
// distance - 1, at most 8192 backwards.
namespace lucarne::io::pcd {

/// One pass over a compressed stream, from its beginning or from the state of another pass. Keeps only the
/// last 8 KiB of the decoded bytes, whatever the length.
class LzfInput {
 public:
    /// The stream is [begin, end) of the file.
    LzfInput(std::shared_ptr<const ByteSource> file, uint64_t begin, uint64_t end);

    /// The state of a pass.
    struct State {
        uint64_t position = 0;  ///< in the file
        std::array<std::byte, 8192> history{};
        uint64_t decoded = 0;                             ///< number of bytes decoded so far
        uint32_t literals = 0, copies = 0, distance = 0;  ///< of the unfinished run
    };
    State state() const;
    void go_to(const State& state);

    /// Decodes the next bytes. Errors: the stream ends before, or refers to bytes before its beginning.
    Result<void> read(std::span<std::byte> out);

 private:
    Result<void> next_run();

    std::shared_ptr<const ByteSource> file_;
    uint64_t end_;
    BufferedInput input_;
    State at_;
};

}  // namespace lucarne::io::pcd
