#pragma once

#include "gi/scene/scene.h"
#include "viewer/camera/fitting.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

/// Returns the camera that shows all of a site from outside, in the free part of the picture: objects from
/// the front left and above, terrain obliquely from the south.
gi::SceneCamera outside_view(const Site& site, const PictureShape& shape);
/// Returns the camera at the standing place, which looks along the room. Requires site.inside.
gi::SceneCamera inside_view(const Site& site, const PictureShape& shape);
/// Returns the camera of a person on the highest ground of a site, who looks to the side where most of it is,
/// a little down.
gi::SceneCamera ground_view(const Site& site, const PictureShape& shape);
/// Returns the camera that sees a site as the scanner did, where nothing is hidden from it: before it, if all
/// lies on one side of the scanner; else from the scanner to the side where most is. Requires site.station.
gi::SceneCamera station_view(const Site& site, const PictureShape& shape);
/// Returns the view that a scan opens with: of interiors from inside, of what was scanned from one place from
/// there, of others from outside.
gi::SceneCamera first_view(const Site& site, const PictureShape& shape);

/// Returns whether a camera looks at rooms from outside. Points that face away should not be drawn then
/// (FrameRequest::front_only): ceilings and near walls would hide the rooms.
bool looks_in_from_outside(const Site& site, const gi::SceneCamera& camera);

}  // namespace lucarne::viewer
