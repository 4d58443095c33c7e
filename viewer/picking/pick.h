#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/picture_worker.h"
#include "viewer/picking/exact_point.h"
#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

/// Where a world point stands in a picture.
struct Projection {
    glm::dvec2 pixel{0.0};  ///< from the top left corner; pixel centres at .5
    double depth = 0;       ///< m along the camera's forward axis
};
/// None behind the camera. Errors of floats aside, the inverse of Picture::pick.
std::optional<Projection> project(const Picture& picture, const glm::dvec3& world);

/// What the picture's surface hides: true where it shows something nearer than the point by more than
/// `slack`, a share of the depth. False outside the picture.
bool hidden(const Picture& picture, const Projection& point, double slack = 0.005);

/// A point that a picture shows.
struct PickedPoint {
    gi::PointPlace place;
    ExactPoint point;
};

/// The point of the scan at a place of the picture (shares of its width and height from the top left): that
/// whose surfel the pixel there shows, or the nearest of those within a few pixels. Only points whose own
/// place in the picture shows them are taken, so none that lies behind a surface, outside the cut, or was
/// clipped: the picture has no id of those. Reads the points' nodes, and so may block. `cache` is of the
/// picture's source. Empty: nothing is seen there. Errors: a node that cannot be read.
Result<std::optional<PickedPoint>> pick_point(const Picture& picture, const glm::dvec2& place,
                                              NodeCache& cache);

}  // namespace lucarne::viewer
