#include "io/formats/laz/chunk_encoder.h"

#include "io/formats/laz/layered.h"

namespace lucarne::io::laz {

std::vector<std::byte> encode_chunk(const Compression& compression, std::span<const std::byte> records) {
    uint32_t record_bytes = 0;
    for (const ItemLayout& item : compression.items) record_bytes += item.bytes;
    const auto count = static_cast<uint32_t>(records.size() / record_bytes);
    std::vector<std::byte> chunk(records.begin(), records.begin() + record_bytes);
    Layered<Encoder> layered(
        compression, std::vector<Layer<Encoder>>(Layered<Encoder>::layer_count(compression)), records.data());
    std::vector<std::byte> record(record_bytes);
    for (uint32_t i = 1; i < count; ++i) {
        std::memcpy(record.data(), &records[size_t{i} * record_bytes], record_bytes);
        layered.code(record.data());
    }
    const auto put = [&](uint32_t number) {
        chunk.resize(chunk.size() + sizeof number);
        store(chunk.data() + chunk.size() - sizeof number, number);
    };
    put(count);
    std::vector<std::byte> layers;
    // The first layer is always there, also in a chunk of one point.
    layered.layers()[0].changes = true;
    for (auto& layer : layered.layers()) {
        const auto bytes = layer.changes ? layer.coder.finish() : std::vector<std::byte>();
        put(static_cast<uint32_t>(bytes.size()));
        layers.insert(layers.end(), bytes.begin(), bytes.end());
    }
    chunk.insert(chunk.end(), layers.begin(), layers.end());
    return chunk;
}

}  // namespace lucarne::io::laz
