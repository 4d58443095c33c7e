#pragma once

#include <algorithm>
#include <array>

#include "io/formats/las/laz/models.h"

namespace lucarne::io::laz {

using Color = std::array<uint16_t, 3>;

/// Codes a colour relative to the previous one: which of its six bytes changed, and by how much. Green and
/// blue are predicted to change like red. (LASzip items RGB12 version 2 and RGB14.)
class ColorModel {
 public:
    template <class Coder>
    Color code(Coder& coder, const Color& last, const Color& value) {
        const uint32_t changed = coder.symbol(changed_, Coder::kEncodes ? changes(last, value) : 0);
        const auto byte = [&](uint32_t place, int expected, int same, int actual) {
            if (!(changed >> place & 1)) return same;
            const auto off = static_cast<uint8_t>(actual - expected);
            return (expected + static_cast<int>(coder.symbol(off_[place], off))) & 255;
        };
        const auto clamped = [](int v) { return std::clamp(v, 0, 255); };
        const auto low = [](uint16_t v) { return v & 255; };
        const auto high = [](uint16_t v) { return v >> 8; };
        const int red_low = byte(0, low(last[0]), low(last[0]), low(value[0]));
        const int red_high = byte(1, high(last[0]), high(last[0]), high(value[0]));
        const auto red = static_cast<uint16_t>(red_low | red_high << 8);
        if (!(changed >> kNotGrey & 1)) return {red, red, red};
        std::array<int, 2> green{}, blue{};
        for (uint32_t half = 0; half < 2; ++half) {
            const auto part = [&](uint16_t v) { return half ? high(v) : low(v); };
            const int off = part(red) - part(last[0]);
            green[half] = byte(2 + half, clamped(off + part(last[1])), part(last[1]), part(value[1]));
            const int both = (off + green[half] - part(last[1])) / 2;
            blue[half] = byte(4 + half, clamped(both + part(last[2])), part(last[2]), part(value[2]));
        }
        return {red, static_cast<uint16_t>(green[0] | green[1] << 8),
                static_cast<uint16_t>(blue[0] | blue[1] << 8)};
    }

 private:
    static constexpr uint32_t kNotGrey = 6;

    static uint32_t changes(const Color& last, const Color& value) {
        uint32_t changed = value[0] != value[1] || value[0] != value[2] ? 1u << kNotGrey : 0;
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t off = last[i] ^ value[i];
            changed |= (off & 255 ? 1u : 0) << (2 * i) | (off >> 8 ? 1u : 0) << (2 * i + 1);
        }
        return changed;
    }

    SymbolModel changed_{128};
    std::array<SymbolModel, 6> off_ = {SymbolModel(256), SymbolModel(256), SymbolModel(256),
                                       SymbolModel(256), SymbolModel(256), SymbolModel(256)};
};

/// Codes the near infrared of RGBNIR14.
class NirModel {
 public:
    template <class Coder>
    uint16_t code(Coder& coder, uint16_t last, uint16_t value) {
        const uint32_t off = Coder::kEncodes ? static_cast<uint32_t>(last ^ value) : 0;
        const uint32_t changed = coder.symbol(changed_, (off & 255 ? 1u : 0) | (off >> 8 ? 2u : 0));
        uint32_t result = 0;
        for (uint32_t half = 0; half < 2; ++half) {
            const uint32_t before = last >> (8 * half) & 255, now = value >> (8 * half) & 255;
            const uint32_t found =
                changed >> half & 1 ? before + coder.symbol(off_[half], (now - before) & 255) : before;
            result |= (found & 255) << (8 * half);
        }
        return static_cast<uint16_t>(result);
    }

 private:
    SymbolModel changed_{4};
    std::array<SymbolModel, 2> off_ = {SymbolModel(256), SymbolModel(256)};
};

}  // namespace lucarne::io::laz
