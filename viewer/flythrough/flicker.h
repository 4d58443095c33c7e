#pragma once

#include <vector>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// A frame as it is remembered until the next: what every pixel shows, and its light.
struct SeenFrame {
    gi::CameraView camera{};
    glm::dvec3 local_origin{0.0};
    double metres_per_unit = 1;
    std::vector<gi::GBufferTexel> texels;
    std::vector<glm::vec4> radiance;  ///< W/(sr m^2)
};
SeenFrame seen_frame(const Pipeline& pipeline);

/// How much the light of surfaces changes from a frame to the next, whatever way the camera moves. A pixel of
/// `now` is matched where `before` shows the same surface: the point seen is projected into `before`; the
/// point that the pixel there shows lies off the tangent plane by less than two pixels are wide, and its
/// normal within 25 degrees. l is a pixel's luminance over that of its albedo, so that textures drop out; m
/// the mean of l over the matched pixels of both frames. Diffuse light does not depend on where it is seen
/// from: unless a light moves, what is left is error.
struct Flicker {
    double change = 0;   ///< mean over the matched pixels of 2 |l' - l| / (l' + l + m / 5)
    double matched = 0;  ///< share of the pixels that show something
};
Flicker flicker_between(const SeenFrame& before, const SeenFrame& now);

}  // namespace lucarne::viewer
