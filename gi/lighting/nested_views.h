#pragma once

#include "gi/frame.h"

namespace lucarne::gi {

class DeviceCut;

/// A nested view shows this share more than nested_view() (gi/shared/light.h) asks of it, for shadow look-ups
/// at its border.
inline constexpr float kNestedBorder = 1.0f / 16;

/// Sets in which nested views a directional light's shadows are drawn (cascaded shadow maps; Engel 2006): one
/// of all `bounds` and finer ones about the camera's `eye`, as long as texels of a view, which has
/// `resolution` of them along a side, are much wider than the points of `cut` are apart, and enough of these
/// points are near. In one view of a town, texels are metres wide. The middle of the finer views moves in
/// steps, so that they stay while the camera moves a little.
void set_nested_views(const glm::vec3& eye, const Bounds& bounds, const DeviceCut& cut, uint32_t resolution,
                      Light& light);

/// Returns the light as it is whatever views its shadows are drawn in: what rays find of it depends on no
/// view.
Light without_nested_views(Light light);

}  // namespace lucarne::gi
