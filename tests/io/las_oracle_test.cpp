// Our LAS reader against laspy: see tests/oracles/las_oracle.py, which wrote las_expected.json.
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

/// The 64 bits of a number: integers sign-extended, floats as doubles.
uint64_t bits_of(ScalarType type, const std::byte* at) {
    switch (type) {
        case ScalarType::u64:
        case ScalarType::i64:
            return load<uint64_t>(at);
        case ScalarType::f32:
        case ScalarType::f64: {
            const double value = scalar_at(type, at);
            uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            return bits;
        }
        default:
            return static_cast<uint64_t>(static_cast<int64_t>(scalar_at(type, at)));
    }
}

/// Sum of the bits and sum weighted by place, modulo 2^64.
nlohmann::json digest(const testing::Records& records, size_t stride, size_t offset, ScalarType type) {
    uint64_t sum = 0, placed = 0;
    for (size_t i = 0; i < records.count; ++i) {
        const uint64_t bits = bits_of(type, &records.bytes[i * stride + offset]);
        sum += bits;
        placed += (i + 1) * bits;
    }
    return {fmt::format("{:016x}", sum), fmt::format("{:016x}", placed)};
}

TEST(LasOracle, EveryValueOfEveryAttributeIsWhatLaspyReads) {
    const auto folder = testing::shared_data();
    if (folder.empty()) GTEST_SKIP() << "the shared data is not here";
    std::ifstream in(std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests/oracles/las_expected.json");
    const auto expected = nlohmann::json::parse(in);
    ASSERT_GE(expected.size(), 7u);
    for (const auto& [file, truth] : expected.items()) {
        const auto opened = open_scan(folder / "las" / file);
        ASSERT_TRUE(opened) << opened.error().line();
        const PointSource& source = **opened;
        const Schema& schema = source.schema();
        const auto records = testing::read_all(source);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count, truth["points"].get<size_t>()) << file;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(schema.scale[axis], truth["scale"][static_cast<size_t>(axis)].get<double>()) << file;
            EXPECT_EQ(schema.offset[axis], truth["offset"][static_cast<size_t>(axis)].get<double>()) << file;
        }
        EXPECT_EQ(schema.attributes.size() + 1, truth["attributes"].size()) << file;
        for (const auto& [name, digests] : truth["attributes"].items()) {
            const Attribute position{"position", ScalarType::i32, 3, 0};
            const Attribute* a = name == "position" ? &position : schema.find(name);
            ASSERT_TRUE(a) << file << " lacks " << name;
            ASSERT_EQ(a->components, digests.size()) << file << ' ' << name;
            for (size_t c = 0; c < a->components; ++c)
                EXPECT_EQ(digest(*records, schema.stride, a->offset + c * scalar_bytes(a->type), a->type),
                          digests[c])
                    << file << ' ' << name << ' ' << c;
        }
    }
}

}  // namespace
}  // namespace lucarne::io
