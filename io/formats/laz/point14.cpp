#include "io/formats/laz/point14.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace lucarne::io::laz {
namespace {

enum LayerIndex {
    kReturnsAndPlace,
    kHeight,
    kClassification,
    kFlags,
    kIntensity,
    kScanAngle,
    kUserData,
    kPointSource,
    kTime
};

// What changed: two bits for the return number (same, one more, one less, other), then one each.
enum : uint32_t {
    kNumber = 3,
    kCount = 4,
    kAngleChanges = 8,
    kTimeChanges = 16,
    kSourceChanges = 32,
    kChannelChanges = 64
};

/// Contexts of the steps in x and y by number of returns and return number (part of the format).
constexpr uint8_t kReturnContext[16][16] = {
    {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
    {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5},
};

uint32_t even_up_to(uint32_t k, uint32_t most) {
    return k < most ? k & ~1u : most;
}

/// 1: the first return, 2: the last, 3: both.
uint32_t first_or_last(uint32_t number, uint32_t count) {
    return (number == 1 ? 1u : 0u) + (number >= count ? 2u : 0u);
}

std::array<SymbolModel, 8> eight_models(uint32_t symbols) {
    const SymbolModel m(symbols);
    return {m, m, m, m, m, m, m, m};
}

int32_t plus(int32_t a, int32_t b) {  // wraps
    return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}

}  // namespace

Point14Decoder::Channel::Channel(const Point& first) : last(first), changed(eight_models(128)) {
    heights.fill(first.z);
    intensities.fill(first.intensity);
    time.start(first.time);
}

Point14Decoder::Point14Decoder(const std::byte* first, std::span<Layer, kLayers> layers) : layers_(layers) {
    Point point;
    std::memcpy(&point, first, kBytes);
    current_ = point.flags >> 4 & 3;
    channels_[current_] = std::make_unique<Channel>(point);
}

uint32_t Point14Decoder::decode(std::byte* record) {
    Decoder& decoder = layers_[kReturnsAndPlace].decoder;
    Channel* channel = channels_[current_].get();
    const uint32_t before = first_or_last(channel->last.number(), channel->last.count());
    const uint32_t changed = decoder.symbol(channel->changed[before + (channel->time_changed ? 4 : 0)]);
    if (changed & kChannelChanges) {
        const uint32_t next = (current_ + decoder.symbol(channel->other_channel) + 1) % kChannels;
        if (!channels_[next]) channels_[next] = std::make_unique<Channel>(channel->last);
        channel = channels_[next].get();
        current_ = next;
        channel->last.flags = static_cast<uint8_t>((channel->last.flags & ~0x30u) | next << 4);
    }
    const bool time_changes = changed & kTimeChanges;
    decode_returns(*channel, changed, time_changes);
    decode_place(*channel, time_changes);
    decode_rest(*channel, changed, time_changes);
    channel->time_changed = time_changes;
    std::memcpy(record, &channel->last, kBytes);
    return current_;
}

void Point14Decoder::decode_returns(Channel& channel, uint32_t changed, bool time_changes) {
    Decoder& decoder = layers_[kReturnsAndPlace].decoder;
    uint32_t count = channel.last.count(), number = channel.last.number();
    if (changed & kCount) count = decoder.symbol(channel.count[count]);
    switch (changed & kNumber) {
        case 0:
            break;
        case 1:
            number = (number + 1) & 15;
            break;
        case 2:
            number = (number + 15) & 15;
            break;
        default:
            number = time_changes ? decoder.symbol(channel.number[number])
                                  : (number + 2 + decoder.symbol(channel.number_at_same_time)) & 15;
    }
    channel.last.returns = static_cast<uint8_t>(number | count << 4);
}

void Point14Decoder::decode_place(Channel& channel, bool time_changes) {
    Decoder& decoder = layers_[kReturnsAndPlace].decoder;
    Point& last = channel.last;
    const uint32_t count = last.count(), number = last.number();
    const uint32_t single = count == 1;
    const size_t context = kReturnContext[count][number] * size_t{2} + (time_changes ? 1 : 0);
    const int32_t x_step = channel.dx.code(decoder, channel.x_steps[context].get(), 0, single);
    channel.x_steps[context].add(x_step);
    const int32_t y_step =
        channel.dy.code(decoder, channel.y_steps[context].get(), 0, single + even_up_to(channel.dx.k(), 20));
    channel.y_steps[context].add(y_step);
    last.x = plus(last.x, x_step);
    last.y = plus(last.y, y_step);
    if (layers_[kHeight].changes) {
        const auto level = std::min<uint32_t>(count > number ? count - number : number - count, 7);
        const uint32_t k = (channel.dx.k() + channel.dy.k()) / 2;
        last.z = channel.heights[level] =
            channel.z.code(layers_[kHeight].decoder, channel.heights[level], 0, single + even_up_to(k, 18));
    }
}

void Point14Decoder::decode_rest(Channel& channel, uint32_t changed, bool time_changes) {
    Point& last = channel.last;
    const uint32_t place = first_or_last(last.number(), last.count());
    if (Layer& layer = layers_[kClassification]; layer.changes) {
        const size_t context = (last.classification & 31u) * 2u + (place == 3 ? 1u : 0u);
        last.classification = static_cast<uint8_t>(layer.decoder.symbol(channel.classification[context]));
    }
    if (Layer& layer = layers_[kFlags]; layer.changes) {
        const uint32_t flags =
            layer.decoder.symbol(channel.flags[(last.flags & 15u) | (last.flags >> 6) << 4]);
        last.flags = static_cast<uint8_t>((last.flags & 0x30u) | (flags & 15u) | (flags >> 4) << 6);
    }
    if (Layer& layer = layers_[kIntensity]; layer.changes) {
        uint16_t& expected = channel.intensities[place * 2 + (time_changes ? 1 : 0)];
        last.intensity = expected =
            static_cast<uint16_t>(channel.intensity.code(layer.decoder, expected, 0, place));
    }
    if (Layer& layer = layers_[kScanAngle]; layer.changes && (changed & kAngleChanges))
        last.scan_angle = static_cast<int16_t>(
            channel.scan_angle.code(layer.decoder, last.scan_angle, 0, time_changes ? 1 : 0));
    if (Layer& layer = layers_[kUserData]; layer.changes)
        last.user_data = static_cast<uint8_t>(layer.decoder.symbol(channel.user_data[last.user_data / 4]));
    if (Layer& layer = layers_[kPointSource]; layer.changes && (changed & kSourceChanges))
        last.point_source =
            static_cast<uint16_t>(channel.point_source.code(layer.decoder, last.point_source, 0));
    if (Layer& layer = layers_[kTime]; layer.changes && time_changes)
        last.time = channel.time.decode(layer.decoder);
}

}  // namespace lucarne::io::laz
