#include "io/formats/las/laz/chunk_decoder.h"

#include <algorithm>

#include "io/formats/las/laz/layered.h"
#include "io/formats/las/laz/point_wise.h"

namespace lucarne::io::laz {
namespace {

/// Points are counted only in chunks whose records take no more: counting decodes the whole chunk.
constexpr uint64_t kMostCountedBytes = uint64_t{32} << 20;

auto cut_off(const std::string& file) {
    return rejected(file, "has compressed points that are cut off or damaged");
}

struct Layers {
    std::vector<Layer<Decoder>> layers;
    const std::byte* end = nullptr;  ///< end of the chunk
};

/// Reads what follows the first point: the number of points, the sizes of the layers, the layers. The first
/// layer describes every point and is always present.
Result<Layers> read_layers(const std::string& file, const Compression& compression, uint64_t points,
                           std::span<const std::byte> bytes) {
    const size_t count = Layered<Decoder>::layer_count(compression);
    const size_t sizes = sizeof(uint32_t), data = sizes + count * sizeof(uint32_t);
    if (bytes.size() < data) return cut_off(file);
    if (load<uint32_t>(bytes.data()) != points)
        return rejected(file, "has a chunk whose number of points is not that of its chunk table");
    Layers layers{std::vector<Layer<Decoder>>(count), nullptr};
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

uint64_t model_bytes(const Compression& compression) {
    // A model of a byte's values: the count of each, where the interval of each begins, and a table for the
    // search.
    constexpr uint64_t kOfByte = 1536, kOfFields = uint64_t{64} << 10;
    return (kOfFields + kOfByte * record_bytes(compression)) * (compression.layered ? kChannels : 1);
}

size_t layered_head_bytes(const Compression& compression) {
    return record_bytes(compression) + sizeof(uint32_t) * (1 + Layered<Decoder>::layer_count(compression));
}

Result<LayeredSize> layered_size(const std::string& file, const Compression& compression,
                                 std::span<const std::byte> head) {
    if (head.size() < layered_head_bytes(compression)) return cut_off(file);
    size_t at = record_bytes(compression);
    LayeredSize size{load<uint32_t>(&head[at]), head.size()};
    for (at += sizeof(uint32_t); at < head.size(); at += sizeof(uint32_t))
        size.bytes += load<uint32_t>(&head[at]);
    return size;
}

struct ChunkDecoder::State {
    std::string file;
    uint32_t record_bytes = 0;
    const std::byte* begin = nullptr;
    std::span<const std::byte> first;  ///< the uncompressed first point; empty once it is returned
    std::optional<PointWise<Decoder>> point_wise;
    std::optional<Layered<Decoder>> layered;
    const std::byte* layers_end = nullptr;

    bool failed() {
        if (point_wise) return point_wise->coder().failed();
        const auto layers = layered->layers();
        return std::any_of(layers.begin(), layers.end(),
                           [](const auto& layer) { return layer.changes && layer.coder.failed(); });
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
        state->layers_end = layers.end;
        state->layered.emplace(compression, std::move(layers.layers), bytes.data());
    } else {
        state->point_wise.emplace(compression, Decoder(bytes.subspan(state->record_bytes)), bytes.data());
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
    for (; count > 0; --count, records += state_->record_bytes)
        state_->layered ? state_->layered->code(records) : state_->point_wise->code(records);
    if (state_->failed()) return cut_off(state_->file);
    return {};
}

std::optional<uint64_t> count_points(const Compression& compression, std::span<const std::byte> chunk,
                                     uint64_t most, uint64_t expected) {
    const size_t bytes = record_bytes(compression);
    most = std::min<uint64_t>(most, kMostCountedBytes / bytes);
    if (compression.layered || chunk.size() < bytes) return std::nullopt;
    PointWise<Decoder> points(compression, Decoder(chunk.subspan(bytes)), chunk.data());
    std::vector<std::byte> record(bytes);
    const auto far = [&](uint64_t count) { return count > expected ? count - expected : expected - count; };
    std::optional<uint64_t> found;
    for (uint64_t count = 1; count <= most && !points.coder().failed(); ++count) {
        if (count > 1) points.code(record.data());
        if (points.coder().is_finished() && (!found || far(count) < far(*found))) found = count;
    }
    return found;
}

bool ChunkDecoder::ends_well() const {
    if (state_->point_wise) return state_->point_wise->coder().at_end();
    const auto layers = state_->layered->layers();
    return std::all_of(layers.begin(), layers.end(),
                       [](const auto& layer) { return !layer.changes || layer.coder.at_end(); });
}

uint64_t ChunkDecoder::consumed() const {
    const std::byte* end = state_->layered ? state_->layers_end : state_->point_wise->coder().position();
    return static_cast<uint64_t>(end - state_->begin);
}

}  // namespace lucarne::io::laz
