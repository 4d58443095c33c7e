#pragma once

#include <array>
#include <memory>
#include <span>

#include "io/formats/las/laz/gps_time.h"
#include "io/formats/las/laz/point10.h"

namespace lucarne::io::laz {

inline constexpr size_t kChannels = 4;

/// A part of the points that is coded separately. If a layer is left out, nothing in it changes within the
/// chunk.
template <class Coder>
struct Layer {
    Coder coder;
    bool changes = false;
};

/// The 30 bytes that point formats 6 to 8 share, in nine layers, with models for each scanner channel (LASzip
/// item POINT14, versions 3 and 4). The same code encodes and decodes: a decoder returns what an encoder was
/// given.
template <class Coder>
class Point14Coder {
 public:
    static constexpr size_t kBytes = 30;
    static constexpr size_t kLayers = 9;

    Point14Coder(const std::byte* first, std::span<Layer<Coder>, kLayers> layers);
    /// Reads or writes the next record.
    void code(std::byte* record);
    uint32_t channel() const { return current_; }       ///< of the last coded point
    bool channel_changed() const { return switched_; }  ///< at the last coded point

 private:
#pragma pack(push, 1)
    struct Point {
        int32_t x, y, z;
        uint16_t intensity;
        uint8_t returns;  ///< return number, then number of returns << 4
        uint8_t flags;    ///< class flags, then channel << 4, direction << 6, edge << 7
        uint8_t classification, user_data;
        int16_t scan_angle;
        uint16_t point_source;
        uint64_t time;

        uint32_t number() const { return returns & 15u; }
        uint32_t count() const { return returns >> 4; }
        uint32_t channel() const { return flags >> 4 & 3u; }
        uint32_t other_flags() const { return (flags & 15u) | (flags >> 6) << 4; }
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
    uint32_t changes(const Point& next) const;
    void code_returns(Channel& channel, const Point& next, uint32_t changed, bool time_changes);
    void code_place(Channel& channel, const Point& next, bool time_changes);
    void code_class_and_flags(Channel& channel, const Point& next, uint32_t place);
    void code_rest(Channel& channel, const Point& next, uint32_t changed, bool time_changes);
    /// Returns the layer if it is coded, otherwise null. An encoder codes every layer and notes whether
    /// anything changes.
    Layer<Coder>* layer(size_t index, bool changes);

    std::span<Layer<Coder>, kLayers> layers_;
    std::array<std::unique_ptr<Channel>, kChannels> channels_;
    uint32_t current_;
    bool switched_ = false;
};

extern template class Point14Coder<Decoder>;
extern template class Point14Coder<Encoder>;

}  // namespace lucarne::io::laz
