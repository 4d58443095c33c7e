#pragma once

#include <optional>
#include <span>

#include "viewer/opening/occupancy.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

/// Where one can stand in a grid.
struct Standing {
    std::optional<StandingPlace> best;  ///< in the largest room; empty if there is no room
    double enclosed_share = 0;  ///< of the places to stand: those with walls around and something above
};

/// Looks for floors with room for a person above them, and for the place among those in rooms from which most
/// of the floor is seen. From there it steps back along the room, to see all of it. Where a scanner stood in
/// that room, at about the height of an eye, and the view is nearly as wide, the place is the scanner's: what
/// hid parts of the room from it hides them from the viewer, too.
Standing find_standing_place(const OccupancyGrid& grid, double metres_per_unit,
                             std::span<const glm::dvec3> stations = {});

}  // namespace lucarne::viewer
