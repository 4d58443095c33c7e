// Makes LAZ in layers with Lucarne's own writer, with chunks of fixed and variable size. Makes LAZ point by
// point from random bytes after a first point, because any bytes decode to some points.
#include <span>

#include <fmt/format.h>

#include "io/core/random.h"
#include "io/formats/las/layout.h"
#include "io/formats/las/laz/chunk_decoder.h"
#include "io/formats/las/laz/encoder.h"
#include "io/formats/las/laz/integers.h"
#include "io/formats/las/laz/writer.h"
#include "io/formats/scan.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/io/formats/las/las_builder.h"

namespace lucarne::fuzz {
namespace {

using namespace io;

io::las::Header header_of(uint8_t format, uint16_t extra) {
    io::las::Header header;
    header.minor = las::extended_format(format) ? 4 : 2;
    header.point_format = format;
    header.record_length = static_cast<uint16_t>(las::record_bytes(format) + extra);
    return header;
}

/// Returns the chunks with their table: the sizes of the chunks (and their points, if variable). The table's
/// offset stands before the chunks.
std::string with_table(const std::vector<std::string>& chunks, const std::vector<uint32_t>& points,
                       uint64_t begin) {
    std::string all;
    laz::Encoder encoder;
    laz::IntegerModel model(32, 2);
    int32_t last_points = 0, last_bytes = 0;
    for (size_t i = 0; i < chunks.size(); ++i) {
        if (!points.empty()) {
            model.code(encoder, last_points, static_cast<int32_t>(points[i]), 0);
            last_points = static_cast<int32_t>(points[i]);
        }
        model.code(encoder, last_bytes, static_cast<int32_t>(chunks[i].size()), 1);
        last_bytes = static_cast<int32_t>(chunks[i].size());
        all += chunks[i];
    }
    const auto coded = encoder.finish();
    std::string table;
    testing::append(table, uint64_t{begin + 8 + all.size()});
    table += all;
    testing::append(table, uint32_t{0});
    testing::append(table, static_cast<uint32_t>(chunks.size()));
    return table.append(reinterpret_cast<const char*>(coded.data()), coded.size());
}

constexpr uint16_t kPointWise = 1, kPointWiseChunked = 2;

/// Returns random bytes that decode to `count` points and end with the last of them, as a chunk must.
std::string noise_chunk(const laz::Compression& compression, uint32_t record_length, uint32_t count,
                        Random& random) {
    std::string noise(record_length + 80 * size_t{count}, '\0');
    for (char& byte : noise) byte = static_cast<char>(random.next());
    auto decoder = laz::ChunkDecoder::create("a seed", compression, count, std::as_bytes(std::span(noise)));
    std::vector<std::byte> records(size_t{count} * record_length);
    if (!decoder || !decoder->decode(count, records.data())) return {};  // add_scan reports it then
    return noise.substr(0, decoder->consumed());
}

/// Chunks of eight points; the last is shorter.
std::string point_wise(uint8_t format, uint16_t extra, uint16_t compressor, bool variable) {
    const io::las::Header header = header_of(format, extra);
    const laz::Compression compression{true, false, variable ? laz::kVariableChunks : 8u,
                                       laz::items_of(header, 2)};
    Random random(format);
    std::vector<std::string> chunks;
    std::vector<uint32_t> points;
    for (const uint32_t count :
         compressor == kPointWise ? std::vector<uint32_t>{12} : std::vector<uint32_t>{8, 4}) {
        chunks.push_back(noise_chunk(compression, header.record_length, count, random));
        points.push_back(count);
    }
    std::string record;
    for (const std::byte byte : laz::compression_record(compression).data) record += static_cast<char>(byte);
    record.replace(0, 2, reinterpret_cast<const char*>(&compressor), 2);
    testing::LasFile file;
    file.minor = header.minor;
    file.format = static_cast<uint8_t>(format | 0x80);
    file.record_length = header.record_length;
    file.said_old_points = 12;
    file.add_vlr(std::string(laz::kUser), laz::kRecord, record);
    const std::string front = file.bytes();
    return front + (compressor == kPointWise
                        ? chunks[0]
                        : with_table(chunks, variable ? points : std::vector<uint32_t>(), front.size()));
}

/// Made with Lucarne's own writer: records that change now and then.
std::string layered(const Seeds& seeds, uint8_t format, bool extra, size_t points) {
    const io::las::Header header = header_of(format, 0);
    Schema schema = las::make_schema(header);
    if (extra) schema.add("amplitude", ScalarType::f32);
    Random random(format);
    std::vector<std::byte> records(points * schema.stride);
    for (size_t i = 0; i < points; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            store(&records[i * schema.stride + 4 * axis], static_cast<int32_t>(100 * i + random.next() % 50));
    for (const Attribute& a : schema.attributes)
        for (size_t i = 0; i < points; ++i)
            for (size_t b = 0; b < a.bytes(); ++b)
                records[i * schema.stride + a.offset + b] =
                    static_cast<std::byte>(random.next() % 8 ? i / 8 % 2 : 1);
    const auto path = seeds.folder() / "written.laz";
    const auto writer = create_scan(path, schema, {}, {.overwrite = true});
    if (!writer || !(*writer)->write(records) || !(*writer)->finish()) return {};
    return Seeds::taken(path);
}

}  // namespace

void laz_seeds(const Seeds& seeds) {
    for (uint8_t format = 0; format <= 3; ++format) {
        seeds.add_scan(fmt::format("pointwise{}", format), point_wise(format, 0, kPointWiseChunked, false));
        seeds.add_scan(fmt::format("pointwise{}-one-chunk", format),
                       point_wise(format, 3, kPointWise, false));
        seeds.add_scan(fmt::format("pointwise{}-variable", format),
                       point_wise(format, 3, kPointWiseChunked, true));
    }
    for (const uint8_t format : {6, 7, 8})
        for (const bool extra : {false, true})
            seeds.add_scan(fmt::format("layered{}{}", format, extra ? "-extra" : ""),
                           layered(seeds, format, extra, 40));
}

}  // namespace lucarne::fuzz
