#include "io/formats/laz/chunk_decoder.h"

#include <algorithm>
#include <optional>

#include "io/formats/laz/color.h"
#include "io/formats/laz/point14.h"

namespace lucarne::io::laz {
namespace {

uint32_t record_bytes(const Compression& compression) {
    uint32_t bytes = 0;
    for (const ItemLayout& item : compression.items) bytes += item.bytes;
    return bytes;
}

/// Point formats 0 to 3: all items of a point in one stream, one after the other.
class PointWise {
 public:
    PointWise(const Compression& compression, std::span<const std::byte> bytes)
        : decoder_(bytes.subspan(record_bytes(compression))) {
        const std::byte* first = bytes.data();
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

    void decode(std::byte* to) {
        point_.decode(decoder_, to);
        to += Point10Decoder::kBytes;
        if (time_) {
            store(to, time_->decode(decoder_));
            to += sizeof(uint64_t);
        }
        if (color_) {
            last_color_ = color_->code(decoder_, last_color_, {});
            std::memcpy(to, last_color_.data(), sizeof last_color_);
            to += sizeof last_color_;
        }
        for (size_t i = 0; i < extra_.size(); ++i)
            to[i] = last_extra_[i] =
                static_cast<std::byte>(static_cast<uint32_t>(last_extra_[i]) + decoder_.symbol(extra_[i]));
    }
    bool failed() const { return decoder_.failed(); }
    const std::byte* end() const { return decoder_.position(); }

 private:
    Decoder decoder_;
    Point10Decoder point_;
    std::optional<GpsTimeModel> time_;
    std::optional<ColorModel> color_;
    Color last_color_{};
    std::vector<SymbolModel> extra_;
    std::vector<std::byte> last_extra_;
};

/// Models and last values of an item for each scanner channel. Version 3 of the items goes on from the values
/// of the channel before when it comes back to a channel; version 4 mended that.
template <class Models, class Last>
class Channels {
 public:
    Channels(uint16_t version, const Models& fresh, Last first, uint32_t channel)
        : fresh_(fresh), keeps_last_(version < 4), current_(channel) {
        channels_[channel].emplace(fresh_, std::move(first));
    }
    struct Channel {
        Channel(const Models& m, Last l) : models(m), last(std::move(l)) {}
        Models models;
        Last last;
    };
    /// The models of a channel and the last values to go on from.
    std::pair<Models&, Last&> at(uint32_t channel) {
        Channel& before = *channels_[current_];
        current_ = channel;
        auto& now = channels_[channel];
        const bool fresh = !now;
        if (fresh) now.emplace(fresh_, before.last);
        return {now->models, keeps_last_ && !fresh ? before.last : now->last};
    }

