// Makes a payload with every method of octree/codec, in the form that fuzz_codec takes.
#include "io/core/random.h"
#include "octree/codec/payload.h"
#include "tests/fuzz/seeds/seeds.h"

void lucarne::fuzz::codec_seeds(const Seeds& seeds) {
    constexpr uint16_t kPoints = 300;
    io::Schema schema;  // the schema of kind 204 in fuzz_codec.cpp
    schema.position = io::PositionType::i32_scaled;
    schema.stride = 12;
    schema.add("color", io::ScalarType::u16, 3);
    schema.add("scan_angle", io::ScalarType::i16);
    std::vector<std::byte> records(kPoints * size_t{schema.stride}), payload;
    std::vector<uint8_t> passes(kPoints);
    Random random(1);
    for (size_t i = 0; i < kPoints; ++i) {
        std::byte* at = &records[i * schema.stride];
        io::store(at, static_cast<int32_t>(1000 * i + random.next() % 500));  // differences
        io::store(at + 4, static_cast<int32_t>(random.next() % 1000));        // plain bits
        io::store(at + 14,
                  static_cast<uint16_t>(257 * (random.next() % 16 * (random.next() % 16))));  // tokens
        passes[i] = static_cast<uint8_t>(random.next() % 8);
    }
    octree::codec::PayloadEncoder(schema).encode(records, passes, payload);
    std::string bytes = {static_cast<char>(204), static_cast<char>((kPoints - 1) & 0xff), (kPoints - 1) >> 8};
    bytes.append(reinterpret_cast<const char*>(payload.data()), payload.size());
    seeds.add("all-methods", bytes);
}
