#include "io/formats/las/laz/point14.h"

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

// The bits of "what changed": two for the return number (same, one more, one less, other), then one for each
// of the others.
enum : uint32_t {
    kNumber = 3,
    kCount = 4,
    kAngleChanges = 8,
    kTimeChanges = 16,
    kSourceChanges = 32,
    kChannelChanges = 64
};

/// Contexts of the steps in x and y, by number of returns and return number (part of the format).
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

/// Returns 1 for the first return, 2 for the last, 3 for both, 0 for others.
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
int32_t minus(int32_t a, int32_t b) {
    return static_cast<int32_t>(static_cast<uint32_t>(a) - static_cast<uint32_t>(b));
}

}  // namespace

template <class Coder>
Point14Coder<Coder>::Channel::Channel(const Point& first) : last(first), changed(eight_models(128)) {
    heights.fill(first.z);
    intensities.fill(first.intensity);
    time.start(first.time);
}

template <class Coder>
Point14Coder<Coder>::Point14Coder(const std::byte* first, std::span<Layer<Coder>, kLayers> layers)
    : layers_(layers) {
    Point point;
    std::memcpy(&point, first, kBytes);
    current_ = point.channel();
    channels_[current_] = std::make_unique<Channel>(point);
}

template <class Coder>
Layer<Coder>* Point14Coder<Coder>::layer(size_t index, bool changes) {
    Layer<Coder>& layer = layers_[index];
    if constexpr (Coder::kEncodes) layer.changes |= changes;
    return Coder::kEncodes || layer.changes ? &layer : nullptr;
}

template <class Coder>
uint32_t Point14Coder<Coder>::changes(const Point& next) const {
    const uint32_t channel = next.channel();
    const Point& last = channels_[channels_[channel] ? channel : current_]->last;
    const uint32_t up = (next.number() - last.number()) & 15;
    return (up == 0    ? 0u
            : up == 1  ? 1u
            : up == 15 ? 2u
                       : kNumber) |
           (next.count() != last.count() ? kCount : 0u) |
           (next.scan_angle != last.scan_angle ? kAngleChanges : 0u) |
           (next.time != last.time ? kTimeChanges : 0u) |
           (next.point_source != last.point_source ? kSourceChanges : 0u) |
           (channel != current_ ? kChannelChanges : 0u);
}

template <class Coder>
void Point14Coder<Coder>::code(std::byte* record) {
    Point next{};
    uint32_t changed = 0;
    if constexpr (Coder::kEncodes) {
        std::memcpy(&next, record, kBytes);
        changed = changes(next);
    }
    Layer<Coder>& layer = layers_[kReturnsAndPlace];
    layer.changes = true;
    Channel* channel = channels_[current_].get();
    const uint32_t before = first_or_last(channel->last.number(), channel->last.count());
    changed = layer.coder.symbol(channel->changed[before + (channel->time_changed ? 4 : 0)], changed);
    switched_ = changed & kChannelChanges;
    if (switched_) {
        const uint32_t ahead = (next.channel() - current_ - 1) % kChannels;
        const uint32_t other = (current_ + layer.coder.symbol(channel->other_channel, ahead) + 1) % kChannels;
        if (!channels_[other]) channels_[other] = std::make_unique<Channel>(channel->last);
        channel = channels_[other].get();
        current_ = other;
        channel->last.flags = static_cast<uint8_t>((channel->last.flags & ~0x30u) | other << 4);
    }
    const bool time_changes = changed & kTimeChanges;
    code_returns(*channel, next, changed, time_changes);
    code_place(*channel, next, time_changes);
    code_rest(*channel, next, changed, time_changes);
    channel->time_changed = time_changes;
    if constexpr (!Coder::kEncodes) std::memcpy(record, &channel->last, kBytes);
}

