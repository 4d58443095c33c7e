// Light G-buffers made by hand, for tests of seeding.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/gbuffer.h"
#include "gi/shared/surfel_code.h"
#include "tests/gi/engines/surfel_cloud.h"

namespace lucarne::gi::vpl::testing {

/// A spot at the origin that looks down (-z), seen through a square view around its cone.
struct SpotSight {
    Light spot;
    CameraView view;
};

inline SpotSight downward_spot(uint32_t resolution, float half_angle, float cos_inner, float intensity) {
    const float t = std::tan(half_angle);
    SpotSight v;
    v.spot = {glm::vec4(0, 0, 0, std::cos(half_angle)), glm::vec4(0, 0, -1, cos_inner), glm::vec4(intensity)};
    v.view = {glm::vec4(0, 0, 0, .001f),
              glm::vec4(0, 0, -1, 0),
              glm::vec4(t, 0, 0, 0),
              glm::vec4(0, t, 0, 0),
              resolution,
              resolution,
              0,
              0};
    return v;
}

inline glm::vec3 ray_of(const CameraView& view, float x, float y) {
    const float u = 2 * x / static_cast<float>(view.width) - 1,
                v = 2 * y / static_cast<float>(view.height) - 1;
    return glm::vec3(view.right.x * u, -view.up.y * v, -1);
}

inline uint32_t encode_grey(float albedo) {
    const auto code = static_cast<uint32_t>(linear_to_srgb(albedo) * 1023 + .5f);
    return code | code << 10 | code << 20;
}

/// Returns a texel of the plane z = -height, facing the light.
inline GBufferTexel floor_texel(float height, float albedo) {
    return {height, encode_octahedral(glm::vec3(0, 0, 1)), encode_grey(albedo), 0};
}

/// What seed_lights makes of the texels for the given points.
inline Result<std::vector<VplLight>> seed_on(Device& device, const SpotSight& light,
                                             const std::vector<GBufferTexel>& texels,
                                             const std::vector<Material>& materials,
                                             const std::vector<glm::vec2>& points) {
    GBuffer gbuffer;
    gbuffer.width = light.view.width;
    gbuffer.height = light.view.height;
    LUCARNE_ASSIGN(gbuffer.texels, device.buffer(texels.size() * sizeof(GBufferTexel), "light G-buffer"));
    gbuffer.texels.upload_all(texels);
    LUCARNE_ASSIGN(gbuffer.ids, device.buffer(texels.size() * sizeof(uint32_t), "light ids"));
    gbuffer.ids.clear(kNoSurfel);
    Buffer material_buffer;
    LUCARNE_TRY(upload_materials(device, materials, material_buffer));
    const SurfelCloud nothing(std::vector<Surfel>{});
    LUCARNE_ASSIGN(const auto loaded, load_cloud(device, nothing));
    Seeds seeds;
    const LightGBuffer view{light.spot, 0, light.view, loaded->cut, gbuffer};
    Buffer importance;
    LUCARNE_ASSIGN(seeds.lights, device.buffer(points.size() * sizeof(VplLight), "lights"));
    const bool lobes = std::ranges::any_of(materials, [](const Material& m) { return m.diffuse.w > 0; });
    LUCARNE_ASSIGN(const double weight, map_importance(device, view, material_buffer, lobes, importance));
    EXPECT_GE(weight, 0);
    LUCARNE_TRY(seed_view(device, view, importance, material_buffer, points, 0, seeds));
    settle_lights(seeds, static_cast<uint32_t>(points.size()));
    return seeds.host_lights;
}

}  // namespace lucarne::gi::vpl::testing
