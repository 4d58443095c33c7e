#pragma once

#include <array>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::viewer {

/// The part of a picture that nothing covers: from -1 to 1, to the right and up.
struct FreePart {
    double left = -1, right = 1, bottom = -1, top = 1;
    bool operator==(const FreePart&) const = default;
};

/// A picture that points have to fit in.
struct PictureShape {
    double aspect = 4.0 / 3;  ///< width over height
    FreePart free;
};

/// The directions of a camera: unit vectors at right angles.
struct ViewAxes {
    glm::dvec3 right, up, forward;
};

/// Least side of a box that a camera looks at, m: a single point has no size.
inline constexpr double kLeastBox = 1;

/// Returns a box with `reach` around it; one whose sides are all shorter than `least` becomes a cube of that
/// side. World units.
std::array<glm::dvec3, 2> widened(const std::array<glm::dvec3, 2>& box, double reach, double least);

/// Returns the nearest position from which a perspective camera sees all points in the free part of its
/// picture, with a small margin, and in its middle. Points that are no numbers do not count. `span` (> 0) is
/// the least distance between two points that can be told apart.
glm::dvec3 fitting_position(std::span<const glm::dvec3> points, const ViewAxes& axes, double vertical_fov,
                            const PictureShape& shape, double span);

/// A parallel view.
struct ParallelFit {
    glm::dvec3 position;
    double height;  ///< of the picture, world units
};
/// The same for a parallel camera, which stands before all points.
ParallelFit parallel_fit(std::span<const glm::dvec3> points, const ViewAxes& axes, const PictureShape& shape,
                         double span);

}  // namespace lucarne::viewer
