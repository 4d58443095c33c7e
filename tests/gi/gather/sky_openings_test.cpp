#include "gi/gather/sky_openings.h"

#include <cmath>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "gi/registry.h"
#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/scatter.h"
#include "io/core/random.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kBufferRays = 200;

/// A room of 4 m with a window of 40 cm in a wall.
std::vector<Surfel> room_with_a_window() {
    std::vector<Surfel> surfels = scenes::closed_box(4, 100, glm::vec3(0.5f));
    std::erase_if(surfels, [](const Surfel& s) {
        return s.position.x > 3.99f && std::abs(s.position.y - 1.5f) < .2f &&
               std::abs(s.position.z - 2.4f) < .2f;
    });
    return surfels;
}

std::unique_ptr<tracing::SurfelTracer> tracer_of(std::vector<Surfel> surfels) {
    auto tracer = tracing::SurfelTracer::create(std::move(surfels));
    EXPECT_TRUE(tracer);
    return tracer ? std::move(*tracer) : nullptr;
}

GatherSky even_sky(float radiance) {
    return {.width = 1, .height = 1, .texels = {glm::vec3(radiance)}};
}

GatherPoint point_on_floor(float x, float y, uint32_t seed) {
    return {.position = {x, y, 0}, .lift = 0.03f, .normal = kZ, .seed = seed, .axis = kZ, .scale = 1};
}

std::vector<GatherPoint> pilots_on_floor() {
    std::vector<GatherPoint> pilots;
    for (uint32_t i = 0; i < 256; ++i)
        pilots.push_back(point_on_floor(0.1f + 0.24f * static_cast<float>(i % 16),
                                        0.1f + 0.24f * static_cast<float>(i / 16), i));
    return pilots;
}

/// Returns the part of a point's light that rays to the openings bring, and sets `own` to that of even rays.
double light_of_openings(const SkyOpenings& openings, const tracing::SurfelTracer& tracer,
                         const GatherPoint& point, double& own) {
    const float rays = 32.0f / kBufferRays;
    std::vector<float> densities(openings.spheres().size());
    openings.find_densities(point, rays, densities);
    double sum = 0;
    openings.each_ray(point, densities, rays, 32,
                      [&](const glm::vec3&, const glm::vec3& light) { sum += light.x; });
    // As the kernel's share_of_buffer().
    Random random(point.seed, 7);
    own = 0;
    for (uint32_t i = 0; i < kBufferRays; ++i) {
        const double x = random.uniform();
        const glm::vec3 ray = tracing::cosine_power_direction(point.normal, 1, {x, random.uniform()});
        if (tracer.occluded_along(tracing::offset_origin(point.position, point.normal, point.lift), ray))
            continue;
        float all = ray.z;
        for (size_t k = 0; k < densities.size(); ++k) {
            const glm::vec3 middle = glm::vec3(openings.spheres()[k]) - point.position;
            const float radius = openings.spheres()[k].w;
            if (densities[k] > 0 && glm::dot(ray, middle) > 0 &&
                glm::length(glm::cross(ray, middle)) < radius)
                all += densities[k];
        }
        own += ray.z / all / kBufferRays;
    }
    return sum;
}

/// Returns what a point receives through a square across x that begins at `corner`, by even points of it.
double light_through(const tracing::SurfelTracer& tracer, const GatherPoint& point, const glm::vec3& corner,
                     float size) {
    const glm::vec3 start = tracing::offset_origin(point.position, kZ, point.lift);
    constexpr int kPoints = 300;
    double sum = 0;
    for (int j = 0; j < kPoints; ++j)
        for (int i = 0; i < kPoints; ++i) {
            const glm::vec3 at(0, static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f);
            const glm::vec3 to = corner + size / kPoints * at - start;
            const float distance2 = glm::dot(to, to);
            const glm::vec3 ray = to / std::sqrt(distance2);
            if (!tracer.occluded_along(start, ray)) sum += ray.z * ray.x / distance2;
        }
    return sum * size * size / (kPi * kPoints * kPoints);
}

