#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/picture_worker.h"
#include "viewer/picking/exact_point.h"
#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

/// The projection of a world point into a picture.
struct Projection {
    glm::dvec2 pixel{0.0};  ///< from the top left corner; pixel centres at .5
    double depth = 0;       ///< m along the camera's forward axis
};
/// Projects a world point. Returns nothing behind the camera. Up to rounding, this is the inverse of
/// Picture::pick.
std::optional<Projection> project(const Picture& picture, const glm::dvec3& world);

/// Returns whether the picture's surface hides a point: whether it shows something nearer by more than
/// `slack`, a share of the depth. False outside the picture.
bool hidden(const Picture& picture, const Projection& point, double slack = 0.005);

/// A point that a picture shows.
struct PickedPoint {
    gi::PointPlace place;
    ExactPoint point;
};

/// Returns the point of the scan at a place of the picture (shares of its width and height from the top
/// left): the point whose surfel the pixel shows, or the nearest visible one within a few pixels. A point is
/// visible if its surfel is seen at the point's own pixel. Where there is no such point (discs of few points
/// cover each other's centres), returns the point of a seen disc whose centre only the same surface covers:
/// the one nearest to the seen place. Points behind another surface, outside the cut or clipped are never
/// taken, because the picture contains no ids of them. Reads nodes, so it may block. `cache` must belong to
/// the picture's source. Returns nothing if nothing is visible there. Errors: a node cannot be read.
Result<std::optional<PickedPoint>> pick_point(const Picture& picture, const glm::dvec2& place,
                                              NodeCache& cache);

}  // namespace lucarne::viewer
