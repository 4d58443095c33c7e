#include "io/formats/laz/point10.h"

#include <cstdlib>
#include <cstring>

namespace lucarne::io::laz {
namespace {

/// A context for each pair of number of returns and return number that a sound file has; the others share
/// (part of the format).
constexpr uint8_t kReturnContext[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

enum : uint32_t {
    kPointSource = 1,
    kUserData = 2,
    kScanAngle = 4,
    kClassification = 8,
    kIntensity = 16,
    kReturns = 32
};

}  // namespace

void Point10Decoder::start(const std::byte* first) {
    std::memcpy(&last_, first, kBytes);
    last_.intensity = 0;
}

void Point10Decoder::decode(Decoder& decoder, std::byte* record) {
    const uint32_t changed = decoder.symbol(changed_);
    if (changed & kReturns) last_.returns = static_cast<uint8_t>(decoder.symbol(returns_[last_.returns]));
    const uint32_t number = last_.returns & 7, count = last_.returns >> 3 & 7;
    const uint32_t context = kReturnContext[count][number];
    if (changed) {
        if (changed & kIntensity)
            intensities_[context] = static_cast<uint16_t>(
                intensity_.code(decoder, intensities_[context], 0, context < 3 ? context : 3));
        last_.intensity = intensities_[context];
        decode_changed(decoder, changed);
    }

    const uint32_t single = count == 1;
    const int32_t x_step = dx_.code(decoder, x_steps_[context].get(), 0, single);
    x_steps_[context].add(x_step);
    const int32_t y_step = dy_.code(decoder, y_steps_[context].get(), 0, single + even_up_to(dx_.k(), 20));
    y_steps_[context].add(y_step);
    int32_t& height =
        heights_[static_cast<size_t>(std::abs(static_cast<int>(count) - static_cast<int>(number)))];
    height = z_.code(decoder, height, 0, single + even_up_to((dx_.k() + dy_.k()) / 2, 18));
    last_.x = static_cast<int32_t>(static_cast<uint32_t>(last_.x) + static_cast<uint32_t>(x_step));
    last_.y = static_cast<int32_t>(static_cast<uint32_t>(last_.y) + static_cast<uint32_t>(y_step));
    last_.z = height;
    std::memcpy(record, &last_, kBytes);
}

void Point10Decoder::decode_changed(Decoder& decoder, uint32_t changed) {
    if (changed & kClassification)
        last_.classification = static_cast<uint8_t>(decoder.symbol(classification_[last_.classification]));
    if (changed & kScanAngle)
        last_.scan_angle =
            static_cast<uint8_t>(last_.scan_angle + decoder.symbol(scan_angle_[last_.returns >> 6 & 1]));
    if (changed & kUserData)
        last_.user_data = static_cast<uint8_t>(decoder.symbol(user_data_[last_.user_data]));
    if (changed & kPointSource)
        last_.point_source = static_cast<uint16_t>(point_source_.code(decoder, last_.point_source, 0));
}

}  // namespace lucarne::io::laz
