#include "viewer/flythrough/picture_change.h"

#include <algorithm>
#include <cmath>

namespace lucarne::viewer {

PictureChange change_between(std::span<const std::byte> before, std::span<const std::byte> now,
                             ImageSize size) {
    const size_t tiles_x = (size.width + kChangeTile - 1) / kChangeTile;
    const size_t tiles_y = (size.height + kChangeTile - 1) / kChangeTile;
    std::vector<double> sums(tiles_x * tiles_y, 0.0);
    double sum = 0;
    for (size_t y = 0; y < size.height; ++y)
        for (size_t x = 0; x < size.width; ++x) {
            const size_t at = 4 * (y * size.width + x);
            double square = 0;
            for (size_t channel = 0; channel < 3; ++channel) {
                const double difference =
                    (static_cast<double>(now[at + channel]) - static_cast<double>(before[at + channel])) /
                    255;
                square += difference * difference / 3;
            }
            sums[y / kChangeTile * tiles_x + x / kChangeTile] += square;
            sum += square;
        }
    PictureChange change;
    change.whole = std::sqrt(sum / (static_cast<double>(size.width) * size.height));
    for (size_t tile = 0; tile < sums.size(); ++tile) {
        const size_t wide = std::min(kChangeTile, size.width - tile % tiles_x * kChangeTile);
        const size_t high = std::min(kChangeTile, size.height - tile / tiles_x * kChangeTile);
        change.tile = std::max(change.tile, std::sqrt(sums[tile] / static_cast<double>(wide * high)));
    }
    return change;
}

}  // namespace lucarne::viewer