TEST(SkyOpenings, RaysOfBothKindsAddUpToTheSky) {
    const auto tracer = tracer_of(room_with_a_window());
    ASSERT_TRUE(tracer);
    const GatherSky sky = even_sky(1);
    const SkyOpenings openings = SkyOpenings::find(*tracer, sky, pilots_on_floor(), 3);
    ASSERT_FALSE(openings.empty());
    for (const glm::vec2 at : {glm::vec2(2.5f, 1.5f), glm::vec2(0.6f, 3.1f), glm::vec2(3.6f, 0.5f)}) {
        double sum = 0, squares = 0, own_sum = 0;
        constexpr int kSeeds = 400;
        for (int i = 0; i < kSeeds; ++i) {
            const GatherPoint point = point_on_floor(at.x, at.y, static_cast<uint32_t>(1000 + i));
            double own = 0;
            const double light = light_of_openings(openings, *tracer, point, own) + own;
            sum += light / kSeeds;
            squares += light * light / kSeeds;
            own_sum += own / kSeeds;
        }
        EXPECT_NEAR(sum / light_through(*tracer, point_on_floor(at.x, at.y, 0), {4, 1.2f, 2.1f}, 0.6f), 1,
                    0.02)
            << at.x << " " << at.y;
        EXPECT_LT(own_sum / sum, 0.3);
        // Buffers alone would find so little of their rays: a variance of the mean over their number.
        EXPECT_LT(squares - sum * sum, 0.2 * sum / kBufferRays);
    }
}

// Cones of spheres that are hundreds of radii away are narrower than what floats resolve of a cosine.
TEST(SkyOpenings, PointsFarFromOpeningsReceiveNoMoreThanTheSky) {
    std::vector<Surfel> hall = scenes::closed_box(40, 200, glm::vec3(0.5f));
    std::erase_if(hall, [](const Surfel& s) {
        return s.position.x > 39.9f && std::abs(s.position.y - 20) < 0.6f &&
               std::abs(s.position.z - 1.6f) < 0.5f;
    });
    const auto tracer = tracer_of(std::move(hall));
    ASSERT_TRUE(tracer);
    std::vector<GatherPoint> pilots = pilots_on_floor();
    for (GatherPoint& pilot : pilots) pilot.position = pilot.position + glm::vec3(35.9f, 18, 0);
    const GatherSky sky = even_sky(1);
    const SkyOpenings openings = SkyOpenings::find(*tracer, sky, pilots, 3);
    ASSERT_FALSE(openings.empty());
    double sum = 0;
    for (uint32_t i = 0; i < 200; ++i) {
        double own = 0;
        sum += light_of_openings(openings, *tracer, point_on_floor(1, 20, i), own) / 200;
        sum += own / 200;
    }
    // What no sphere covers is met by hardly any even ray.
    const double part = sum / light_through(*tracer, point_on_floor(1, 20, 0), {40, 18.8f, 0.4f}, 2.4f);
    EXPECT_GT(part, 0.8);
    EXPECT_LT(part, 1.02);
}

TEST(SkyOpenings, UnderAnotherSkyTheyAreThoseThatAreFoundUnderIt) {
    const auto tracer = tracer_of(room_with_a_window());
    ASSERT_TRUE(tracer);
    const GatherSky even = even_sky(1);
    GatherSky stripes{.width = 64, .height = 1};  // of which the window shows two or three
    for (int i = 0; i < 64; ++i) stripes.texels.emplace_back(i % 2 == 0 ? 3.0f : 0.0f);
    const SkyOpenings found = SkyOpenings::find(*tracer, stripes, pilots_on_floor(), 3);
    SkyOpenings moved = SkyOpenings::find(*tracer, even, pilots_on_floor(), 3);
    ASSERT_FALSE(moved.empty());
    const auto light = [&](const SkyOpenings& openings) {
        double own = 0;
        return light_of_openings(openings, *tracer, point_on_floor(2.5f, 1.5f, 5), own);
    };
    EXPECT_NE(light(moved), light(found));
    moved.set_sky(stripes);
    EXPECT_EQ(light(moved), light(found));
    EXPECT_GT(light(found), 0);
}

TEST(SkyOpenings, NoneAreFoundWhereThereAreNoneOrTheSkyIsWide) {
    const GatherSky sky = even_sky(1);
    const auto closed = tracer_of(scenes::closed_box(4, 60, glm::vec3(0.5f)));
    ASSERT_TRUE(closed);
    EXPECT_TRUE(SkyOpenings::find(*closed, sky, pilots_on_floor(), 3).empty());
    std::vector<Surfel> floor;
    scenes::add_rectangle(floor, kO, 4.0f * kX, 4.0f * kY, 60, glm::vec3(0.5f));
    const auto field = tracer_of(std::move(floor));
    ASSERT_TRUE(field);
    EXPECT_TRUE(SkyOpenings::find(*field, sky, pilots_on_floor(), 3).empty());
    EXPECT_TRUE(SkyOpenings::find(*field, {}, pilots_on_floor(), 3).empty());
    EXPECT_TRUE(SkyOpenings::find(*field, sky, {}, 3).empty());
}

