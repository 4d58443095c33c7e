#pragma once

#include "viewer/frame/picture_worker.h"

namespace lucarne::viewer {

/// Returns whether hardly any of the points that a picture shows is lit: fewer than one in fifty is brighter
/// than a hundredth of white. False for a picture without points.
bool is_dark(const Picture& picture);

}  // namespace lucarne::viewer
