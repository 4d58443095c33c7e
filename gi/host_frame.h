// What an engine needs that computes on the host: surfels and G-buffer from the device, radiance to it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/frame.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi {

/// The surfels of the frame's light cut, with their footprints. Waits for the device.
std::vector<Surfel> download_light_surfels(const Frame& frame);

/// The surface that each pixel of the picture shows, row 0 on top. Waits for the device.
std::vector<GBufferTexel> download_gbuffer(const Frame& frame);

/// A point of a surface that a pixel shows.
struct SurfacePoint {
    glm::vec3 position{0.0f};  ///< m, relative to the local origin
    glm::vec3 normal{0.0f};    ///< unit, toward the viewer
    glm::vec3 viewer{0.0f};  ///< unit, from the point to the viewer; set for pixels without a surface as well
    glm::vec3 albedo{0.0f};  ///< linear, before the material's scale
    float radius = 0;        ///< of its surfel, m; 0: there is no surface
    uint32_t material = 0;
};

/// Decodes download_gbuffer(): the surface of each pixel. Engines that light these differ in transport and
/// not in visibility.
std::vector<SurfacePoint> visible_surfaces(const CameraView& camera, std::span<const GBufferTexel> texels);

/// The same of some pixels, by their numbers.
std::vector<SurfacePoint> visible_surfaces(const CameraView& camera, std::span<const GBufferTexel> texels,
                                           std::span<const uint32_t> pixels);

/// Sets the radiance of all pixels (rgb W/(sr m^2), row 0 on top).
void upload_radiance(Frame& frame, std::span<const glm::vec4> radiance);

/// Times a pass of the frame under `name` for as long as it lives.
class TimedPass {
 public:
    TimedPass(Frame& frame, const char* name);
    ~TimedPass();
    TimedPass(const TimedPass&) = delete;
    TimedPass& operator=(const TimedPass&) = delete;

 private:
    PassTimes& times_;
};

/// Returns what `body` returns, and times it as a pass of the frame.
template <class Body>
auto timed(Frame& frame, const char* name, const Body& body) {
    const TimedPass pass(frame, name);
    return body();
}

}  // namespace lucarne::gi
