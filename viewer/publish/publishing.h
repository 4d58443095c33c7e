#pragma once

#include <span>

#include "viewer/publish/model.h"
#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// What the actions and panels of saved pictures and flythroughs act on.
struct Publishing {
    View& view;
    PublishModel& publish;
};

std::span<const Action<const Publishing>> publish_actions();

void draw_flythrough_panel(const Publishing& model);  ///< key frames, preview, rendering
void draw_picture_panel(const Publishing& model);     ///< a picture of any size
void draw_flythrough(const Publishing& model);        ///< the path, drawn over the picture

}  // namespace lucarne::viewer
