#include "viewer/camera/floor_finder.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/octree/plane_source.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne::viewer {
namespace {

TEST(FloorFinder, LooksAgainAfterMemoryHasRunOut) {
    const auto source = std::make_shared<octree::test::PlaneSource>(2, 100, 10.0);
    source->throw_at(0);
    FloorFinder finder;
    for (size_t looks = 1; looks < 4; ++looks)
        EXPECT_TRUE(test::eventually([&] {
            finder.look(source, {5.0 + static_cast<double>(looks), 5, 2}, 1.65);
            return source->order().size() >= looks;
        }));
    EXPECT_FALSE(finder.found());
}

}  // namespace
}  // namespace lucarne::viewer
