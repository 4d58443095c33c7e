#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"
#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// The places where a scanner stood, which the window shows as spots to go to.
struct StationModel {
    bool shown = true;
    std::vector<glm::dvec3> places;  ///< world units
    std::optional<size_t> held;      ///< the spot on which the mouse button was pressed
    const void* source = nullptr;    ///< whose places these are; only compared
};

/// What the actions and the overlay of stations act on.
struct Stations {
    View& view;
    StationModel& stations;
};

std::span<const Action<const Stations>> station_actions();

/// Returns the places of a source's stations, each once: at most 500, spread over all of them, since a
/// scanner on a vehicle has one for each profile.
std::vector<glm::dvec3> station_places(const octree::SourceHeader& header);
/// Takes the places of another source. Call when the source may have changed; null: there is none.
void follow_stations(const Stations& model, const octree::NodeSource* source);

/// Draws the spots that the picture shows, if the camera is in a room or looks into one from outside, and
/// lets a click go to one. Returns true while the mouse holds one; a drag lets go of it.
bool take_station_spots(const Stations& model);
/// Moves the camera to a place smoothly. In a room it keeps the direction of its view; from outside it looks
/// ahead.
void go_to_station(const Stations& model, const glm::dvec3& place);

}  // namespace lucarne::viewer
