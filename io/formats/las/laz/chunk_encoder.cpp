#include "io/formats/las/laz/chunk_encoder.h"

#include "io/formats/las/laz/layered.h"
#include "io/formats/las/laz/point_wise.h"

namespace lucarne::io::laz {
namespace {

using Records = std::span<const std::byte>;

/// Encodes all records but the first, which stands uncompressed before the code.
template <class Coding>
void code_rest(Coding& coding, Records records, size_t record_bytes) {
    std::vector<std::byte> record(record_bytes);
    for (size_t at = record_bytes; at < records.size(); at += record_bytes) {
        std::memcpy(record.data(), &records[at], record_bytes);
        coding.code(record.data());
    }
}

std::vector<std::byte> encode_point_wise(const Compression& compression, Records records,
                                         size_t record_bytes) {
    PointWise<Encoder> points(compression, Encoder(), records.data());
    code_rest(points, records, record_bytes);
    std::vector<std::byte> chunk(records.begin(),
                                 records.begin() + static_cast<std::ptrdiff_t>(record_bytes));
    const auto code = points.coder().finish();
    chunk.insert(chunk.end(), code.begin(), code.end());
    return chunk;
}

std::vector<std::byte> encode_layered(const Compression& compression, Records records, size_t record_bytes) {
    const auto count = static_cast<uint32_t>(records.size() / record_bytes);
    std::vector<std::byte> chunk(records.begin(),
                                 records.begin() + static_cast<std::ptrdiff_t>(record_bytes));
    Layered<Encoder> layered(
        compression, std::vector<Layer<Encoder>>(Layered<Encoder>::layer_count(compression)), records.data());
    code_rest(layered, records, record_bytes);
    const auto put = [&](uint32_t number) {
        chunk.resize(chunk.size() + sizeof number);
        store(chunk.data() + chunk.size() - sizeof number, number);
    };
    put(count);
    std::vector<std::byte> layers;
    // The first layer is always present, even in a chunk of one point.
    layered.layers()[0].changes = true;
    for (auto& layer : layered.layers()) {
        const auto bytes = layer.changes ? layer.coder.finish() : std::vector<std::byte>();
        put(static_cast<uint32_t>(bytes.size()));
        layers.insert(layers.end(), bytes.begin(), bytes.end());
    }
    chunk.insert(chunk.end(), layers.begin(), layers.end());
    return chunk;
}

}  // namespace

std::vector<std::byte> encode_chunk(const Compression& compression, std::span<const std::byte> records) {
    const size_t bytes = record_bytes(compression);
    return compression.layered ? encode_layered(compression, records, bytes)
                               : encode_point_wise(compression, records, bytes);
}

}  // namespace lucarne::io::laz
