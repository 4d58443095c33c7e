// Compressed payloads: every record comes back bit by bit, whatever the schema, and damage is detected.
#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/codec/payload.h"
#include "octree/codec/token.h"
#include "octree/tree/prefix_order.h"

namespace lucarne::octree::codec {
namespace {

using io::PositionType;
using io::ScalarType;
using Bytes = std::vector<std::byte>;

/// Records along the curve, their passes, and their payload.
struct Node {
    Bytes records;
    std::vector<uint8_t> passes;

    Bytes encode(const io::Schema& schema) const {
        Bytes payload;
        PayloadEncoder(schema).encode(records, passes, payload);
        return payload;
    }
    Bytes in_prefix_order(uint32_t stride) const {
        std::vector<uint32_t> order;
        append_prefix_order(passes, 0, order);
        Bytes sorted;
        for (const uint32_t i : order)
            sorted.insert(sorted.end(), &records[size_t{i} * stride], &records[size_t{i} * stride] + stride);
        return sorted;
    }
};

/// The payload in a buffer of exactly its size plus the bytes that may be read after it, so that a sanitizer
/// finds more.
bool decode(const io::Schema& schema, Bytes payload, Bytes& records) {
    const size_t bytes = payload.size();
    payload.resize(bytes + kReadAhead);
    payload.shrink_to_fit();
    const auto columns = columns_of(schema);
    return PayloadDecoder(columns, schema.stride).decode(std::span(payload).first(bytes), records);
}

io::Schema schema_of(PositionType position) {
    io::Schema schema;
    schema.position = position;
    schema.stride = static_cast<uint32_t>(io::position_bytes(position));
    return schema;
}

io::Schema lidar_schema() {
    io::Schema schema = schema_of(PositionType::i32_scaled);
    schema.add("intensity", ScalarType::u16);
    schema.add("classification", ScalarType::u8);
    schema.add("color", ScalarType::u16, 3);
    schema.add("normal_oct", ScalarType::u8, 3);
    schema.add("area", ScalarType::u16);
    return schema;
}

std::vector<uint8_t> some_passes(size_t count, Random& random) {
    std::vector<uint8_t> passes(count);
    for (auto& pass : passes)
        pass = static_cast<uint8_t>(
            std::min<uint64_t>(kLastPass, random.next() % 40 % (1 + random.next() % 40)));
    return passes;
}

Node random_node(uint32_t stride, size_t count, uint64_t seed,
                 const std::function<std::byte(Random&)>& byte) {
    Random random(seed);
    Node node{Bytes(count * stride), some_passes(count, random)};
    for (auto& b : node.records) b = byte(random);
    return node;
}

/// A wall with noise, as a scanner sees it.
Node wall(size_t count, const io::Schema& schema) {
    Random random(5);
    Node node{Bytes(count * schema.stride), some_passes(count, random)};
    for (size_t i = 0; i < count; ++i) {
        std::byte* at = &node.records[i * schema.stride];
        const auto noise = [&](int most) {
            return static_cast<int>(random.next() % static_cast<uint64_t>(most));
        };
        io::store(at, static_cast<int32_t>(40 * i + static_cast<size_t>(noise(60))));
        io::store(at + 4, static_cast<int32_t>(-100'000 + noise(300)));
        io::store(at + 8, static_cast<int32_t>(noise(8)));
        io::store(at + 12, static_cast<uint16_t>(noise(1024)));
        for (int c = 0; c < 3; ++c) io::store(at + 15 + 2 * c, static_cast<uint16_t>((100 + noise(9)) * 257));
        io::store(at + 21, static_cast<uint16_t>(2047 + 16 * noise(5)));
        io::store(at + 24, static_cast<uint16_t>(20'000 + 64 * noise(9)));
    }
    return node;
}

void expect_round_trip(const io::Schema& schema, const Node& node, const std::string& what) {
    Bytes back(node.records.size());
    ASSERT_TRUE(decode(schema, node.encode(schema), back)) << what;
    EXPECT_EQ(back, node.in_prefix_order(schema.stride)) << what;
}

TEST(Codec, TokensCoverEveryNumber) {
    Random random(1);
    for (int i = 0; i < 100'000; ++i) {
        const uint64_t value = random.next() >> (random.next() % 64);
        const uint32_t token = token_of(value);
        ASSERT_LT(token, 256u);
        ASSERT_GE(value, token_base(token));
        ASSERT_EQ((value - token_base(token)) >> extra_bits(token), 0u) << value;
        ASSERT_EQ(fold_sign(unfold_sign(value)), value);
    }
    EXPECT_EQ(token_of(std::numeric_limits<uint64_t>::max()), 255u);
}

TEST(Codec, BitsOfAnyWidthComeBack) {
    Random random(2);
    std::vector<std::pair<uint64_t, uint32_t>> numbers;
    Bytes bytes;
    BitWriter writer(bytes);
    for (int i = 0; i < 10'000; ++i) {
        const auto width = static_cast<uint32_t>(random.next() % 65);
        const uint64_t value = width == 0 ? 0 : random.next() >> (64 - width);
        numbers.emplace_back(value, width);
        writer.put(value, width);
    }
    writer.flush();
    bytes.resize(bytes.size() + kReadAhead);
    BitReader reader(bytes.data());
    for (const auto& [value, width] : numbers) ASSERT_EQ(reader.take(width), value) << width;
}

TEST(Codec, GivesBackRecordsOfEverySchemaAndContent) {
    const std::vector<std::pair<std::string, std::function<std::byte(Random&)>>> contents = {
        {"noise", [](Random& r) { return static_cast<std::byte>(r.next()); }},
        {"zeros", [](Random&) { return std::byte{0}; }},
        {"ones", [](Random&) { return std::byte{0xff}; }},
        {"few values", [](Random& r) { return static_cast<std::byte>(r.next() % 3); }},
        {"rare values", [](Random& r) { return static_cast<std::byte>(r.next() % 50 == 0 ? 0x80 : 0); }}};
    for (const auto position : {PositionType::i32_scaled, PositionType::f32, PositionType::f64}) {
        std::vector<io::Schema> schemas = {schema_of(position), schema_of(position), lidar_schema()};
        for (uint8_t type = 1; type <= 10; ++type)
            schemas[1].add(fmt::format("a{}", type), static_cast<ScalarType>(type), 1 + type % 3);
        for (const auto type : {ScalarType::u8, ScalarType::u16, ScalarType::f32, ScalarType::i16}) {
            schemas.push_back(schema_of(position));
            schemas.back().add("color", type, 3);
            schemas.push_back(schema_of(position));
            schemas.back().add("normal_oct", type, 3);
        }
        for (size_t s = 0; s < schemas.size(); ++s)
            for (const auto& [name, byte] : contents)
                for (const size_t count : {1, 2, 3, 100, 3000})
                    expect_round_trip(schemas[s], random_node(schemas[s].stride, count, s * 7 + count, byte),
                                      fmt::format("{}, schema {}", name, s));
    }
}

TEST(Codec, NoiseTakesItsBitsAndTheRestNearlyNone) {
    const io::Schema schema = lidar_schema();
    const Node node = wall(5000, schema);
    expect_round_trip(schema, node, "wall");
    Bytes payload = node.encode(schema);
    // Shannon's bound of what varies, of differences between neighbours where values change slowly: about 6.6
    // for x, 9.2 for y, 3 for z, 10 for intensity, 3.2 for green and up to 4.1 for each difference to it,
    // 2.3, 3.2, passes 4.6.
    const double bits = 8.0 * static_cast<double>(payload.size()) / 5000;
    EXPECT_LT(bits, 1.05 * (6.6 + 9.2 + 3 + 10 + 3.2 + 2 * 4.1 + 2.3 + 3.2 + 4.6));
    // The class is one more byte in each record, always the same.
    Node other = node;
    for (size_t i = 0; i < 5000; ++i) other.records[i * schema.stride + 14] = std::byte{2};
    EXPECT_LE(other.encode(schema).size(), payload.size() + 2);
}

TEST(Codec, DamagedPayloadsNeverCrashAndTruncatedOnesAreRefused) {
    const io::Schema schema = lidar_schema();
    const Node node = wall(700, schema);
    const Bytes payload = node.encode(schema);
    Bytes back(node.records.size());
    for (size_t bytes = 0; bytes < payload.size(); ++bytes) {
        const Bytes part(payload.begin(), payload.begin() + static_cast<ptrdiff_t>(bytes));
        ASSERT_FALSE(decode(schema, part, back)) << bytes;
    }
    Bytes longer = payload;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decode(schema, longer, back));
    Random random(9);
    for (int i = 0; i < 20'000; ++i) {
        Bytes damaged = payload;
        for (uint64_t flips = 1 + random.next() % 3; flips > 0; --flips)
            damaged[random.next() % (i % 2 ? damaged.size() : 100)] ^=
                static_cast<std::byte>(1u << random.next() % 8);
        (void)decode(schema, damaged, back);
    }
}

TEST(Codec, RefusesHeadsThatLie) {
    const io::Schema schema = schema_of(PositionType::i32_scaled);
    Bytes back(12 * 4);
    const auto bytes = [](std::initializer_list<int> list) {
        Bytes all;
        for (const int b : list) all.push_back(static_cast<std::byte>(b));
        return all;
    };
    EXPECT_TRUE(decode(schema, bytes({0, 0, 0, 7, 0, 8, 0, 9}), back));
    EXPECT_FALSE(decode(schema, bytes({0, 32, 0, 7, 0, 8, 0, 9}), back)) << "a pass too many";
    EXPECT_FALSE(decode(schema, bytes({4, 0, 0, 7, 0, 8, 0, 9}), back)) << "an unknown method";
    EXPECT_FALSE(decode(schema, bytes({0, 0, 0, 7, 0, 8, 1, 0, 1, 65, 0}), back)) << "65 bits";
    EXPECT_FALSE(decode(schema, bytes({0, 0, 0, 7, 0, 8, 0}), back)) << "no base";
    EXPECT_FALSE(decode(schema, bytes({0, 0, 0, 7, 0, 8, 2, 0, 1, 4, 0, 20, 0, 0, 0}), back))
        << "a token without its extra bits";
    EXPECT_FALSE(decode(schema, bytes({0, 0, 0, 7, 0, 8, 2, 0, 1, 3, 0, 1, 2, 3}), back)) << "no zstd frame";
    EXPECT_FALSE(decode(schema, bytes({0,   0,   0,   7,   0,   8,   2,   0, 1, 4, 255, 255,
                                       255, 255, 255, 255, 255, 255, 255, 1, 1, 1, 1,   1}),
                        back))
        << "sizes that overflow";
}

}  // namespace
}  // namespace lucarne::octree::codec
