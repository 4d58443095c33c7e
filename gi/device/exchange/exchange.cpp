#include "gi/device/exchange/exchange.h"

#include <algorithm>
#include <vector>

namespace lucarne::gi {
namespace {

constexpr size_t kPiece = size_t{16} << 20;  ///< bytes in host memory at a time

}  // namespace

Result<void> copy_to_cl(const Buffer& from, size_t bytes, ClDevice& device, ClBuffer& to,
                        std::string_view what) {
    LUCARNE_TRY(device.reserve(to, bytes, what));
    std::vector<std::byte> piece(std::min(bytes, kPiece));
    for (size_t at = 0; at < bytes; at += kPiece) {
        const std::span<std::byte> part(piece.data(), std::min(kPiece, bytes - at));
        from.download(at, part);
        LUCARNE_TRY(to.upload(at, part));
    }
    return {};
}

Result<void> copy_to_gl(const ClBuffer& from, size_t bytes, Device& device, Buffer& to,
                        std::string_view what) {
    LUCARNE_TRY(device.reserve(to, bytes, what));
    std::vector<std::byte> piece(std::min(bytes, kPiece));
    for (size_t at = 0; at < bytes; at += kPiece) {
        const std::span<std::byte> part(piece.data(), std::min(kPiece, bytes - at));
        LUCARNE_TRY(from.download(at, part));
        to.upload(at, part);
    }
    return {};
}

}  // namespace lucarne::gi
