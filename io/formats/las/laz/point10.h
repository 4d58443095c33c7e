#pragma once

#include <array>
#include <memory>

#include "io/formats/las/laz/decoder.h"
#include "io/formats/las/laz/encoder.h"
#include "io/formats/las/laz/integers.h"
#include "io/formats/las/laz/median.h"

namespace lucarne::io::laz {

/// Models of which most files need only a few. Each is created when it is first used.
template <size_t kCount>
class SparseModels {
 public:
    explicit SparseModels(uint32_t symbols) : symbols_(symbols) {}
    SymbolModel& operator[](size_t i) {
        if (!models_[i]) models_[i] = std::make_unique<SymbolModel>(symbols_);
        return *models_[i];
    }

 private:
    uint32_t symbols_;
    std::array<std::unique_ptr<SymbolModel>, kCount> models_;
};

/// The 20 bytes that point formats 0 to 3 share (LASzip item POINT10, version 2).
template <class Coder>
class Point10Coder {
 public:
    static constexpr size_t kBytes = 20;

    void start(const std::byte* first);
    /// Reads or writes the next record.
    void code(Coder& coder, std::byte* record);

 private:
    struct Point {
        int32_t x, y, z;
        uint16_t intensity;
        uint8_t returns, classification, scan_angle, user_data;
        uint16_t point_source;
    };
    static_assert(sizeof(Point) == kBytes);
    /// Returns which fields differ from the last point's.
    uint32_t changes(const Point& next) const;
    void code_changed(Coder& coder, const Point& next, uint32_t changed);
    void code_place(Coder& coder, const Point& next, uint32_t context);

    Point last_{};
    std::array<Median5, 16> x_steps_, y_steps_;
    std::array<uint16_t, 16> intensities_{};
    std::array<int32_t, 8> heights_{};
    SymbolModel changed_{64};
    std::array<SymbolModel, 2> scan_angle_ = {SymbolModel(256), SymbolModel(256)};
    SparseModels<256> returns_{256}, classification_{256}, user_data_{256};
    IntegerModel intensity_{16, 4}, point_source_{16}, dx_{32, 2}, dy_{32, 22}, z_{32, 20};
};

}  // namespace lucarne::io::laz