 private:
    Models fresh_;
    bool keeps_last_;
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

struct Layers {
    std::vector<Layer> layers;
    const std::byte* end = nullptr;  ///< of the chunk
};

/// Point formats 6 to 8: each attribute in layers of its own.
class Layered {
 public:
    Layered(const Compression& compression, Layers layers, const std::byte* first)
        : layers_(std::move(layers.layers)),
          end_(layers.end),
          point_(first, std::span(layers_).first<Point14Decoder::kLayers>()) {
        const uint32_t channel = load<uint8_t>(first + 15) >> 4 & 3;
        size_t layer = Point14Decoder::kLayers;
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
                    count += Point14Decoder::kLayers;
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

    void decode(std::byte* to) {
        const uint32_t channel = point_.decode(to);
        to += Point14Decoder::kBytes;
        if (color_) {
            auto [models, last] = color_->at(channel);
            Layer& color = layers_[color_layer_];
            if (color.changes) last.color = models.color.code(color.decoder, last.color, {});
            if (color_bytes_ == sizeof(ColorNir)) {
                Layer& nir = layers_[color_layer_ + 1];
                if (nir.changes) last.nir = models.nir.code(nir.decoder, last.nir, 0);
            }
            std::memcpy(to, &last, color_bytes_);
            to += color_bytes_;
        }
        if (extra_) {
            auto [models, last] = extra_->at(channel);
            for (size_t i = 0; i < last.size(); ++i) {
                Layer& layer = layers_[extra_layer_ + i];
                if (layer.changes)
                    last[i] = static_cast<std::byte>(static_cast<uint32_t>(last[i]) +
                                                     layer.decoder.symbol(models[i]));
                to[i] = last[i];
            }
        }
    }
    bool failed() const {
        return std::any_of(layers_.begin(), layers_.end(),
                           [](const Layer& layer) { return layer.changes && layer.decoder.failed(); });
    }

    const std::byte* end() const { return end_; }

 private:
    std::vector<Layer> layers_;
    const std::byte* end_;
    Point14Decoder point_;
    std::optional<Channels<ColorNirModels, ColorNir>> color_;
    std::optional<Channels<std::vector<SymbolModel>, std::vector<std::byte>>> extra_;
    size_t color_bytes_ = 0, color_layer_ = 0, extra_layer_ = 0;
};

auto cut_off(const std::string& file) {
    return rejected(file, "has compressed points that are cut off or damaged");
}

/// The layers behind the first point: how many points the chunk has, the layers' sizes, the layers. The first
/// layer tells of every point and is always there.
Result<Layers> read_layers(const std::string& file, const Compression& compression, uint64_t points,
                           std::span<const std::byte> bytes) {
    const size_t count = Layered::layer_count(compression);
    const size_t sizes = sizeof(uint32_t), data = sizes + count * sizeof(uint32_t);
    if (bytes.size() < data) return cut_off(file);
    if (load<uint32_t>(bytes.data()) != points)
        return rejected(file, "has a chunk whose number of points is not that of its chunk table");
    Layers layers{std::vector<Layer>(count), nullptr};
    std::span<const std::byte> rest = bytes.subspan(data);
    for (size_t i = 0; i < count; ++i) {
        const auto size = load<uint32_t>(bytes.data() + sizes + i * sizeof(uint32_t));
        if (size > rest.size()) return cut_off(file);
        if (size > 0) layers.layers[i] = {Decoder(rest.first(size)), true};
        rest = rest.subspan(size);
    }
    layers.end = rest.data();
    if (!layers.layers[0].changes && points > 1) return cut_off(file);
    return layers;
}

}  // namespace

struct ChunkDecoder::State {
    std::string file;
    uint32_t record_bytes = 0;
    const std::byte* begin = nullptr;
    std::span<const std::byte> first;  ///< the first point as it is; empty once it is given out
    std::optional<PointWise> point_wise;
    std::optional<Layered> layered;

    template <class Points>
    Result<void> decode(Points& points, uint64_t count, std::byte* to) {
        for (; count > 0; --count, to += record_bytes) points.decode(to);
        if (points.failed()) return cut_off(file);
        return {};
    }
};

ChunkDecoder::ChunkDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
ChunkDecoder::ChunkDecoder(ChunkDecoder&&) noexcept = default;
ChunkDecoder& ChunkDecoder::operator=(ChunkDecoder&&) noexcept = default;
ChunkDecoder::~ChunkDecoder() = default;

Result<ChunkDecoder> ChunkDecoder::create(const std::string& file, const Compression& compression,
                                          uint64_t points, std::span<const std::byte> bytes) {
    auto state = std::make_unique<State>();
    state->file = file;
    state->record_bytes = record_bytes(compression);
    if (bytes.size() < state->record_bytes) return cut_off(file);
    state->begin = bytes.data();
    state->first = bytes.first(state->record_bytes);
    if (compression.layered) {
        LUCARNE_ASSIGN(auto layers,
                       read_layers(file, compression, points, bytes.subspan(state->record_bytes)));
        state->layered.emplace(compression, std::move(layers), bytes.data());
    } else {
        state->point_wise.emplace(compression, bytes);
    }
    return ChunkDecoder(std::move(state));
}

Result<void> ChunkDecoder::decode(uint64_t count, std::byte* records) {
    if (count > 0 && !state_->first.empty()) {
        std::memcpy(records, state_->first.data(), state_->record_bytes);
        state_->first = {};
        records += state_->record_bytes;
        --count;
    }
    return state_->layered ? state_->decode(*state_->layered, count, records)
                           : state_->decode(*state_->point_wise, count, records);
}

uint64_t ChunkDecoder::consumed() const {
    const std::byte* end = state_->layered ? state_->layered->end() : state_->point_wise->end();
    return static_cast<uint64_t>(end - state_->begin);
}

}  // namespace lucarne::io::laz
