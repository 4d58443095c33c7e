#include "io/formats/pcd/lzf.h"

#include <algorithm>

namespace lucarne::io::pcd {
namespace {
constexpr size_t kWindow = 8192;                  ///< the largest distance
constexpr uint64_t kBuffer = uint64_t{64} << 10;  ///< small, because many passes exist at the same time
}  // namespace

LzfInput::LzfInput(std::shared_ptr<const ByteSource> file, uint64_t begin, uint64_t end)
    : file_(file), end_(end), input_(std::move(file), begin, end, kBuffer) {
    at_.position = begin;
}

LzfInput::State LzfInput::state() const {
    State state = at_;
    state.position = input_.position();
    return state;
}

void LzfInput::go_to(const State& state) {
    at_ = state;
    input_ = BufferedInput(file_, state.position, end_, kBuffer);
}

Result<void> LzfInput::next_run() {
    LUCARNE_ASSIGN(const auto bytes, input_.peek(3));
    const auto byte = [&](size_t i) { return static_cast<uint32_t>(bytes[i]); };
    const auto ends_early = [&] { return rejected(input_.path(), "its compressed points end early"); };
    if (bytes.empty()) return ends_early();
    const uint32_t control = byte(0);
    if (control < 32) {
        at_.literals = control + 1;
        input_.skip(1);
        return {};
    }
    const size_t length = control >> 5 == 7 ? 3 : 2;
    if (bytes.size() < length) return ends_early();
    at_.copies = (control >> 5) + (length == 3 ? byte(1) : 0) + 2;
    at_.distance = ((control & 31) << 8 | byte(length - 1)) + 1;
    if (at_.distance > at_.decoded)
        return rejected(input_.path(), "its compressed points refer to what is before their beginning");
    input_.skip(length);
    return {};
}

Result<void> LzfInput::read(std::span<std::byte> out) {
    size_t done = 0;
    const auto put = [&](std::byte value) {
        out[done++] = value;
        at_.history[at_.decoded++ % kWindow] = value;
    };
    while (done < out.size()) {
        if (at_.literals > 0) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(at_.literals));
            if (bytes.empty()) return rejected(input_.path(), "its compressed points end early");
            const size_t count = std::min({bytes.size(), size_t{at_.literals}, out.size() - done});
            for (size_t i = 0; i < count; ++i) put(bytes[i]);
            input_.skip(count);
            at_.literals -= static_cast<uint32_t>(count);
        } else if (at_.copies > 0) {
            const auto count = static_cast<uint32_t>(std::min<size_t>(at_.copies, out.size() - done));
            for (uint32_t i = 0; i < count; ++i) put(at_.history[(at_.decoded - at_.distance) % kWindow]);
            at_.copies -= count;
        } else {
            LUCARNE_TRY(next_run());
        }
    }
    return {};
}

}  // namespace lucarne::io::pcd
