#include "viewer/stations/stations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <glm/geometric.hpp>
#include <imgui.h>

#include "viewer/opening/first_view.h"
#include "viewer/picking/pick.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostPlaces = 500;
constexpr double kHere = .5;        ///< m: a spot as near as this is where the camera stands
constexpr double kBehind = .02;     ///< share of the depth by which a surface may stand before a spot
constexpr float kSpot = 8;          ///< radius, to be scaled()
constexpr double kSteepest = .577;  ///< slope of a view from outside that is kept at the station

constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 230), kEdge = IM_COL32(20, 20, 20, 200),
                kChosen = IM_COL32(255, 140, 40, 255);

bool is_shown(const Stations& model) {
    return model.stations.shown;
}
void toggle_spots(const Stations& model) {
    model.stations.shown = !model.stations.shown;
}
bool has_places(const Stations& model) {
    return !model.stations.places.empty();
}

/// Draws one spot. Returns whether the mouse is on it.
bool draw_spot(const ImVec2& at, bool held) {
    const ImGuiIO& io = ImGui::GetIO();
    const float x = at.x - io.MousePos.x, y = at.y - io.MousePos.y, reach = scaled(1.5f * kSpot);
    const bool hovered = !io.WantCaptureMouse && x * x + y * y < reach * reach;
    const ImU32 colour = hovered || held ? kChosen : kWhite;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddCircle(at, scaled(kSpot), kEdge, 0, scaled(5));
    list.AddCircle(at, scaled(kSpot), colour, 0, scaled(2.5f));
    list.AddCircleFilled(at, scaled(2.5f), colour);
    return hovered;
}

bool are_spots_shown(const Stations& model) {
    const View& view = model.view;
    return model.stations.shown && view.picture && !view.glide.under_way() &&
           (view.inside() || looks_in_from_outside(view.site, view.rig.camera()));
}

}  // namespace

std::span<const Action<const Stations>> station_actions() {
    static constexpr std::array kActions = {Action<const Stations>{
        {GLFW_KEY_N, GLFW_MOD_SHIFT}, "View", "Stations", toggle_spots, has_places, is_shown}};
    return kActions;
}

std::vector<glm::dvec3> station_places(const octree::SourceHeader& header) {
    std::vector<glm::dvec3> all;
    for (const io::ScanInfo& scan : header.scans)
        for (const io::Station& station : scan.stations)
            if (std::ranges::find(all, station.position) == all.end() || all.size() > kMostPlaces)
                all.push_back(station.position);
    if (all.size() <= kMostPlaces) return all;
    std::vector<glm::dvec3> some;
    for (size_t i = 0; i < kMostPlaces; ++i) some.push_back(all[i * all.size() / kMostPlaces]);
    return some;
}

void follow_stations(const Stations& model, const octree::NodeSource* source) {
    if (std::exchange(model.stations.source, source) == source) return;
    model.stations.held.reset();
    model.stations.places = source ? station_places(source->header()) : std::vector<glm::dvec3>();
}

void go_to_station(const Stations& model, const glm::dvec3& place) {
    View& view = model.view;
    gi::SceneCamera camera = view.rig.camera();
    glm::dvec3 ahead = camera.target - camera.position;
    if (!view.inside()) {  // from above one would look at the floor
        const double across = std::hypot(ahead.x, ahead.y);
        ahead = across > 0 ? glm::dvec3(ahead.x, ahead.y, std::max(ahead.z, -kSteepest * across))
                           : glm::dvec3(0, view.scene_size, 0);
        if (view.site.inside) camera.vertical_fov = inside_view(view.site, {1, {}}).vertical_fov;
    }
    camera.position = place;
    camera.target = place + ahead;
    view.entered = true;
    view.glide_to(camera);
}

bool take_station_spots(const Stations& model) {
    StationModel& stations = model.stations;
    if (!are_spots_shown(model)) {
        stations.held.reset();
        return false;
    }
    const Picture& picture = *model.view.picture;
    std::optional<size_t> under;
    for (size_t i = 0; i < stations.places.size(); ++i) {
        const auto seen = project(picture, stations.places[i]);
        if (!seen || seen->depth < kHere || hidden(picture, *seen, kBehind)) continue;
        const auto at = on_screen(picture, stations.places[i]);
        if (at && draw_spot(*at, stations.held == i)) under = i;
    }
    if (under) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (under && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) stations.held = under;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left)) stations.held.reset();  // it turns the view
    if (!stations.held || ImGui::IsMouseDown(ImGuiMouseButton_Left)) return stations.held.has_value();
    if (stations.held == under) go_to_station(model, stations.places[*under]);
    stations.held.reset();
    return true;
}

}  // namespace lucarne::viewer