class SkyOpeningsInEngines : public OnDevice {};

TEST_F(SkyOpeningsInEngines, WindowLightsARoomWithLittleNoiseInOneFrame) {
    scenes::AnalyticScene scene;
    scene.surfels = room_with_a_window();
    scene.environment = scenes::even_sky(1);
    scene.camera = scenes::look({0.4f, 0.4f, 2.2f}, {2.8f, 1.6f, 0}, 0.6f, 32);
    scene.settings.set(kOnlyBounce, 0);
    scene.settings.set(kMicroBuffer, 8);
    scene.settings.set(environment::kCacheSpacing, 3);
    scene.settings.set(kGatherEvery, 1);
    scene.settings.set(reference::kSamples, 4096);
    const auto render = [&](std::string_view engine, uint64_t seed) {
        scene.settings.set(kSeed, seed);
        const auto picture = scenes::render(*device, engine, scene);
        EXPECT_TRUE(picture) << picture.error().line();
        return picture ? picture->radiance : std::vector<glm::vec4>{};
    };
    const double truth = mean_luminance(render("reference", 1));
    for (const std::string_view engine : {"micro", "environment"}) {
        const auto one = render(engine, 1), other = render(engine, 2);
        EXPECT_NEAR(mean_luminance(one) / truth, 1, 0.05) << engine;
        const auto metrics = compare_images(one, other);
        ASSERT_TRUE(metrics);
        EXPECT_LT(metrics->rel_mse / 2, 0.05) << engine;
    }
}

// All frames of a view have its first frame's openings; no other view and no other sky has them.
TEST_F(SkyOpeningsInEngines, OpeningsServeOneViewUnderOneSky) {
    const SurfelCloud cloud(room_with_a_window());
    const auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded) << loaded.error().line();
    LitOptions options;
    options.settings.set(kOnlyBounce, 0);
    options.settings.set(kMicroBuffer, 8);
    options.settings.set(kGatherEvery, 1);
    options.settings.set(environment::kCacheSpacing, 3);
    options.bounds = {glm::vec3(0.0f), glm::vec3(4.0f)};
    const auto dim = scenes::even_sky(1), bright = scenes::even_sky(3);
    const CameraView view = look({0.4f, 0.4f, 2.2f}, {2.8f, 1.6f, 0}, 24, 24);
    const CameraView other = look({0.4f, 3.4f, 2.2f}, {2.8f, 1.6f, 2}, 24, 24);
    const auto draw = [&](Engine& engine, const CameraView& camera, const auto& sky) {
        options.environment = sky;
        const auto lit =
            draw_frame(*device, engine, (*loaded)->pool, (*loaded)->cut, camera, *options.bounds, options);
        EXPECT_TRUE(lit) << lit.error().line();
        return lit ? lit->radiance : std::vector<glm::vec4>{};
    };
    for (const std::string_view name : {"micro", "environment"}) {
        const auto engine = *make_engine(name), fresh = *make_engine(name);
        draw(*engine, other, dim);
        EXPECT_EQ(draw(*engine, view, dim), draw(*fresh, view, dim)) << name << " after another view";
        const auto right = draw(*make_engine(name).value(), view, bright);
        EXPECT_EQ(draw(*engine, view, bright), right) << name << " under another sky";
        // The next frame of an average looks for the sky through the same openings: its mean is the same.
        CameraView shifted = view;
        shifted.right.w = shifted.up.w = 0.3f;
        options.index = 1;
        const auto next = draw(*engine, shifted, bright), alone = draw(*fresh, shifted, bright);
        options.index = 0;
        EXPECT_NEAR(mean_luminance(next) / mean_luminance(alone), 1, 0.1) << name;
    }
    // Places between which light is exchanged do not look through the openings of an earlier picture.
    options.settings.set(kOnlyBounce, -1);
    options.settings.set(kBounces, 2);
    options.settings.set(kLightPoints, LightPoints::radiosity);
    for (const std::string_view name : {"micro", "environment"}) {
        const auto engine = *make_engine(name), fresh = *make_engine(name);
        draw(*engine, other, dim);
        options.index = 1;
        EXPECT_EQ(draw(*engine, view, dim), draw(*fresh, view, dim)) << name << " after another view";
        options.index = 0;
    }
}

}  // namespace
}  // namespace lucarne::gi
