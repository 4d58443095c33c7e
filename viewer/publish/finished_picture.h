#pragma once

#include <vector>

#include <glm/vec4.hpp>

#include "gi/scene/scene.h"
#include "io/image/image.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// How a picture is saved.
struct PictureFinish {
    bool transparent = false;  ///< no background: the opacity is the share of a pixel that shows points
    bool overlays = true;      ///< draw legend, axes and scale bar, as far as the scene's look requests them
};

/// Returns the pipeline's last frame as it is to be saved. Texts scale with the picture. Transparent averages
/// need FrameRequest::transparent.
io::Image8 finished_picture(const Pipeline& pipeline, const gi::SceneCamera& camera,
                            const PictureFinish& finish);

/// Returns the radiance of the pipeline's last frame without the background. The opacity is the share of a
/// pixel that shows points, by which the radiance is multiplied, as OpenEXR files have it.
std::vector<glm::vec4> transparent_radiance(const Pipeline& pipeline);

}  // namespace lucarne::viewer
