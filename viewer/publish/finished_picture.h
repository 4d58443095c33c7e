#pragma once

#include "gi/scene/scene.h"
#include "io/image/image.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// How a picture is saved.
struct PictureFinish {
    bool transparent = false;  ///< opacity 0 where no point is, instead of a background
    bool overlays = true;      ///< draw legend, axes and scale bar, as far as the scene's look requests them
};

/// Returns the pipeline's last frame as it is to be saved. Texts scale with the picture.
io::Image8 finished_picture(const Pipeline& pipeline, const gi::SceneCamera& camera,
                            const PictureFinish& finish);

/// Clears radiance where the last frame shows no point: such pixels become 0 with opacity 0. The others get
/// opacity 1.
void clear_where_nothing_is(const Pipeline& pipeline, io::Image& radiance);

}  // namespace lucarne::viewer
