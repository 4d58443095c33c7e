#include "viewer/picking/exact_point.h"

#include <limits>

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

using Texts = std::array<std::string, 3>;

Texts scaled(const glm::ivec3& integers, const glm::dvec3& scale, const glm::dvec3& offset) {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = scale;
    schema.offset = offset;
    std::array<std::byte, 12> record;
    for (int axis = 0; axis < 3; ++axis) io::store(&record[4 * static_cast<size_t>(axis)], integers[axis]);
    return coordinate_texts(schema, record.data());
}

TEST(ExactPoint, ScaledIntegersAreWrittenWithoutRounding) {
    EXPECT_EQ(scaled({123, -5, 0}, glm::dvec3(0.001), glm::dvec3(0)), (Texts{"0.123", "-0.005", "0.000"}));
    EXPECT_EQ(scaled({1, 100, -1}, {0.01, 0.0001, 1}, {500'000, 5'400'000, 0}),
              (Texts{"500000.01", "5400000.0100", "-1"}));
    constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
    EXPECT_EQ(scaled({kLeast, kMost, kMost}, {1e-3, 1e-7, 1e-3}, {0, 5'400'000.25, -2'147'483.647}),
              (Texts{"-2147483.648", "5400214.9983647", "0.000"}));
    EXPECT_EQ(scaled({7, 3, 1}, {0.25, 1.0 / 1024, 10}, {0.5, 0, 0}), (Texts{"2.25", "0.0029296875", "10"}));
}

TEST(ExactPoint, AScaleThatIsNoShortDecimalGivesADoubleThatReadsBack) {
    const double scale = 0.001 / 3, offset = 1234.5;
    const Texts texts = scaled({1'000'003, 1, -7}, glm::dvec3(scale), glm::dvec3(offset));
    EXPECT_EQ(std::stod(texts[0]), 1'000'003 * scale + offset);
    EXPECT_EQ(std::stod(texts[2]), -7 * scale + offset);
    const Texts wild = scaled({5, 5, 5}, {1e300, 1e-300, 1e18}, {1e-10, 0, 1e-12});
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(std::isfinite(std::stod(wild[static_cast<size_t>(axis)])));
}

TEST(ExactPoint, FloatsAreWrittenSoThatTheyReadBackAndNoLonger) {
    io::Schema schema;
    schema.position = io::PositionType::f32;
    std::array<std::byte, 24> record;
    io::store(&record[0], 0.1f);
    io::store(&record[4], 123456.79f);
    io::store(&record[8], -1e-5f);
    EXPECT_EQ(coordinate_texts(schema, record.data()), (Texts{"0.1", "123456.79", "-0.00001"}));
    schema.position = io::PositionType::f64;
    io::store(&record[0], 0.1);
    io::store(&record[8], 5'400'000.123456789);
    io::store(&record[16], 1e30);
    const Texts texts = coordinate_texts(schema, record.data());
    EXPECT_EQ(texts[0], "0.1");
    EXPECT_EQ(texts[1], "5400000.123456789");
    EXPECT_EQ(std::stod(texts[2]), 1e30);
}

}  // namespace
}  // namespace lucarne::viewer
