// Tests exports of what is seen, as the window makes them.
#include "viewer/publish/export_worker.h"

#include <gmock/gmock.h>

#include "octree/open.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

class ExportedPoints : public testing::Test {
 protected:
    ExportedPoints() {
        auto opened = octree::open_octree(test::make_cornell(folder_, "20k"));
        EXPECT_TRUE(opened);
        if (opened) order_.source = std::move(*opened);
    }
    /// Runs the order and returns its message, or the error's line.
    std::string run(const std::string& name) {
        order_.file = folder_ / name;
        ExportWorker* told = nullptr;
        ExportWorker worker([&] {
            if (cancels_) told->cancel();
        });
        told = &worker;
        EXPECT_TRUE(worker.start(order_));
        std::optional<Result<std::string>> outcome;
        EXPECT_TRUE(test::eventually([&] { return (outcome = worker.take_outcome()).has_value(); }));
        if (!outcome) return "";
        EXPECT_FALSE(worker.state().running);
        return *outcome ? **outcome : outcome->error().line();
    }
    uint64_t points_of(const std::string& name) const {
        const std::string said = test::lucarne("info " + (folder_ / name)).output;
        const size_t at = said.find("points");
        EXPECT_NE(at, said.npos) << said;
        std::string digits;
        for (const char c : said.substr(at, said.find('\n', at) - at))
            if (std::isdigit(static_cast<unsigned char>(c))) digits += c;
        return digits.empty() ? 0 : std::stoull(digits);
    }

    const test::TemporaryFolder folder_;
    ExportOrder order_;
    bool cancels_ = false;  ///< after the first part of the points
};

TEST_F(ExportedPoints, AreThoseThatAreSeen) {
    const uint64_t all = order_.source->header().points;
    EXPECT_THAT(run("all.las"), HasSubstr("exported " + std::to_string(all) + " of"));
    const glm::dvec3 middle = (order_.source->header().min + order_.source->header().max) / 2.0;
    order_.look.clip.planes.push_back({middle, {1, 0, 0}});
    ASSERT_THAT(run("half.laz"), HasSubstr("exported "));
    EXPECT_GT(points_of("half.laz"), all / 10);
    EXPECT_LT(points_of("half.laz"), all * 9 / 10);
    order_.every = 10;
    ASSERT_THAT(run("tenth.laz"), HasSubstr("exported "));
    EXPECT_EQ(points_of("tenth.laz"), (points_of("half.laz") + 9) / 10);
}

TEST_F(ExportedPoints, AreNoFileIfTheUserCancelsOrTheNameIsTaken) {
    cancels_ = true;
    for (const char* name : {"cancelled.laz", "cancelled.copc.laz", "cancelled.ply"}) {
        EXPECT_THAT(run(name), HasSubstr("was cancelled"));
        EXPECT_FALSE(std::filesystem::exists(folder_ / name));
    }
    cancels_ = false;
    std::ofstream(folder_ / "taken.laz") << "mine";
    EXPECT_THAT(run("taken.laz"), HasSubstr("taken.laz"));
    EXPECT_EQ(test::bytes_of(folder_ / "taken.laz"), "mine");
    order_.overwrite = true;
    cancels_ = true;
    EXPECT_THAT(run("taken.laz"), HasSubstr("was cancelled"));
    EXPECT_EQ(test::bytes_of(folder_ / "taken.laz"), "mine") << "replaced only by a whole file";
    cancels_ = false;
    EXPECT_THAT(run("taken.laz"), HasSubstr("exported "));
    EXPECT_GT(points_of("taken.laz"), 0u);
    EXPECT_THAT(run("unknown.xyw"), HasSubstr("unknown.xyw"));
}

}  // namespace
}  // namespace lucarne::viewer
