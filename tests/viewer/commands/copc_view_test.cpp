// COPC files as a user sees them: drawn directly, described, joined with other inputs, and written.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using test::bytes_of;
using test::lucarne;
using test::Outcome;
using testing::HasSubstr;
using testing::Not;

class CopcView : public testing::Test {
 protected:
    void SetUp() override {
        expect_done("generate cornell --points 120k -o " + scan_);
        expect_done("convert " + scan_ + " -o " + cache_);
        expect_done("export " + cache_ + " -o " + copc_);
    }
    static std::string expect_done(const std::string& arguments) {
        const Outcome outcome = lucarne(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.output;
        return outcome.output;
    }
    /// Returns the mean luminance of a picture of `input`.
    double light_of(const std::string& input, const std::string& engine) {
        const std::string json = folder_ / "r.json";
        expect_done("render " + input + " --size 128x96 --overwrite --engine " + engine + " --json " + json +
                    " -o " + (folder_ / "p.exr"));
        return nlohmann::json::parse(bytes_of(json)).at("mean_luminance").get<double>();
    }
    /// Returns the line with the number of points in the cache's description.
    std::string points_line() {
        const std::string said = expect_done("info " + cache_);
        const size_t begin = said.find("points");
        return said.substr(begin, said.find('\n', begin) - begin + 1);
    }
    size_t files() const {
        return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
    }

    test::TemporaryFolder folder_;
    std::string scan_ = folder_ / "a.las", cache_ = folder_ / "a.luc", copc_ = folder_ / "b.copc.laz";
};

TEST_F(CopcView, IsDrawnWithoutConversionInTheLightOfItsCache) {
    const size_t before = files();
    const std::string said = expect_done("render " + copc_ + " --size 96x72 -o " + (folder_ / "p.png"));
    EXPECT_THAT(said, Not(HasSubstr("converting")));
    EXPECT_EQ(files(), before + 1) << "nothing is kept";
    for (const char* engine : {"direct", "vpl"}) {
        const double cache = light_of(cache_, engine);
        EXPECT_GT(cache, 0);
        EXPECT_NEAR(light_of(copc_, engine) / cache, 1.0, 0.1) << engine;
    }
}

TEST_F(CopcView, IsFlownThrough) {
    const std::string path = folder_ / "path.json";
    std::ofstream(path) << R"({"frames_per_second": 2, "keys": [
        {"time": 0, "position": [2.75, 0.4, 2.75], "target": [2.75, 5.0, 2.4]},
        {"time": 1, "position": [1.0, 0.6, 3.2], "target": [3.2, 4.0, 1.6]}]})";
    const std::string report = folder_ / "f.json";
    expect_done("fly " + copc_ + " --path " + path + " --size 64x48 --wait --engine direct -o " + report);
    EXPECT_THAT(bytes_of(report), HasSubstr("\"frames\""));
}

TEST_F(CopcView, InfoTellsOfItsNodes) {
    const std::string said = expect_done("info " + copc_);
    EXPECT_THAT(said, HasSubstr("copc"));
    EXPECT_THAT(said, HasSubstr(points_line()));
    EXPECT_THAT(said, HasSubstr("levels"));
}

TEST_F(CopcView, IsJoinedWithCachesAndConvertedAsALaz) {
    expect_done("render " + copc_ + " " + cache_ + " --size 64x48 --engine direct -o " + (folder_ / "p.png"));
    expect_done("convert " + copc_ + " -o " + (folder_ / "c.luc"));
    EXPECT_THAT(expect_done("info " + (folder_ / "c.luc")), HasSubstr(points_line()));
}

TEST_F(CopcView, OneThatLiesIsRefusedInOneLine) {
    std::string bytes = bytes_of(copc_);
    uint64_t page = 0;
    std::memcpy(&page, &bytes[375 + 54 + 40], sizeof page);
    bytes[page + 28] ^= 1;  // the root's number of points
    std::ofstream(copc_, std::ios::binary) << bytes;
    const Outcome refused = lucarne("render " + copc_ + " --size 64x48 -o " + (folder_ / "p.png"));
    EXPECT_EQ(refused.code, 3) << refused.output;
    EXPECT_THAT(refused.output, HasSubstr("in its hierarchy"));
}

}  // namespace
}  // namespace lucarne::viewer
