// The benchmark's cloud has the statistics it claims.
#include <algorithm>
#include <array>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/parallel.h"
#include "io/synthetic/synthetic.h"

namespace lucarne::io {
namespace {

SyntheticOptions survey(uint64_t points) {
    SyntheticOptions options;
    options.scene = "survey";
    options.points = points;
    return options;
}

std::vector<std::byte> records_of(const SyntheticOptions& options, size_t most) {
    const auto reader = synthetic_source(options).value()->open().value();
    std::vector<std::byte> all;
    PointBatch batch;
    while (reader->read(batch, most).value() > 0)
        all.insert(all.end(), batch.bytes.begin(), batch.bytes.end());
    return all;
}

TEST(SyntheticSurvey, BytesDependNeitherOnThreadsNorOnBatches) {
    const auto all = records_of(survey(100'000), 4096);
    const ThreadLimit limit(1);
    EXPECT_EQ(records_of(survey(100'000), 777), all);
    auto other = survey(100'000);
    other.seed = 2;
    EXPECT_NE(records_of(other, 4096), all);
}

TEST(SyntheticSurvey, ScansALineAfterTheOtherWithTenNoisyBitsOfIntensityAndWildRanges) {
    const auto options = survey(1'000'000);
    const auto source = synthetic_source(options).value();
    const auto& schema = source->schema();
    const auto records = records_of(options, 65536);
    const auto count = records.size() / schema.stride;
    EXPECT_NEAR(static_cast<double>(count), 1e6, 2e4);
    const auto* intensity = schema.find(names::intensity);
    const auto* color = schema.find(names::color);
    std::array<double, 16> ones{};
    size_t near = 0, wild = 0, same_color = 0;
    for (size_t i = 1; i < count; ++i) {
        const std::byte *before = &records[(i - 1) * schema.stride], *at = before + schema.stride;
        for (size_t bit = 0; bit < 16; ++bit) ones[bit] += load<uint16_t>(at + intensity->offset) >> bit & 1;
        const auto p = position_of(schema, at);
        near += glm::distance(p, position_of(schema, before)) < 1;
        wild += glm::distance(p, glm::dvec3(125, 150, 5)) > 400;
        same_color += std::equal(at + color->offset, at + color->offset + 3, before + color->offset);
    }
    for (size_t bit = 0; bit < 16; ++bit)
        EXPECT_NEAR(ones[bit] / static_cast<double>(count), bit < 10 ? .5 : 0., .003) << bit;
    EXPECT_GT(near, count * 9 / 10) << "a scanner goes from neighbour to neighbour";
    EXPECT_GT(wild, 0u);
    EXPECT_LT(wild, 100u);
    EXPECT_LT(same_color, count / 50) << "cameras are noisy";
}

TEST(SyntheticSurvey, HasNoSurfaceToSampleAndSaysSo) {
    auto options = survey(1000);
    options.even = true;
    const auto source = synthetic_source(options);
    ASSERT_FALSE(source);
    EXPECT_EQ(source.error().kind, ErrorKind::arguments);
    EXPECT_NE(source.error().line().find("--even"), std::string::npos);
}

}  // namespace
}  // namespace lucarne::io
