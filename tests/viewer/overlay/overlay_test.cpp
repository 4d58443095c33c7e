#include "viewer/overlay/overlay.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/overlay/axis_marks.h"
#include "viewer/overlay/draw_marks.h"
#include "viewer/style/clip_handles.h"

namespace lucarne::viewer {
namespace {

using glm::dvec3;
using testing::ElementsAre;

TEST(Overlay, NiceNumbersAreOneTwoOrFiveTimesAPowerOfTen) {
    EXPECT_DOUBLE_EQ(nice_at_most(1), 1);
    EXPECT_DOUBLE_EQ(nice_at_most(1.99), 1);
    EXPECT_DOUBLE_EQ(nice_at_most(2), 2);
    EXPECT_DOUBLE_EQ(nice_at_most(49), 20);
    EXPECT_DOUBLE_EQ(nice_at_most(0.0051), 0.005);
    EXPECT_DOUBLE_EQ(nice_at_most(1e9), 1e9);
    for (const double none : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_EQ(nice_at_most(none), 0);
    for (double most = 1e-6; most < 1e6; most *= 1.07) {
        const double nice = nice_at_most(most);
        EXPECT_LE(nice, most * (1 + 1e-9));
        EXPECT_GT(nice, most / 2.51);
    }
}

TEST(Overlay, TicksLieOnNiceNumbersWithinTheRange) {
    EXPECT_THAT(nice_marks(0, 10, 6), ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(nice_marks(402.3, 611.9, 5), ElementsAre(450, 500, 550, 600));
    EXPECT_THAT(nice_marks(-1, 1, 5), ElementsAre(-1, -0.5, 0, 0.5, 1));
    EXPECT_TRUE(nice_marks(3, 3, 5).empty());
    EXPECT_TRUE(nice_marks(5, 2, 5).empty());
    EXPECT_LE(nice_marks(1e15, 1e15 + 1, 5).size(), 50u) << "steps below a double's";
}

TEST(Overlay, ScaleBarsAreInTheScansUnitAndInMetres) {
    const auto metres = scale_bars(0.1, 1, 320);
    ASSERT_EQ(metres.size(), 1u);
    EXPECT_EQ(metres[0].text, "20 m");
    EXPECT_NEAR(metres[0].pixels, 200, 1e-9);
    const auto feet = scale_bars(0.1, 0.3048, 320);
    ASSERT_EQ(feet.size(), 2u);
    EXPECT_EQ(feet[0].text, "20 ft");
    EXPECT_EQ(feet[1].text, "5 m");
    EXPECT_NEAR(feet[1].pixels, 5 / 0.3048 / 0.1, 1e-9);
    EXPECT_EQ(scale_bars(1e-5, 1, 320)[0].text, "2 mm");
    EXPECT_EQ(scale_bars(10, 1, 320)[0].text, "2 km");
    EXPECT_TRUE(scale_bars(0, 1, 320).empty());
}

TEST(Overlay, AnEndOfTheLegendGoesWhereItIsDraggedAndKeepsClearOfTheOther) {
    const gi::ValueRange range{10, 30};
    EXPECT_EQ(dragged_range(range, RangeEnd::high, 0.5), (gi::ValueRange{10, 40}));
    EXPECT_EQ(dragged_range(range, RangeEnd::high, -0.25), (gi::ValueRange{10, 25}));
    EXPECT_EQ(dragged_range(range, RangeEnd::low, 0.5), (gi::ValueRange{20, 30}));
    EXPECT_EQ(dragged_range(range, RangeEnd::low, -1), (gi::ValueRange{-10, 30}));
    EXPECT_NEAR(dragged_range(range, RangeEnd::low, 7).low, 29.8, 1e-12);
    EXPECT_NEAR(dragged_range(range, RangeEnd::high, -7).high, 10.2, 1e-12);
    EXPECT_EQ(dragged_range({30, 10}, RangeEnd::high, 0.5), (gi::ValueRange{30, 0})) << "upside down";
    EXPECT_EQ(dragged_range({5, 5}, RangeEnd::high, 1), (gi::ValueRange{5, 7})) << "no range yet";
    EXPECT_EQ(dragged_range(range, RangeEnd::high, HUGE_VAL), range);
}

TEST(Overlay, TheLegendsBarStandsWhereItIsDrawnAndOnlyWhereColoursAreOfARange) {
    gi::Look look;
    look.legend = true;
    look.colour = gi::ColourBy::elevation;
    gi::ShownValues values;
    OverlayView view;
    view.size = {640, 480};
    EXPECT_FALSE(legend_bar(look, values, view)) << "no point has it";
    values.range = gi::ValueRange{0, 5};
    const auto bar = legend_bar(look, values, view);
    ASSERT_TRUE(bar);
    double top = 1e9, bottom = 0;
    for (const Mark& mark : overlay(look, values, view))
        if (mark.kind == Mark::Kind::area && mark.opacity == 1) {
            top = std::min(top, mark.from.y);
            bottom = std::max(bottom, mark.to.y);
            EXPECT_EQ(mark.from.x, bar->from.x);
            EXPECT_NEAR(mark.to.x, bar->to.x, 1e-9);
        }
    EXPECT_NEAR(top, bar->from.y, 1e-9);
    EXPECT_NEAR(bottom, bar->to.y, 1e-9);
    look.legend = false;
    EXPECT_FALSE(legend_bar(look, values, view));
    look.legend = true;
    look.colour = gi::ColourBy::classification;
    EXPECT_FALSE(legend_bar(look, values, view));
}

TEST(ClipHandles, ABoxTurnsWithItsCornerToWhereTheCursorIs) {
    gi::ClipBox box;
    box.min = {9, 19, 0};
    box.max = {11, 21, 4};
    const dvec3 down(0, 0, -1);
    const auto rotation = [&](double x, double y) { return turned_to(box, {x, y, 50}, down); };
    ASSERT_TRUE(rotation(11, 21));
    EXPECT_NEAR(*rotation(11, 21), 0, 1e-12) << "where it is";
    EXPECT_NEAR(*rotation(10, 25), M_PI / 4, 1e-12) << "from the corner at 45 degrees to straight ahead";
    EXPECT_NEAR(*rotation(13, 20), -M_PI / 4, 1e-12);
    box.rotation = *rotation(10, 25);
    gi::Clip clip;
    clip.boxes = {box};
    const dvec3 corner = handle_place(clip, {false, 0, ClipHandle::kCorner}).position;
    EXPECT_NEAR(glm::distance(corner, dvec3(10, 20 + std::sqrt(2.0), 4)), 0, 1e-12)
        << "the handle went along";
    EXPECT_FALSE(turned_to(box, {0, 0, 4}, {1, 1, 0})) << "level with it";
    EXPECT_FALSE(turned_to(box, {0, 0, 50}, {0, 0, 1})) << "away from it";
}

TEST(Overlay, AxesPointWhereTheCameraSeesThem) {
    gi::SceneCamera camera;  // from the origin along +y, z up
    const auto axes = axes_in(camera);
    EXPECT_NEAR(axes[0].place.x, 1, 1e-12);
    EXPECT_NEAR(axes[1].depth, 1, 1e-12);
    EXPECT_NEAR(axes[2].place.y, -1, 1e-12) << "up in the picture";
}

std::vector<std::string> texts(const gi::Look& look, const gi::ShownValues& values) {
    OverlayView view;
    view.size = {640, 480};
    view.distance = 10;
    std::vector<std::string> found;
    for (const Mark& mark : overlay(look, values, view))
        if (mark.kind == Mark::Kind::text) found.push_back(mark.text);
    return found;
}

TEST(Overlay, LegendsNameTheClassesThatThereAreAndAreNotHidden) {
    gi::Look look;
    look.legend = true;
    look.colour = gi::ColourBy::classification;
    look.hidden_classes.set(7);
    gi::ShownValues values;
    for (const size_t number : {2u, 6u, 7u}) values.numbers.set(number);
    EXPECT_THAT(texts(look, values), ElementsAre("Classification", "2 Ground", "6 Building"));
    look.legend = false;
    EXPECT_TRUE(texts(look, values).empty());
}

TEST(Overlay, LegendsOfARangeHaveNiceTicks) {
    gi::Look look;
    look.legend = true;
    look.colour = gi::ColourBy::elevation;
    gi::ShownValues values;
    values.range = gi::ValueRange{402, 611};
    EXPECT_THAT(texts(look, values), ElementsAre("Elevation", "450", "500", "550", "600"));
}

TEST(Overlay, MarksStayWithinAPictureHoweverFarTheyReach) {
    io::Image8 picture{16, 8, std::vector<uint8_t>(16 * 8 * 3, 10)};
    const std::vector<Mark> marks = {
        {Mark::Kind::area, {-1e12, -5}, {4, 1e12}, glm::vec3(1.0f), 1},
        {Mark::Kind::line, {-1e9, 1e9}, {1e9, -1e9}, glm::vec3(1.0f), 1},
        {Mark::Kind::text, {12, 5}, {}, glm::vec3(1.0f), 1, "beyond the edge \xff"},
    };
    draw_marks(marks, 2, picture);
    EXPECT_EQ(picture.bytes.size(), 16u * 8 * 3);
    for (size_t y = 0; y < 8; ++y) EXPECT_EQ(picture.bytes[3 * (y * 16 + 3)], 255);
    EXPECT_EQ(picture.bytes[3 * (0 * 16 + 10)], 10);
}

TEST(ClipHandles, MovingAFaceLeavesTheOppositeOneWhereItIs) {
    gi::Clip clip;
    clip.boxes.push_back({{1, 2, 3}, {5, 4, 9}, 0.7});
    for (int face = 0; face < 6; ++face) {
        gi::Clip moved = clip;
        const ClipHandle handle{false, 0, face}, opposite{false, 0, face ^ 1};
        const dvec3 before = handle_place(clip, handle).position;
        const HandlePlace still = handle_place(clip, opposite);
        move_handle(moved, handle, 0.5);
        EXPECT_NEAR(glm::distance(handle_place(moved, handle).position, before), 0.5, 1e-12);
        EXPECT_NEAR(glm::distance(handle_place(moved, opposite).position, still.position), 0, 1e-12) << face;
        move_handle(moved, handle, -100);
        EXPECT_LT(moved.boxes[0].min[face / 2], moved.boxes[0].max[face / 2]) << "never inside out";
    }
}

TEST(ClipHandles, AHandleFollowsTheRayThroughTheCursor) {
    const dvec3 origin(1, 2, 3), axis = glm::normalize(dvec3(1, 1, 0)), eye(-4, 6, 8);
    const dvec3 aim = origin + 2.5 * axis;
    EXPECT_NEAR(along_axis(origin, axis, eye, 3.0 * (aim - eye)).value_or(0), 2.5, 1e-9);
    EXPECT_FALSE(along_axis(origin, axis, eye, axis)) << "along the axis there is no nearest point";
}

}  // namespace
}  // namespace lucarne::viewer
