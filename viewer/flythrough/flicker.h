#pragma once

#include <vector>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// What is kept of a frame until the next: what every pixel shows, and its radiance.
struct SeenFrame {
    gi::CameraView camera{};
    glm::dvec3 local_origin{0.0};
    double metres_per_unit = 1;
    std::vector<gi::GBufferTexel> texels;
    std::vector<glm::vec4> radiance;  ///< W/(sr m^2)
};
SeenFrame seen_frame(const Pipeline& pipeline);

/// How much the light of surfaces changes from one frame to the next, independently of the camera's motion. A
/// pixel of `now` is matched if `before` shows the same surface: the pixel's point is projected into
/// `before`; the point shown there is less than two pixel widths away from the tangent plane, and the normals
/// differ by less than 25 degrees. l is a pixel's luminance divided by the luminance of its albedo, so that
/// textures cancel. m is the mean of l over the matched pixels of both frames. Diffuse light does not depend
/// on the viewpoint: unless a light moves, any change is an error.
struct Flicker {
    double change = 0;   ///< mean over the matched pixels of 2 |l' - l| / (l' + l + m / 5)
    double matched = 0;  ///< share of the pixels that show something
};
Flicker flicker_between(const SeenFrame& before, const SeenFrame& now);

}  // namespace lucarne::viewer
