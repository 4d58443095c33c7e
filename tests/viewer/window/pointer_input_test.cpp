#include "viewer/window/pointer_input.h"

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

TEST(PointerInput, ADragWithinOneFrameBeginsWhereItWasPressedAndEndsWhereItWasReleased) {
    PointerInput pointer;
    pointer.move(10, 20);
    pointer.set_button(0, true, {1.0, 1.0});
    for (int i = 1; i <= 50; ++i) pointer.move(10 + i, 20);
    pointer.set_button(0, false, {1.1, 1.1});
    pointer.move(500, 500);

    PointerInput::State frame = pointer.next();
    EXPECT_EQ(frame.x, 10);
    EXPECT_FALSE(frame.down[0]);
    frame = pointer.next();
    EXPECT_EQ(frame.x, 10);
    EXPECT_TRUE(frame.down[0]);
    frame = pointer.next();
    EXPECT_EQ(frame.x, 60) << "motions become one";
    EXPECT_TRUE(frame.down[0]) << "the button is still held while the mouse moves";
    frame = pointer.next();
    EXPECT_EQ(frame.x, 60);
    EXPECT_FALSE(frame.down[0]);
    EXPECT_TRUE(pointer.pending());
    frame = pointer.next();
    EXPECT_EQ(frame.x, 500);
    EXPECT_FALSE(pointer.pending());
    EXPECT_EQ(pointer.next().x, 500) << "without events nothing changes";
}

TEST(PointerInput, PressesAreADoubleClickByTheirOwnTimesAndNotByThoseOfFrames) {
    PointerInput pointer;
    for (const double at : {5.0, 5.2, 7.0}) {
        pointer.set_button(0, true, {at, at});
        pointer.set_button(0, false, {at + 0.05, at + 0.05});
    }
    for (const bool soon : {false, true, false}) {
        const PointerInput::State press = pointer.next();
        EXPECT_TRUE(press.down[0]);
        EXPECT_EQ(press.soon, soon);
        const PointerInput::State release = pointer.next();
        EXPECT_FALSE(release.down[0]);
        EXPECT_FALSE(release.soon);
    }
}

TEST(PointerInput, PressesThatFramesReceivedLateAreADoubleClickIfTheyMayHaveBeenOne) {
    PointerInput pointer;
    pointer.set_button(0, true, {5.0, 5.6});
    pointer.set_button(0, true, {5.6, 6.2});
    pointer.set_button(0, true, {6.6, 7.0});
    EXPECT_FALSE(pointer.next().soon);
    EXPECT_TRUE(pointer.next().soon);
    EXPECT_FALSE(pointer.next().soon) << "at least .4 s later";
}

TEST(PointerInput, HoldsFewEventsHoweverManyComeAndEndsInTheirState) {
    PointerInput pointer;
    for (int i = 0; i < 100'000; ++i) {
        pointer.move(i, i);
        pointer.set_button(static_cast<size_t>(i % 7), i % 2 == 0, {double(i), double(i)});
    }
    pointer.set_button(2, true, {1e6, 1e6});
    size_t frames = 0;
    PointerInput::State last;
    while (pointer.pending()) last = pointer.next(), ++frames;
    EXPECT_LE(frames, 64u);
    EXPECT_EQ(last.x, 99'999);
    EXPECT_TRUE(last.down[2]);
    pointer.clear();
    EXPECT_FALSE(pointer.next().down[2]);
}

}  // namespace
}  // namespace lucarne::viewer
