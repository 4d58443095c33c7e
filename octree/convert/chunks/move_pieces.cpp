#include "octree/convert/chunks/move_pieces.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "octree/cluster/rounds.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kStep = 256 << 10;  ///< bytes read at a time

/// Goes before the bytes in a message.
struct Head {
    uint64_t to = 0, bytes = 0;
};

auto not_whole() {
    return failed("the conversion", "has not got all data that another number of ranks left",
                  "convert without --resume");
}

}  // namespace

Result<void> move_pieces(Ranks& ranks, std::span<const MovedPiece> pieces, ScratchFile& file,
                         uint64_t expected, uint64_t memory) {
    uint64_t arrived = 0;
    const auto write = [&](size_t, std::span<const std::byte> bytes) -> Result<void> {
        while (bytes.size() >= sizeof(Head)) {
            Head head;
            std::memcpy(&head, bytes.data(), sizeof head);
            bytes = bytes.subspan(sizeof head);
            if (head.bytes > bytes.size() || head.to > expected || head.bytes > expected - head.to)
                return not_whole();
            LUCARNE_TRY(file.write_at(head.to, bytes.first(head.bytes)));
            bytes = bytes.subspan(head.bytes);
            arrived += head.bytes;
        }
        return {};
    };
    Rounds rounds(ranks, memory, write);
    std::vector<std::byte> buffer;
    for (const MovedPiece& piece : pieces)
        for (uint64_t done = 0; done < piece.bytes;) {
            if (ranks.stopped()) return failed("the conversion", "has failed on another rank");
            if (rounds.room(piece.rank) <= sizeof(Head)) {
                LUCARNE_TRY(rounds.next());
                continue;
            }
            const Head head{piece.to + done,
                            std::min({piece.bytes - done, kStep, rounds.room(piece.rank) - sizeof(Head)})};
            buffer.resize(head.bytes);
            LUCARNE_TRY(piece.from->read_at(piece.offset + done, buffer));
            rounds.add(piece.rank, std::as_bytes(std::span(&head, 1)));
            rounds.add(piece.rank, buffer);
            done += head.bytes;
        }
    LUCARNE_TRY(rounds.finish());
    return arrived == expected ? Result<void>() : not_whole();
}

}  // namespace lucarne::octree
