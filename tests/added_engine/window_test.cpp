// The added engine in a real window (see tests/viewer/window/window_fixture.h), of a program whose list of
// engines has it.
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;

/// Returns the share of pixels that are blue and nothing else.
double blue(const io::Image8& image) {
    const auto& bytes = image.bytes;
    size_t count = 0;
    for (size_t i = 0; i + 2 < bytes.size(); i += 3)
        count += bytes[i] < 40 && bytes[i + 1] < 40 && bytes[i + 2] > 150;
    return static_cast<double>(3 * count) / static_cast<double>(bytes.size());
}

using AddedEngineWindow = ViewerWindow;

TEST_F(AddedEngineWindow, ShowsItsPictureAndKeepsWhatItHasComputed) {
    engine_ = " --engine paint --tint 0,0,1";
    start();
    const auto painted = picture([](const io::Image8& now) { return blue(now) > .05; });
    ASSERT_TRUE(painted) << "the box is not blue";
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(cache_ + ".paint.bake"); })) << log();
    viewer_.reset();
    engine_ += " --pattern mean";
    start();
    EXPECT_TRUE(picture([&](const io::Image8& now) {
        return blue(now) == 0 && difference(now, *painted) > 2;
    })) << "the walls are white, red and green: their mean is no blue";
}

}  // namespace
}  // namespace lucarne
