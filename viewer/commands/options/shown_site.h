#pragma once

#include "octree/tree/source.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

/// Returns what a scan shows, with a box and an outline that a view can be fitted to: the discs of few points
/// are inside, and a single point has a box of a metre. May block, as survey_site() does.
Site shown_site(const octree::NodeSource& source);

}  // namespace lucarne::viewer
