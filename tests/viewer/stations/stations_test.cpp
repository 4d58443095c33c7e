#include "viewer/stations/stations.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "gi/scene/views.h"
#include "tests/viewer/window/imgui_context.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

using testing::ElementsAre;

octree::SourceHeader with_stations(const std::vector<glm::dvec3>& places) {
    octree::SourceHeader header;
    header.scans.resize(2);
    for (size_t i = 0; i < places.size(); ++i)
        header.scans[i % 2].stations.push_back({static_cast<uint32_t>(i), places[i]});
    return header;
}

TEST(StationPlaces, AreEachOnceAndBounded) {
    EXPECT_THAT(station_places(with_stations({{1, 2, 3}, {4, 5, 6}, {1, 2, 3}})),
                ElementsAre(glm::dvec3(1, 2, 3), glm::dvec3(4, 5, 6)));
    std::vector<glm::dvec3> many;
    for (int i = 0; i < 20'000; ++i) many.emplace_back(i, 0, 0);
    EXPECT_EQ(station_places(with_stations(many)).size(), 500u);
    EXPECT_TRUE(station_places({}).empty());
}

/// A camera in a room of 10 m with one station 4 m ahead.
class StationSpots : public testing::Test {
 protected:
    StationSpots() {
        view_.site.kind = SiteKind::interior;
        view_.site.box = {glm::dvec3(0), glm::dvec3(10)};
        view_.site.inside.emplace();
        gi::SceneCamera camera;
        camera.position = {5, 1, 2};
        camera.target = {5, 3, 2};
        see(camera, 0);
        model_.places = {kPlace};
    }
    /// Shows a picture from there, whose surface is everywhere at one depth, m; 0: it is empty.
    void see(const gi::SceneCamera& camera, float depth) {
        view_.go_to(camera);
        auto picture = std::make_shared<Picture>();
        picture->size = {200, 100};
        picture->depth.assign(200 * 100, depth);
        const gi::LocalFrame local = gi::local_frame(camera.position, 1);
        picture->camera = gi::camera_view(camera, picture->size, local);
        picture->local_origin = local.origin;
        view_.picture = std::move(picture);
    }
    Stations stations() { return {view_, model_}; }
    /// Returns whether the spots took the mouse while its button was down.
    bool click(const ImVec2& at) {
        bool taken = false;
        for (const bool down : {false, true, false})
            imgui_.frame(at, down, [&] { taken |= take_station_spots(stations()); });
        return taken;
    }
    /// Finishes the glide.
    gi::SceneCamera arrived() {
        while (view_.advance(.2)) {
        }
        return view_.rig.camera();
    }

    static constexpr glm::dvec3 kPlace{5, 5, 2};
    const test::ImguiContext imgui_{ImVec2(400, 200)};
    View view_{10};
    StationModel model_;
};

TEST_F(StationSpots, AClickGoesThereAndKeepsTheDirectionOfTheView) {
    const glm::dvec3 ahead = view_.rig.forward();
    EXPECT_FALSE(click({300, 50})) << "beside the spot";
    EXPECT_TRUE(click({200, 100}));
    EXPECT_LT(glm::distance(arrived().position, kPlace), 1e-9);
    EXPECT_LT(glm::distance(view_.rig.forward(), ahead), 1e-9);
    see(arrived(), 0);
    EXPECT_FALSE(click({200, 100})) << "it stands there";
}

TEST_F(StationSpots, ADragFromOneTurnsTheView) {
    bool taken = false;
    for (const float x : {200.f, 200.f, 230.f, 260.f}) {
        imgui_.frame({x, 100}, true, [&] { taken = take_station_spots(stations()); });
    }
    EXPECT_FALSE(taken);
    imgui_.frame({200, 100}, false, [&] { taken = take_station_spots(stations()); });
    EXPECT_FALSE(view_.glide.under_way());
}

TEST_F(StationSpots, ThatAWallHidesOrTheUserHidesTakeNoClick) {
    see(view_.rig.camera(), 3);
    EXPECT_FALSE(click({200, 100}));
    see(view_.rig.camera(), 5);
    model_.shown = false;
    EXPECT_FALSE(click({200, 100}));
    model_.shown = true;
    EXPECT_TRUE(click({200, 100}));
}

TEST_F(StationSpots, FromOutsideOneEntersAndLooksAheadNotDown) {
    gi::SceneCamera above;
    above.position = {5, -5, 40};
    above.target = {5, 5, 2};
    see(above, 0);
    EXPECT_TRUE(click({200, 100}));
    EXPECT_LT(glm::distance(arrived().position, kPlace), 1e-9);
    EXPECT_TRUE(view_.inside());
    EXPECT_GT(view_.rig.forward().z, -.51);
    EXPECT_GT(view_.rig.forward().y, .8);
}

TEST_F(StationSpots, AreThoseOfTheOpenScans) {
    follow_stations(stations(), nullptr);
    EXPECT_FALSE(model_.places.empty()) << "there was no other source";
    model_.source = this;
    follow_stations(stations(), nullptr);
    EXPECT_TRUE(model_.places.empty());
}

}  // namespace
}  // namespace lucarne::viewer
