#pragma once

#include <array>
#include <memory>
#include <span>

#include "io/formats/laz/gps_time.h"
#include "io/formats/laz/point10.h"

namespace lucarne::io::laz {

inline constexpr size_t kChannels = 4;

/// A part of the points coded on its own; one that is empty says that nothing changes in the chunk.
struct Layer {
    Decoder decoder;
    bool changes = false;
};

/// The 30 bytes that point formats 6 to 8 share, in nine layers, with models for each scanner channel (LASzip
/// item POINT14, versions 3 and 4).
class Point14Decoder {
 public:
    static constexpr size_t kBytes = 30;
    static constexpr size_t kLayers = 9;

    Point14Decoder(const std::byte* first, std::span<Layer, kLayers> layers);
    /// Returns the scanner channel of the point: the other items' models follow it.
    uint32_t decode(std::byte* record);

 private:
#pragma pack(push, 1)
    struct Point {
        int32_t x, y, z;
        uint16_t intensity;
        uint8_t returns;  ///< number, then count << 4
        uint8_t flags;    ///< class flags, then channel << 4, direction << 6, edge << 7
        uint8_t classification, user_data;
        int16_t scan_angle;
        uint16_t point_source;
        uint64_t time;

        uint32_t number() const { return returns & 15u; }
        uint32_t count() const { return returns >> 4; }
    };
#pragma pack(pop)
    static_assert(sizeof(Point) == kBytes);

    struct Channel {
        explicit Channel(const Point& first);

        Point last;
        bool time_changed = false;
        std::array<SymbolModel, 8> changed;
        SymbolModel other_channel{3}, number_at_same_time{13};
        SparseModels<16> count{16}, number{16};
        std::array<Median5, 12> x_steps, y_steps;
        IntegerModel dx{32, 2}, dy{32, 22}, z{32, 20};
        std::array<int32_t, 8> heights;
        SparseModels<64> classification{256}, flags{64}, user_data{256};
        IntegerModel intensity{16, 4}, scan_angle{16, 2}, point_source{16};
        std::array<uint16_t, 8> intensities;
        GpsTimeModel time{false};
    };
    void decode_returns(Channel& channel, uint32_t changed, bool time_changes);
    void decode_place(Channel& channel, bool time_changes);
    void decode_rest(Channel& channel, uint32_t changed, bool time_changes);

    std::span<Layer, kLayers> layers_;
    std::array<std::unique_ptr<Channel>, kChannels> channels_;
    uint32_t current_;
};

}  // namespace lucarne::io::laz
