// A cloud of surfels lit by an engine, for tests.
#pragma once

#include <atomic>
#include <optional>

#include <gtest/gtest.h>

#include "gi/engine.h"
#include "gi/gl_frame.h"
#include "tests/gi/engines/bake_whole.h"
#include "tests/gi/engines/needed_cuts.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/test_settings.h"

namespace lucarne::gi {

inline Light make_spot(const glm::vec3& from, const glm::vec3& to, float half_angle, float intensity,
                       float softness = 0.0f) {
    const glm::vec3 d = glm::normalize(to - from);
    return {{from.x, from.y, from.z, std::cos(half_angle)},
            {d.x, d.y, d.z, std::cos(half_angle * (1 - softness))},
            {intensity, intensity, intensity, 0}};
}

inline Material make_material(float diffuse = 1, float specular = 0, float exponent = 1, float emission = 0) {
    return {glm::vec4(diffuse, diffuse, diffuse, specular),
            glm::vec4(emission, emission, emission, exponent)};
}

/// The picture of an engine with the data that tests compare it with.
struct Lit {
    CameraView camera;
    std::vector<glm::vec4> radiance;
    std::vector<GBufferTexel> texels;
    std::shared_ptr<const Bake> bake = nullptr;

    glm::vec3 at(uint32_t x, uint32_t y) const {
        const glm::vec4 v = radiance[y * camera.width + x];
        return {v.x, v.y, v.z};
    }
    glm::vec3 position(uint32_t x, uint32_t y) const {
        return texel_position(camera, glm::vec2(x, y), texels[y * camera.width + x]);
    }
};

struct LitOptions {
    std::vector<Light> lights;
    std::vector<Material> materials = {make_material()};
    glm::vec3 background{0.0f};
    EngineSettings settings = test_settings();
    uint64_t index = 0;
    bool moving = false;
    StepBudget light_budget{};
    const std::atomic<bool>* stop = nullptr;
    std::shared_ptr<const Environment> environment = nullptr;
    Unlit unlit{};
    PointSize size{};
    Clip clip{};
    std::optional<Bounds> bounds;  ///< of the scene; by default the cloud's root
    /// What the engine has computed in advance (Lit::bake of an earlier picture); null: it computes it.
    std::shared_ptr<const Bake> bake = nullptr;
};

/// Renders a cloud with an engine. One cut, the whole cloud, is view cut, light-view cut and light cut.
inline Lit light_up(Device& device, Engine& engine, const SurfelCloud& cloud, const CameraView& camera,
                    const LitOptions& options) {
    Lit lit{camera, {}, {}};
    auto loaded = load_cloud(device, cloud);
    if (!loaded) {
        ADD_FAILURE() << loaded.error().line();
        return lit;
    }
    DeviceCut& cut = (*loaded)->cut;
    if (options.clip.active()) {
        const auto made =
            (*loaded)->pool.make_cut(device, cloud, cloud.whole(), glm::dvec3(0.0), cut, options.clip);
        EXPECT_TRUE(made) << made.error().line();
    }
    GBuffer gbuffer;
    auto drawn = rasterize(device, cut, camera, gbuffer, options.size);
    EXPECT_TRUE(drawn) << drawn.error().line();
    const size_t pixels = size_t{camera.width} * camera.height;
    auto radiance = device.buffer(pixels * sizeof(glm::vec4), "radiance");
    EXPECT_TRUE(radiance);
    radiance->clear(0x7fc00000u);  // NaN: the engine has to write every pixel
    PassTimes times(device);
    const FrameCuts cuts = needed_cuts(engine.info(), cut, options.lights.size());
    const Bounds bounds =
        options.bounds.value_or(Bounds{glm::vec3(cloud.header().min), glm::vec3(cloud.header().max)});
    if (!options.bake) {
        auto bake = bake_whole(engine.info(), (*loaded)->pool.download(cut), bounds, options.settings);
        EXPECT_TRUE(bake) << bake.error().line();
        if (bake) lit.bake = std::move(*bake);
    } else {
        lit.bake = options.bake;
    }
    GlFrame on_device{device, (*loaded)->pool, cuts, gbuffer, *radiance};
    Frame frame{.camera = camera,
                .lights = options.lights,
                .materials = options.materials,
                .background = options.background,
                .settings = options.settings,
                .index = options.index,
                .environment = options.environment,
                .bounds = bounds,
                .moving = options.moving,
                .light_budget = options.light_budget,
                .bake = lit.bake.get(),
                .stop = options.stop,
                .unlit = options.unlit,
                .gl = on_device,
                .times = times};
    const auto drawn_by_engine = engine.draw(frame);
    EXPECT_TRUE(drawn_by_engine) << drawn_by_engine.error().line();
    lit.radiance = radiance->download_all<glm::vec4>(pixels);
    lit.texels = gbuffer.texels.download_all<GBufferTexel>(pixels);
    return lit;
}

}  // namespace lucarne::gi
