// The first points of a file's parts are those that a pass over the file returns there.
#include <gmock/gmock.h>

#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::read_all;
using testing::TemporaryFolder;

TEST(Front, OfEachChunkOfALazFileIsWhatAPassReturns) {
    const TemporaryFolder folder;
    const auto path = folder / "a.laz";
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.stride = 12;
    constexpr int32_t kPoints = 120'000, kChunk = 50'000;
    std::vector<std::byte> records(size_t{kPoints} * schema.stride);
    for (int32_t i = 0; i < kPoints; ++i)
        for (int32_t axis = 0; axis < 3; ++axis)
            store(&records[static_cast<size_t>(i) * schema.stride + 4 * static_cast<size_t>(axis)],
                  i * (axis + 1) % 7919);
    const auto writer = create_scan(path, schema, {}, {});
    ASSERT_TRUE(writer) << writer.error().line();
    ASSERT_TRUE((*writer)->write(records) && (*writer)->finish());
    const auto scan = open_scan(path);
    ASSERT_TRUE(scan) << scan.error().line();
    ASSERT_EQ((*scan)->parts(), 3u);
    const auto all = read_all(**scan);
    ASSERT_TRUE(all);
    const size_t stride = (*scan)->schema().stride;
    for (const auto& [part, most, expected] :
         {std::tuple{0, 100, 100}, {1, 2048, 2048}, {2, 50'000, 20'000}}) {
        PointBatch batch;
        ASSERT_TRUE((*scan)->front(static_cast<size_t>(part), static_cast<size_t>(most), batch));
        ASSERT_EQ(batch.count, static_cast<size_t>(expected));
        const auto from = all->bytes.begin() +
                          static_cast<std::ptrdiff_t>(part) * kChunk * static_cast<std::ptrdiff_t>(stride);
        EXPECT_TRUE(
            std::equal(from, from + static_cast<std::ptrdiff_t>(batch.count * stride), batch.bytes.begin()))
            << "part " << part;
    }
}

TEST(Front, OfTheScansOfAnE57FileTogetherAreTheWholeFile) {
    if (testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    const auto scan = open_scan(testing::shared_data() / "e57/A_B.e57");
    ASSERT_TRUE(scan) << scan.error().line();
    ASSERT_GE((*scan)->parts(), 2u);
    const auto all = read_all(**scan);
    ASSERT_TRUE(all);
    std::vector<std::byte> joined;
    for (size_t part = 0; part < (*scan)->parts(); ++part) {
        PointBatch batch, some;
        ASSERT_TRUE((*scan)->front(part, all->count, batch));
        joined.insert(joined.end(), batch.bytes.begin(), batch.bytes.end());
        ASSERT_TRUE((*scan)->front(part, 1, some));
        EXPECT_EQ(some.count, std::min<size_t>(1, batch.count));
    }
    EXPECT_TRUE(joined == all->bytes);
}

}  // namespace
}  // namespace lucarne::io
