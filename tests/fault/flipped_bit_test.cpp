// One flipped bit anywhere in a cache is found by verify and never read as a point.
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/cache/format.h"
#include "tests/fault/run_lucarne.h"
#include "tests/octree/test_sources.h"

namespace lucarne {
namespace {

using io::testing::read_bytes;
using io::testing::write_bytes;
using test::lucarne;
using test::quoted;

class FlippedBit : public testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate cornell --even --points 20k -o " + quoted(folder_ / "a.las")).code, 0);
        const auto built = lucarne("convert " + quoted(folder_ / "a.las") + " -o " + quoted(sound_));
        ASSERT_EQ(built.code, 0) << built.text;
        bytes_ = read_bytes(sound_);
    }
    void flip(size_t at, uint32_t bit) const {
        std::string bytes = bytes_;
        bytes[at] = static_cast<char>(bytes[at] ^ (1u << bit));
        write_bytes(damaged_, bytes);
    }

    const test::TempFolder folder_;
    const std::filesystem::path sound_ = folder_ / "a.luc", damaged_ = folder_ / "b.luc";
    std::string bytes_;
};

TEST_F(FlippedBit, AnywhereIsFoundByVerifyAndGivesNoWrongPoint) {
    const auto sound = octree::open_cache(sound_);
    ASSERT_TRUE(sound);
    std::vector<octree::NodeData> right;
    for (uint32_t node = 0; node < (*sound)->nodes().size(); ++node) {
        auto data = (*sound)->load(node);
        ASSERT_TRUE(data);
        right.push_back(std::move(*data));
    }
    Random random(3);
    size_t unreadable = 0, kept = 0;
    for (int round = 0; round < 1500; ++round) {
        // Half of the bits are in small structures: superblocks, metadata and directory.
        const size_t at = round % 4 == 0   ? random.next() % octree::format::kFirstPayload
                          : round % 4 == 1 ? bytes_.size() - 1 - random.next() % 2000
                                           : random.next() % bytes_.size();
        flip(at, static_cast<uint32_t>(random.next() % 8));
        ASSERT_FALSE(octree::verify_cache(damaged_, [](uint64_t) {})) << at;
        const auto cache = octree::open_cache(damaged_);
        if (!cache) {
            ++unreadable;
            continue;
        }
        for (uint32_t node = 0; node < right.size(); ++node) {
            const auto data = (*cache)->load(node);
            unreadable += !data;
            ASSERT_TRUE(!data || data->records == right[node].records) << "byte " << at << ", node " << node;
        }
        ++kept;
    }
    EXPECT_GT(unreadable, 500u);
    EXPECT_GT(kept, 500u);
}

TEST_F(FlippedBit, InANodeMakesRenderVerifyExportAndCompactFailWithItsName) {
    const auto payload = octree::format::kFirstPayload + 100;
    flip(payload, 3);
    for (const std::string& command :
         {"verify " + quoted(damaged_), "export " + quoted(damaged_) + " -o " + quoted(folder_ / "c.las"),
          "compact " + quoted(damaged_),
          // A camera that sees all nodes: the first view of a room does not.
          "render " + quoted(damaged_) +
              " --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json --engine unlit --size 64x64 -o " +
              quoted(folder_ / "c.png")}) {
        const auto outcome = lucarne(command);
        EXPECT_EQ(outcome.code, 3) << command << '\n' << outcome.text;
        EXPECT_NE(outcome.text.find("does not match its checksum"), std::string::npos) << outcome.text;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "c.png"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "c.las"));
}

}  // namespace
}  // namespace lucarne
