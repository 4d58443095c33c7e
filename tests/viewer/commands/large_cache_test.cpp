// Caches whose directory is read page by page, as a user sees them.
#include "tests/octree/cache/large_cache.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/octree/cache/paged_cache.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using test::bytes_of;
using test::lucarne;
using testing::HasSubstr;

constexpr uint64_t kMemory = uint64_t{48} << 20;

TEST(LargeCacheCommands, ACacheOfTenToTheElevenPointsIsDescribedAndDrawnInLittleMemory) {
    const test::TemporaryFolder folder;
    const std::string cache = folder / "large.luc", json = folder / "r.json";
    const auto header = test::write_large_cache(cache);
    if (!header) GTEST_SKIP() << header.error().line();
    const auto info = lucarne("info " + cache);
    EXPECT_EQ(info.code, 0) << info.output;
    EXPECT_THAT(info.output, HasSubstr(fmt::format("{}", header->points)));
    const auto drawn =
        lucarne("render " + cache + " --size 96x72 --engine direct --preset preview --memory 48M" +
                " --json " + json + " -o " + (folder / "p.png"));
    ASSERT_EQ(drawn.code, 0) << drawn.output;
    const auto figures = nlohmann::json::parse(bytes_of(json));
    EXPECT_GT(figures.at("mean_luminance").get<double>(), 0);
    EXPECT_LE(figures.at("memory").at("used").get<uint64_t>(), kMemory);
}

/// Pages change how a directory is read, not what is seen, measured or written.
TEST(LargeCacheCommands, PagesOfADirectoryChangeNothingThatIsSaid) {
    const test::TemporaryFolder folder;
    const std::string cache = folder / "a.luc";
    ASSERT_EQ(lucarne("generate cornell --points 60k -o " + (folder / "a.las")).code, 0);
    ASSERT_EQ(lucarne("convert " + (folder / "a.las") + " -o " + cache).code, 0);
    const std::string before = lucarne("info " + cache).output;
    ASSERT_TRUE(test::give_pages(cache, 8));
    EXPECT_EQ(lucarne("info " + cache).output, before);
    EXPECT_EQ(lucarne("verify " + cache).code, 0);
    ASSERT_EQ(lucarne("generate cornell --points 20k -o " + (folder / "b.las")).code, 0);
    ASSERT_EQ(lucarne("convert " + (folder / "b.las") + " -o " + cache + " --append").code, 0);
    EXPECT_EQ(lucarne("verify " + cache).code, 0);
    EXPECT_EQ(lucarne("compact " + cache).code, 0);
    EXPECT_EQ(lucarne("verify " + cache).code, 0);
}

}  // namespace
}  // namespace lucarne::viewer
