#include "io/formats/las/laz/encoder.h"

namespace lucarne::io::laz {

/// Adds one to the number that the bytes form. Some byte can take the carry, because the number, as a
/// fraction, is below one.
void Encoder::carry() {
    auto at = bytes_.rbegin();
    for (; at != bytes_.rend() && *at == std::byte{255}; ++at) *at = std::byte{0};
    if (at != bytes_.rend()) *at = static_cast<std::byte>(static_cast<uint8_t>(*at) + 1);
}

std::vector<std::byte> Encoder::finish() {
    // Chooses a number inside the last interval. The longer the interval, the fewer bytes it takes.
    const bool long_interval = length_ > 2 * kLeastLength;
    const uint32_t into = long_interval ? kLeastLength : kLeastLength / 2;
    narrow(into, into + (long_interval ? kLeastLength / 2 : kLeastLength >> 9));
    // A decoder reads four bytes ahead.
    bytes_.resize(bytes_.size() + (long_interval ? 3 : 2));
    return std::move(bytes_);
}

}  // namespace lucarne::io::laz
