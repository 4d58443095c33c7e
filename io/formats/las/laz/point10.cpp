#include "io/formats/las/laz/point10.h"

#include <cstring>

namespace lucarne::io::laz {
namespace {

/// Each valid pair of number of returns and return number has a context of its own; the invalid pairs share
/// contexts (part of the format).
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

int32_t plus(int32_t a, int32_t b) {  // wraps
    return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}
int32_t minus(int32_t a, int32_t b) {
    return static_cast<int32_t>(static_cast<uint32_t>(a) - static_cast<uint32_t>(b));
}

}  // namespace

template <class Coder>
void Point10Coder<Coder>::start(const std::byte* first) {
    std::memcpy(&last_, first, kBytes);
    last_.intensity = 0;
}

template <class Coder>
uint32_t Point10Coder<Coder>::changes(const Point& next) const {
    const uint32_t context = kReturnContext[next.returns >> 3 & 7][next.returns & 7];
    return (next.returns != last_.returns ? kReturns : 0u) |
           (next.intensity != intensities_[context] ? kIntensity : 0u) |
           (next.classification != last_.classification ? kClassification : 0u) |
           (next.scan_angle != last_.scan_angle ? kScanAngle : 0u) |
           (next.user_data != last_.user_data ? kUserData : 0u) |
           (next.point_source != last_.point_source ? kPointSource : 0u);
}

template <class Coder>
void Point10Coder<Coder>::code(Coder& coder, std::byte* record) {
    Point next{};
    uint32_t changed = 0;
    if constexpr (Coder::kEncodes) {
        std::memcpy(&next, record, kBytes);
        changed = changes(next);
    }
    changed = coder.symbol(changed_, changed);
    if (changed & kReturns)
        last_.returns = static_cast<uint8_t>(coder.symbol(returns_[last_.returns], next.returns));
    const uint32_t context = kReturnContext[last_.returns >> 3 & 7][last_.returns & 7];
    if (changed) {
        if (changed & kIntensity)
            intensities_[context] = static_cast<uint16_t>(
                intensity_.code(coder, intensities_[context], next.intensity, context < 3 ? context : 3));
        last_.intensity = intensities_[context];
        code_changed(coder, next, changed);
    }
    code_place(coder, next, context);
    if constexpr (!Coder::kEncodes) std::memcpy(record, &last_, kBytes);
}

template <class Coder>
void Point10Coder<Coder>::code_place(Coder& coder, const Point& next, uint32_t context) {
    const uint32_t number = last_.returns & 7, count = last_.returns >> 3 & 7, single = count == 1;
    const int32_t x_step = dx_.code(coder, x_steps_[context].get(), minus(next.x, last_.x), single);
    x_steps_[context].add(x_step);
    const int32_t y_step =
        dy_.code(coder, y_steps_[context].get(), minus(next.y, last_.y), single + even_up_to(dx_.k(), 20));
    y_steps_[context].add(y_step);
    int32_t& height = heights_[count > number ? count - number : number - count];
    height = z_.code(coder, height, next.z, single + even_up_to((dx_.k() + dy_.k()) / 2, 18));
    last_.x = plus(last_.x, x_step);
    last_.y = plus(last_.y, y_step);
    last_.z = height;
}

template <class Coder>
void Point10Coder<Coder>::code_changed(Coder& coder, const Point& next, uint32_t changed) {
    if (changed & kClassification)
        last_.classification =
            static_cast<uint8_t>(coder.symbol(classification_[last_.classification], next.classification));
    if (changed & kScanAngle) {
        const uint32_t off = static_cast<uint8_t>(next.scan_angle - last_.scan_angle);
        last_.scan_angle =
            static_cast<uint8_t>(last_.scan_angle + coder.symbol(scan_angle_[last_.returns >> 6 & 1], off));
    }
    if (changed & kUserData)
        last_.user_data = static_cast<uint8_t>(coder.symbol(user_data_[last_.user_data], next.user_data));
    if (changed & kPointSource)
        last_.point_source =
            static_cast<uint16_t>(point_source_.code(coder, last_.point_source, next.point_source));
}

template class Point10Coder<Decoder>;
template class Point10Coder<Encoder>;

}  // namespace lucarne::io::laz
