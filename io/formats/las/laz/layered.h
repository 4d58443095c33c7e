#pragma once

#include <optional>
#include <utility>

#include "io/formats/las/laz/color.h"
#include "io/formats/las/laz/point14.h"
#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

/// Models and last values of an item for each scanner channel. Two mistakes of LASzip are part of version 3
/// and are corrected in version 4. First, an item uses the models of channel 0 for every point whose channel
/// is the same as the previous point's. Second, when a known channel returns, the item continues from the
/// last values of the previous models.
template <class Models, class Last>
class Channels {
 public:
    Channels(uint16_t version, const Models& fresh, Last first, uint32_t channel)
        : fresh_(fresh), slips_(version < 4), current_(channel) {
        channels_[channel].emplace(fresh_, std::move(first));
    }
    struct Channel {
        Channel(const Models& m, Last l) : models(m), last(std::move(l)) {}
        Models models;
        Last last;
    };
    /// Returns the models for a point and the last values to continue from. `changed` says that the point's
    /// channel differs from the previous point's.
    std::pair<Models&, Last&> at(uint32_t channel, bool changed) {
        if (slips_ && !changed) channel = 0;
        Channel& before = *channels_[current_];
        current_ = channel;
        auto& now = channels_[channel];
        const bool fresh = !now;
        if (fresh) now.emplace(fresh_, before.last);
        return {now->models, slips_ && !fresh ? before.last : now->last};
    }

 private:
    Models fresh_;
    bool slips_;
    uint32_t current_;
    std::array<std::optional<Channel>, kChannels> channels_;
};

struct ColorNirModels {
    ColorModel color;
    NirModel nir;
};
struct ColorNir {
    Color color{};
    uint16_t nir = 0;
};
static_assert(sizeof(ColorNir) == 8);

/// Point formats 6 to 8: each attribute has layers of its own.
template <class Coder>
class Layered {
 public:
    /// `first` is the first point, which stands uncompressed before the layers.
    Layered(const Compression& compression, std::vector<Layer<Coder>> layers, const std::byte* first)
        : layers_(std::move(layers)),
          point_(first, std::span(layers_).template first<Point14Coder<Coder>::kLayers>()) {
        const uint32_t channel = load<uint8_t>(first + 15) >> 4 & 3;
        size_t layer = Point14Coder<Coder>::kLayers;
        for (const ItemLayout& item : compression.items) {
            if (item.item == Item::color14 || item.item == Item::color_nir14) {
                ColorNir value;
                std::memcpy(&value, first, item.bytes);
                color_.emplace(item.version, ColorNirModels{}, value, channel);
                color_bytes_ = item.bytes;
                color_layer_ = layer;
                layer += item.bytes == sizeof(ColorNir) ? 2 : 1;
            } else if (item.item == Item::bytes14) {
                extra_.emplace(item.version, std::vector(item.bytes, SymbolModel(256)),
                               std::vector(first, first + item.bytes), channel);
                extra_layer_ = layer;
            }
            first += item.bytes;
        }
    }
    Layered(const Layered&) = delete;

    static size_t layer_count(const Compression& compression) {
        size_t count = 0;
        for (const ItemLayout& item : compression.items) switch (item.item) {
                case Item::point14:
                    count += Point14Coder<Coder>::kLayers;
                    break;
                case Item::color14:
                    count += 1;
                    break;
                case Item::color_nir14:
                    count += 2;
                    break;
                default:
                    count += item.bytes;
            }
        return count;
    }

    /// Reads or writes the next record.
    void code(std::byte* to) {
        point_.code(to);
        to += Point14Coder<Coder>::kBytes;
        if (color_) {
            code_color(to);
            to += color_bytes_;
        }
        if (extra_) code_extra(to);
    }
    std::span<Layer<Coder>> layers() { return layers_; }

 private:
    void code_color(std::byte* to) {
        auto [models, last] = color_->at(point_.channel(), point_.channel_changed());
        ColorNir next;
        if constexpr (Coder::kEncodes) std::memcpy(&next, to, color_bytes_);
        if (auto* layer = used(color_layer_, next.color != last.color))
            last.color = models.color.code(layer->coder, last.color, next.color);
        if (color_bytes_ == sizeof(ColorNir))
            if (auto* layer = used(color_layer_ + 1, next.nir != last.nir))
                last.nir = models.nir.code(layer->coder, last.nir, next.nir);
        if constexpr (!Coder::kEncodes) std::memcpy(to, &last, color_bytes_);
    }

    void code_extra(std::byte* to) {
        auto [models, last] = extra_->at(point_.channel(), point_.channel_changed());
        for (size_t i = 0; i < last.size(); ++i) {
            const auto before = static_cast<uint32_t>(last[i]), next = static_cast<uint32_t>(to[i]);
            if (auto* layer = used(extra_layer_ + i, next != before))
                last[i] =
                    static_cast<std::byte>(before + layer->coder.symbol(models[i], (next - before) & 255));
            if constexpr (!Coder::kEncodes) to[i] = last[i];
        }
    }

    /// Returns the layer if it is coded, otherwise null. An encoder codes every layer and notes whether
    /// anything changes.
    Layer<Coder>* used(size_t index, bool changes) {
        Layer<Coder>& layer = layers_[index];
        if constexpr (Coder::kEncodes) layer.changes |= changes;
        return Coder::kEncodes || layer.changes ? &layer : nullptr;
    }

    std::vector<Layer<Coder>> layers_;
    Point14Coder<Coder> point_;
    std::optional<Channels<ColorNirModels, ColorNir>> color_;
    std::optional<Channels<std::vector<SymbolModel>, std::vector<std::byte>>> extra_;
    size_t color_bytes_ = 0, color_layer_ = 0, extra_layer_ = 0;
};

}  // namespace lucarne::io::laz
