// OpenCL that fails while a picture is made: one line tells what is wrong, the program ends with status 1 and
// leaves nothing behind, and engines without OpenCL go on.
#include <sstream>

#include <gtest/gtest.h>

#include "tests/fault/run_lucarne.h"
#include "tests/temporary_folder.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using test::lucarne;
using test::lucarne_with_fault;
using test::Outcome;
using test::quoted;

class OpenClFaults : public ::testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        const auto scan = quoted(folder_ / "a.ply");
        ASSERT_EQ(lucarne("generate cornell --points 2k --normals -o " + scan).code, 0);
        ASSERT_EQ(lucarne("convert " + scan + " -o " + quoted(cache_)).code, 0);
        const Outcome whole = render(GetParam(), "");
        if (whole.text.find("OpenCL: no device") != std::string::npos) GTEST_SKIP() << whole.text;
        ASSERT_EQ(whole.code, 0) << whole.text;
        fs::remove(picture_);
    }
    Outcome render(const std::string& engine, const std::string& fault) const {
        return lucarne_with_fault("",
                                  "render " + quoted(cache_) + " --size 16x16 --mood evening --engine " +
                                      engine + " -o " + quoted(picture_),
                                  "LUCARNE_CL_FAULT=" + fault);
    }
    /// Expects that the picture fails with a line that contains `what`.
    void expect_error(const std::string& fault, const std::string& what) const {
        const auto files = std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator());
        const Outcome ran = render(GetParam(), fault);
        EXPECT_EQ(ran.code, 1) << fault << ": " << ran.text;
        std::istringstream lines(ran.text);
        int telling = 0;
        for (std::string line; std::getline(lines, line);)
            telling += line.starts_with("lucarne: ") && line.find(what) != std::string::npos;
        EXPECT_EQ(telling, 1) << fault << ": " << ran.text;
        EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), files)
            << fault;
    }

    const test::Folder folder_;
    const fs::path cache_ = folder_ / "a.luc", picture_ = folder_ / "a.png";
};

TEST_P(OpenClFaults, AreOneLine) {
    expect_error("build", "gi/gather/gather.cl");
    for (const int call : {1, 4, 12})
        expect_error("buffer:" + std::to_string(call), "the OpenCL device has no ");
    for (const int call : {1, 3, 9}) expect_error("kernel:" + std::to_string(call), "the OpenCL device");
    const Outcome other = render("direct", "kernel:1");
    EXPECT_EQ(other.code, 0) << other.text;
}

INSTANTIATE_TEST_SUITE_P(, OpenClFaults, ::testing::Values("micro", "environment"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace lucarne