template <class Coder>
void Point14Coder<Coder>::code_returns(Channel& channel, const Point& next, uint32_t changed,
                                       bool time_changes) {
    Coder& coder = layers_[kReturnsAndPlace].coder;
    uint32_t count = channel.last.count(), number = channel.last.number();
    if (changed & kCount) count = coder.symbol(channel.count[count], next.count());
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
            number = time_changes
                         ? coder.symbol(channel.number[number], next.number())
                         : (number + 2 +
                            coder.symbol(channel.number_at_same_time, (next.number() - number - 2) & 15)) &
                               15;
    }
    channel.last.returns = static_cast<uint8_t>(number | count << 4);
}

template <class Coder>
void Point14Coder<Coder>::code_place(Channel& channel, const Point& next, bool time_changes) {
    Coder& coder = layers_[kReturnsAndPlace].coder;
    Point& last = channel.last;
    const uint32_t count = last.count(), number = last.number();
    const uint32_t single = count == 1;
    const size_t context = kReturnContext[count][number] * size_t{2} + (time_changes ? 1 : 0);
    const int32_t x_step =
        channel.dx.code(coder, channel.x_steps[context].get(), minus(next.x, last.x), single);
    channel.x_steps[context].add(x_step);
    const int32_t y_step = channel.dy.code(coder, channel.y_steps[context].get(), minus(next.y, last.y),
                                           single + even_up_to(channel.dx.k(), 20));
    channel.y_steps[context].add(y_step);
    last.x = plus(last.x, x_step);
    last.y = plus(last.y, y_step);
    if (auto* heights = layer(kHeight, next.z != last.z)) {
        const auto level = std::min<uint32_t>(count > number ? count - number : number - count, 7);
        const uint32_t k = (channel.dx.k() + channel.dy.k()) / 2;
        last.z = channel.heights[level] =
            channel.z.code(heights->coder, channel.heights[level], next.z, single + even_up_to(k, 18));
    }
}

template <class Coder>
void Point14Coder<Coder>::code_class_and_flags(Channel& channel, const Point& next, uint32_t place) {
    Point& last = channel.last;
    if (auto* classes = layer(kClassification, next.classification != last.classification)) {
        const size_t context = (last.classification & 31u) * 2u + (place == 3 ? 1u : 0u);
        last.classification =
            static_cast<uint8_t>(classes->coder.symbol(channel.classification[context], next.classification));
    }
    if (auto* layer_of_flags = layer(kFlags, next.other_flags() != last.other_flags())) {
        const uint32_t flags =
            layer_of_flags->coder.symbol(channel.flags[last.other_flags()], next.other_flags());
        last.flags = static_cast<uint8_t>((last.flags & 0x30u) | (flags & 15u) | (flags >> 4) << 6);
    }
}

template <class Coder>
void Point14Coder<Coder>::code_rest(Channel& channel, const Point& next, uint32_t changed,
                                    bool time_changes) {
    Point& last = channel.last;
    const uint32_t place = first_or_last(last.number(), last.count());
    code_class_and_flags(channel, next, place);
    if (auto* intensities = layer(kIntensity, next.intensity != last.intensity)) {
        uint16_t& expected = channel.intensities[place * 2 + (time_changes ? 1 : 0)];
        last.intensity = expected = static_cast<uint16_t>(
            channel.intensity.code(intensities->coder, expected, next.intensity, place));
    }
    if (changed & kAngleChanges)
        if (auto* angles = layer(kScanAngle, true))
            last.scan_angle = static_cast<int16_t>(
                channel.scan_angle.code(angles->coder, static_cast<uint16_t>(last.scan_angle),
                                        static_cast<uint16_t>(next.scan_angle), time_changes ? 1 : 0));
    if (auto* users = layer(kUserData, next.user_data != last.user_data))
        last.user_data =
            static_cast<uint8_t>(users->coder.symbol(channel.user_data[last.user_data / 4], next.user_data));
    if (changed & kSourceChanges)
        if (auto* sources = layer(kPointSource, true))
            last.point_source = static_cast<uint16_t>(
                channel.point_source.code(sources->coder, last.point_source, next.point_source));
    if (time_changes)
        if (auto* times = layer(kTime, true)) last.time = channel.time.code(times->coder, next.time);
}

template class Point14Coder<Decoder>;
template class Point14Coder<Encoder>;

}  // namespace lucarne::io::laz
