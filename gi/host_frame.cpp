#include "gi/host_frame.h"

#include <algorithm>
#include <cassert>

#include <glm/geometric.hpp>

#include "gi/gl_frame.h"
#include "gi/native/reflectance.h"
#include "gi/shared/gbuffer.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
std::vector<Surfel> download_light_surfels(const Frame& frame) {
    assert(frame.gl.cuts.light);
    return frame.gl.pool.download(*frame.gl.cuts.light);
}

std::vector<GBufferTexel> download_gbuffer(const Frame& frame) {
    const GBuffer& gbuffer = frame.gl.gbuffer;
    return gbuffer.texels.download_all<GBufferTexel>(size_t{gbuffer.width} * gbuffer.height);
}

namespace {

SurfacePoint visible_surface(const CameraView& camera, const GBufferTexel& texel, size_t number) {
    const vec2 pixel(static_cast<float>(number % camera.width), static_cast<float>(number / camera.width));
    SurfacePoint point;
    point.viewer = -glm::normalize(view_ray(camera, pixel + 0.5f));
    if (!(texel.depth > 0)) return point;
    point.position = texel_position(camera, pixel, texel);
    point.normal = texel_normal(texel);
    point.albedo = native::linear_albedo(texel.albedo);
    // A half float may have become 0 or infinite, but there is a surface.
    point.radius = std::clamp(texel_radius(texel), 1e-7f, 65504.0f);
    point.material = texel_material(texel);
    return point;
}

}  // namespace

std::vector<SurfacePoint> visible_surfaces(const CameraView& camera, std::span<const GBufferTexel> texels) {
    std::vector<SurfacePoint> points(texels.size());
    parallel_ranges(texels.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) points[i] = visible_surface(camera, texels[i], i);
    });
    return points;
}

std::vector<SurfacePoint> visible_surfaces(const CameraView& camera, std::span<const GBufferTexel> texels,
                                           std::span<const uint32_t> pixels) {
    std::vector<SurfacePoint> points(pixels.size());
    parallel_ranges(pixels.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            points[i] = visible_surface(camera, texels[pixels[i]], pixels[i]);
    });
    return points;
}

void upload_radiance(Frame& frame, std::span<const glm::vec4> radiance) {
    assert(radiance.size() == size_t{frame.gl.gbuffer.width} * frame.gl.gbuffer.height);
    frame.gl.radiance.upload(0, std::as_bytes(radiance));
}

TimedPass::TimedPass(Frame& frame, const char* name) : times_(frame.times) {
    times_.begin(name);
}

TimedPass::~TimedPass() {
    times_.end();
}

}  // namespace lucarne::gi
