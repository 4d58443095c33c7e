// A cloud of surfels lit by an engine, for tests.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/engine.h"
#include "gi/gl_frame.h"
#include "tests/gi/engines/bake_whole.h"
#include "tests/gi/engines/needed_cuts.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/test_lights.h"
#include "tests/gi/engines/test_settings.h"

namespace lucarne::gi {

/// The picture of an engine with the data that tests compare it with.
struct Lit {
    CameraView camera;
    std::vector<glm::vec4> radiance;
    std::vector<GBufferTexel> texels;
    std::vector<std::pair<std::string, double>> stats;
    std::shared_ptr<const Bake> bake;

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
    std::vector<Material> materials = {scenes::material()};
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
    glm::dvec3 origin{0.0};        ///< Frame::origin
    /// What the engine has computed in advance (Lit::bake of an earlier picture); null: it computes it.
    std::shared_ptr<const Bake> bake = nullptr;
    glm::vec3 bake_offset{0.0f};  ///< Frame::bake_offset
};

/// Renders one frame of `cut`, which is view cut, light-view cut and light cut as far as the engine needs
/// them. Errors: those of the engine and of what it computes in advance, device memory.
inline Result<Lit> draw_frame(Device& device, Engine& engine, const SurfelPool& pool, const DeviceCut& cut,
                              const CameraView& camera, const Bounds& bounds, const LitOptions& options) {
    GBuffer gbuffer;
    LUCARNE_TRY(rasterize(device, cut, camera, gbuffer, options.size));
    const size_t pixels = size_t{camera.width} * camera.height;
    LUCARNE_ASSIGN(Buffer radiance, device.buffer(pixels * sizeof(glm::vec4), "radiance"));
    radiance.clear(0x7fc00000u);  // NaN: the engine has to write every pixel
    PassTimes times(device);
    const FrameCuts cuts = needed_cuts(engine.info(), cut, options.lights.size());
    auto bake = options.bake;
    if (!bake) {
        LUCARNE_ASSIGN(bake, bake_whole(engine.info(), pool.download(cut), bounds, options.settings));
    }
    GlFrame on_device{device, pool, cuts, gbuffer, radiance};
    Frame frame{.camera = camera,
                .lights = options.lights,
                .materials = options.materials,
                .background = options.background,
                .settings = options.settings,
                .index = options.index,
                .environment = options.environment,
                .bounds = bounds,
                .origin = options.origin,
                .moving = options.moving,
                .light_budget = options.light_budget,
                .bake = bake.get(),
                .bake_offset = options.bake_offset,
                .stop = options.stop,
                .unlit = options.unlit,
                .gl = on_device,
                .times = times};
    LUCARNE_TRY(engine.draw(frame));
    return Lit{camera, radiance.download_all<glm::vec4>(pixels),
               gbuffer.texels.download_all<GBufferTexel>(pixels), engine.stats(), std::move(bake)};
}

/// Renders a whole cloud with an engine. A failure fails the test.
inline Lit light_up(Device& device, Engine& engine, const SurfelCloud& cloud, const CameraView& camera,
                    const LitOptions& options) {
    const auto loaded = load_cloud(device, cloud);
    if (!loaded) {
        ADD_FAILURE() << loaded.error().line();
        return {};
    }
    SurfelPool& pool = (*loaded)->pool;
    DeviceCut& cut = (*loaded)->cut;
    if (options.clip.active()) {
        const auto made = pool.make_cut(device, cloud, cloud.whole(), glm::dvec3(0.0), cut, options.clip);
        EXPECT_TRUE(made) << made.error().line();
    }
    const Bounds whole{glm::vec3(cloud.header().min), glm::vec3(cloud.header().max)};
    auto lit = draw_frame(device, engine, pool, cut, camera, options.bounds.value_or(whole), options);
    if (lit) return std::move(*lit);
    ADD_FAILURE() << lit.error().line();
    return {};
}

}  // namespace lucarne::gi
