#pragma once

#include "gi/scene/scene.h"
#include "io/image/image.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// How a picture is to be saved.
struct PictureFinish {
    bool transparent = false;  ///< opacity 0 where no point is, instead of a background
    bool overlays = true;      ///< legend, axes and scale bar, as far as the scene's look asks for them
};

/// The pipeline's last frame as it is saved. Texts grow with the picture.
io::Image8 finished_picture(const Pipeline& pipeline, const gi::SceneCamera& camera,
                            const PictureFinish& finish);

/// The same for radiance: pixels of the last frame that show no point become 0 with opacity 0, the others 1.
void clear_where_nothing_is(const Pipeline& pipeline, io::Image& radiance);

}  // namespace lucarne::viewer
