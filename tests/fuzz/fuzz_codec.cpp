// Fuzzes compressed payloads alone; fuzz_cache reaches them only through a whole file. The input: a byte that
// selects the schema, two for the number of points, and the payload.
#include <cstring>
#include <vector>

#include "octree/codec/payload.h"
#include "tests/fuzz/fuzz.h"

namespace lucarne::octree::codec {
namespace {

io::Schema schema_of(uint8_t kind) {
    io::Schema schema;
    schema.position = static_cast<io::PositionType>(1 + kind % 3);
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    if (kind & 4) schema.add("color", kind & 8 ? io::ScalarType::u16 : io::ScalarType::u8, 3);
    if (kind & 16) schema.add("normal_oct", io::ScalarType::u8, 3);
    if (kind & 32) schema.add("gps_time", io::ScalarType::f64);
    if (kind & 64) schema.add("scan_angle", io::ScalarType::i16);
    return schema;
}

}  // namespace
}  // namespace lucarne::octree::codec

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    using namespace octree::codec;
    if (size < 3) return false;
    const auto schema = schema_of(data[0]);
    const size_t count = 1 + (data[1] | data[2] << 8) % 4096, bytes = size - 3;
    std::vector<std::byte> payload(bytes + kReadAhead), records(count * schema.stride);
    if (bytes > 0) std::memcpy(payload.data(), data + 3, bytes);
    const auto columns = columns_of(schema);
    (void)PayloadDecoder(columns, schema.stride).decode(std::span(payload).first(bytes), records);
    return true;
}
