#pragma once

#include <optional>
#include <vector>

#include "io/formats/las/laz/color.h"
#include "io/formats/las/laz/gps_time.h"
#include "io/formats/las/laz/point10.h"
#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

/// Point formats 0 to 3: the items of all points in one stream, point after point.
template <class Coder>
class PointWise {
 public:
    /// `first` is the first point, which stands uncompressed before the stream.
    PointWise(const Compression& compression, Coder coder, const std::byte* first)
        : coder_(std::move(coder)) {
        for (const ItemLayout& item : compression.items) {
            switch (item.item) {
                case Item::point10:
                    point_.start(first);
                    break;
                case Item::gps_time:
                    time_.emplace(true).start(load<uint64_t>(first));
                    break;
                case Item::color:
                    color_.emplace();
                    std::memcpy(last_color_.data(), first, sizeof last_color_);
                    break;
                default:
                    extra_.assign(item.bytes, SymbolModel(256));
                    last_extra_.assign(first, first + item.bytes);
            }
            first += item.bytes;
        }
    }

    /// Reads or writes the next record.
    void code(std::byte* record) {
        point_.code(coder_, record);
        record += Point10Coder<Coder>::kBytes;
        if (time_) {
            store(record, time_->code(coder_, load<uint64_t>(record)));
            record += sizeof(uint64_t);
        }
        if (color_) {
            Color next;
            std::memcpy(next.data(), record, sizeof next);
            last_color_ = color_->code(coder_, last_color_, next);
            std::memcpy(record, last_color_.data(), sizeof last_color_);
            record += sizeof last_color_;
        }
        for (size_t i = 0; i < extra_.size(); ++i) {
            const auto before = static_cast<uint32_t>(last_extra_[i]),
                       next = static_cast<uint32_t>(record[i]);
            record[i] = last_extra_[i] =
                static_cast<std::byte>(before + coder_.symbol(extra_[i], (next - before) & 255));
        }
    }
    Coder& coder() { return coder_; }

 private:
    Coder coder_;
    Point10Coder<Coder> point_;
    std::optional<GpsTimeModel> time_;
    std::optional<ColorModel> color_;
    Color last_color_{};
    std::vector<SymbolModel> extra_;
    std::vector<std::byte> last_extra_;
};

}  // namespace lucarne::io::laz
