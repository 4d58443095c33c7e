// Scenes whose light has closed form, rendered by every engine: one table for all.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/volume/options.h"
#include "gi/engines/vpl/options.h"
#include "gi/gather/gather_options.h"
#include "gi/lighting/light_options.h"
#include "gi/shared/brdf.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene, scenes::look, scenes::material, scenes::spot;

void no_settings(EngineSettings&) {}
void fine_vpls(EngineSettings& settings) {
    settings.set(kVpls, 1024);
    settings.set(vpl::kInterleave, 1);
    settings.set(vpl::kAtlas, 2048);
}
void fine_voxels(EngineSettings& settings) {
    settings.set(volume::kVoxelCount, 32);
}
void fine_buffers(EngineSettings& settings) {
    settings.set(kMicroBuffer, 24);
    settings.set(kGatherEvery, 1);
    settings.set(kRadiosityLevel, 12);
}
void many_photons(EngineSettings& settings) {
    fine_buffers(settings);
    settings.set(kLightPoints, LightPoints::photons);
}
void many_vpls(EngineSettings& settings) {
    fine_buffers(settings);
    settings.set(kLightPoints, LightPoints::vpls);
    settings.set(kVpls, 4096);
}
void fine_caches(EngineSettings& settings) {
    fine_buffers(settings);
    settings.set(environment::kCacheSpacing, 3);
}
void many_rays(EngineSettings& settings) {
    settings.set(paths::kPointSpacing, 60);
    settings.set(paths::kGatherRays, 256);
    settings.set(paths::kEntryPoints, 100'000);
}
void more_rays(EngineSettings& settings) {
    settings.set(paths::kPointSpacing, 30);
    settings.set(paths::kGatherRays, 2048);
}
void many_paths(EngineSettings& settings) {
    settings.set(reference::kSamples, 256);
}

/// What an engine claims to compute beyond direct light, which selects the tests that apply to it, and how
/// close it comes to the truth. A new engine adds a line.
struct Claims {
    const char* engine;
    bool one_bounce;        ///< light of spots that one surface reflects to another
    bool emission_bounces;  ///< light of emitting surfaces, reflected any number of times
    // Largest relative errors of the picture's mean, and of the furnace's radiance.
    double bounce = 0, furnace = 0, far_transport = 0, of_reference = 0;
    void (*fine)(EngineSettings&) = no_settings;   ///< the settings for these
    void (*finer)(EngineSettings&) = no_settings;  ///< on top of them, for light from small far surfaces
    const char* way = "";                          ///< names the settings if an engine has several lines
};
constexpr Claims kClaims[] = {
    {"direct", false, false},
    {"vpl", true, true, .03, .015, .04, .03, fine_vpls},
    {"volume", true, true, .05, .015, .02, .05, fine_voxels},
    {"micro", true, true, .03, .015, .04, .03, fine_buffers},
    {"micro", true, true, .03, .015, .04, .03, many_photons, no_settings, "Photons"},
    {"micro", true, true, .03, .015, .04, .03, many_vpls, no_settings, "Vpls"},
    // One bounce: -2.96 % in the mean of eight seeds, with a deviation of .1 %.
    {"environment", true, true, .033, .015, .04, .03, fine_caches},
    {"paths", true, true, .03, .005, .04, .03, many_rays, more_rays},
    {"reference", true, true, .03, .003, .03, .01, many_paths}};

class Engines : public testing::TestWithParam<Claims> {
 protected:
    static void SetUpTestSuite() {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device_ = std::move(*made);
    }
    static void TearDownTestSuite() { device_.reset(); }

    static Lit render(const AnalyticScene& scene) {
        auto rendered = scenes::render(*device_, GetParam().engine, scene);
        EXPECT_TRUE(rendered) << rendered.error().line();
        if (!rendered) return {};
        for (const glm::vec4& pixel : rendered->radiance)
            EXPECT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z)) << "a radiance that is not finite";
        return std::move(*rendered);
    }

    static std::unique_ptr<Device> device_;
};
std::unique_ptr<Device> Engines::device_;

AnalyticScene floor_under_a_spot() {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, 2.0f * kX, 2.0f * kY, 160, glm::vec3(0.5f));
    scene.lights = {spot(glm::vec3(0.7f, 0.9f, 2), glm::vec3(1, 1, 0), 0.6f, 0.5f, 10)};
    scene.camera = look(glm::vec3(1, 1, 3), glm::vec3(1, 1, 0), 0.25f, 96);
    scene.settings.set(kOnlyBounce, 0);
    return scene;
}

/// kd/pi I cos / d^2: the reflected light of a spot's bright centre at a point of the floor.
float lit_floor(const Light& light, const glm::vec3& point) {
    const glm::vec3 to_light = glm::vec3(light.position) - point;
    const float d2 = glm::dot(to_light, to_light);
    return 0.5f / kPi * light.strength.x * to_light.z / std::sqrt(d2) / d2;
}

TEST_P(Engines, SpotOnAFloorGivesTheIrradianceOfItsIntensity) {
    const AnalyticScene scene = floor_under_a_spot();
    const auto rendered = render(scene);
    double sum = 0, truth = 0;
    for (size_t i = 0; i < rendered.radiance.size(); ++i) {
        sum += rendered.radiance[i].x;
        truth += lit_floor(scene.lights[0], scenes::position_of(scene.camera, rendered.texels, i));
    }
    EXPECT_NEAR(sum / truth, 1, 0.01);
}

TEST_P(Engines, SheetBetweenLightAndFloorCastsItsShadowAndNoMore) {
    AnalyticScene scene = floor_under_a_spot();
    const Light light = scene.lights[0];
    const glm::vec3 above(0.7f, 0.9f, 1.6f);
    scenes::add_rectangle(scene.surfels, above - glm::vec3(.05f, .05f, 0), 0.1f * kX, 0.1f * kY, 8,
                          glm::vec3(0.5f));
    const auto rendered = render(scene);
    size_t shaded = 0, lit = 0;
    for (size_t i = 0; i < rendered.radiance.size(); ++i) {
        const glm::vec3 p = scenes::position_of(scene.camera, rendered.texels, i);
        if (p.z > 0.1f) continue;
        // The point where the ray to the light crosses the plane of the sheet, relative to its centre. The
        // rim of discs is .02 wide.
        const glm::vec3 to_light = glm::vec3(light.position) - p;
        const glm::vec3 at = p + to_light * ((above.z - p.z) / to_light.z) - above;
        const float away = std::max(std::abs(at.x), std::abs(at.y));
        if (away < 0.035f) {
            ++shaded;
            EXPECT_EQ(rendered.radiance[i].x, 0) << i;
        } else if (away > 0.085f) {
            ++lit;
            EXPECT_NEAR(rendered.radiance[i].x / lit_floor(light, p), 1, 0.02) << i;
        }
    }
    EXPECT_GT(shaded, 50u);
    EXPECT_GT(lit, 500u);
}

TEST_P(Engines, SealedDarkRoomStaysBlack) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.9f));
    Light sun = spot(glm::vec3(0), glm::vec3(.3f, .5f, -1), 0, 0, 100);
    sun.kind = static_cast<uint32_t>(LightKind::directional);
    sun.direction.w = 0;
    Light bulb = spot(glm::vec3(-.1f, 1, 1.1f), glm::vec3(1), 0, 0, 1e3f);
    bulb.kind = static_cast<uint32_t>(LightKind::point);
    for (const Light& light : {spot(glm::vec3(1, 1, 4), glm::vec3(1), 0.9f, 0.8f, 1e4f), sun, bulb}) {
        scene.lights = {light};
        scene.camera = look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, 64);
        scene.settings.set(kBounces, 3);
        float brightest = 0;
        size_t lit = 0;
        const auto rendered = render(scene);
        scene.bake = rendered.bake;
        for (const glm::vec4& pixel : rendered.radiance) {
            brightest = std::max({brightest, pixel.x, pixel.y, pixel.z});
            if (pixel.x > 0 || pixel.y > 0 || pixel.z > 0) ++lit;
        }
        EXPECT_EQ(brightest, 0.0f) << lit << " pixels are lit by a light of kind " << light.kind;
    }
}

TEST_P(Engines, EmissionIsSeenAsItIs) {
    AnalyticScene scene = floor_under_a_spot();
    scene.lights.clear();
    scene.materials = {material(1, 0, 1, 0.75f)};
    for (const glm::vec4& pixel : render(scene).radiance) ASSERT_NEAR(pixel.x, 0.75f, 1e-4f);
}

// When a scene with fewer materials replaces another, surfels still carry the old indices.
TEST_P(Engines, MaterialThatNoLongerExistsIsTheDefault) {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, 2.0f * kX, 2.0f * kY, 160, glm::vec3(0.5f), 200);
    scene.camera = look(glm::vec3(1, 1, 3), glm::vec3(1, 1, 0), 0.25f, 32);
    scene.materials = {material(1, 0, 1, 0.75f), material(1, 0, 1, 0.25f)};
    scene.packed_materials = 201;
    for (const glm::vec4& pixel : render(scene).radiance) ASSERT_NEAR(pixel.x, 0.75f, 1e-4f);
}

/// A wall x = 0 that a spot lights, and a floor z = 0 that only the wall lights.
AnalyticScene lit_corner() {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, kY, kZ, 100, glm::vec3(0.6f));
    scenes::add_rectangle(scene.surfels, kO, kX, kY, 100, glm::vec3(0.5f));
    scene.lights = {spot(glm::vec3(1.5f, .5f, .9f), glm::vec3(0, .5f, .6f), 0.2f, 0.2f, 20)};
    scene.camera = look(glm::vec3(0.5f, 0.5f, 2), glm::vec3(0.5f, 0.5f, 0), 0.18f, 48);
    scene.settings.set(kOnlyBounce, 1);
    return scene;
}

/// Returns the radiance of the floor at a point, by quadrature over the wall.
double floor_light(const AnalyticScene& scene, const glm::vec3& point) {
    const Light& light = scene.lights[0];
    const glm::vec3 place(light.position), axis(light.direction);
    double irradiance = 0;
    for (const Surfel& s : scene.surfels) {
        if (s.normal.x < 0.5f) continue;
        const glm::vec3 to_light = place - s.position, to_point = point - s.position;
        const double l2 = glm::dot(to_light, to_light), r2 = glm::dot(to_point, to_point);
        if (-glm::dot(axis, to_light) / std::sqrt(l2) < light.position.w) continue;
        const double incident = light.strength.x * to_light.x / std::sqrt(l2) / l2;
        irradiance += 0.6 / kPi * incident * to_point.x * -to_point.z / (r2 * r2) * s.area;
    }
    return 0.5 / kPi * irradiance;
}

TEST_P(Engines, OneBounceFromALitWallMatchesQuadrature) {
    AnalyticScene scene = lit_corner();
    GetParam().fine(scene.settings);
    const auto rendered = render(scene);
    double sum = 0, truth = 0;
    for (size_t i = 0; i < rendered.radiance.size(); ++i) {
        sum += rendered.radiance[i].x;
        truth += floor_light(scene, scenes::position_of(scene.camera, rendered.texels, i));
    }
    if (GetParam().one_bounce)
        EXPECT_NEAR(sum / truth, 1, GetParam().bounce);
    else
        EXPECT_EQ(sum, 0);
}

TEST_P(Engines, BouncesOneByOneAddUp) {
    AnalyticScene scene = lit_corner();
    GetParam().fine(scene.settings);
    scene.camera = look(glm::vec3(1.2f, 0.5f, 1.2f), glm::vec3(0, 0.5f, 0.2f), 0.6f, 48);
    const auto mean = [&](int32_t only) {
        scene.settings.set(kOnlyBounce, only);
        const auto rendered = render(scene);
        scene.bake = rendered.bake;
        return mean_luminance(rendered.radiance);
    };
    const double both = mean(-1), first = mean(0), second = mean(1);
    EXPECT_GT(first, 0);
    EXPECT_NEAR(both, first + second, 1e-4 * both);
}

TEST_P(Engines, ClosedFurnaceAfterBounceKIsOneMinusRhoToTheKPlusOne) {
    if (!GetParam().emission_bounces) GTEST_SKIP() << "emitting surfaces light nothing else in this engine";
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.5f));
    scene.materials = {material(1, 0, 1, 0.5f)};
    scene.camera = look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, 48);
    GetParam().fine(scene.settings);
    for (const uint32_t bounces : {0u, 1u, 2u, 3u}) {
        scene.settings.set(kBounces, bounces);
        const auto rendered = render(scene);
        scene.bake = rendered.bake;
        EXPECT_NEAR(mean_luminance(rendered.radiance), 1 - std::pow(0.5, bounces + 1), GetParam().furnace)
            << bounces;
    }
}

/// Returns the radiance that surfaces of material 1, which radiate 1 W/(sr m^2), give by one reflection of
/// albedo .5 to a point with this normal, by quadrature. Nothing is in between.
double reflected_emission(const AnalyticScene& scene, const glm::vec3& point, const glm::vec3& normal) {
    double irradiance = 0;
    for (const Surfel& s : scene.surfels) {
        if (s.material != 1) continue;
        const glm::vec3 to = s.position - point;
        const double r2 = glm::dot(to, to);
        const double cosines = std::max(0.0f, glm::dot(normal, to)) * std::max(0.0f, -glm::dot(s.normal, to));
        irradiance += cosines / (r2 * r2) * s.area;
    }
    return .5 / kPi * irradiance;
}

/// Makes the middle quarter of the surfaces with this normal emit light. Not all of them: discs overlap the
/// edges of open surfaces. Where discs in one plane overlap, rays hit any of them, so a traced edge of the
/// quarter may lie up to a disc's radius off: surfels have to be small.
void let_the_middle_emit(AnalyticScene& scene, const glm::vec3& normal) {
    for (Surfel& s : scene.surfels)
        if (glm::dot(s.normal, normal) > .5f && std::abs(s.position.x - .5f) < .25f &&
            std::abs(s.position.y - .5f) < .25f)
            s.material = 1;
    scene.materials = {material(1, 0, 1, 0), material(1, 0, 1, 1)};
}

/// Compares the mean of a picture that shows only surfaces of one normal with the quadrature.
void expect_reflected_emission(const AnalyticScene& scene, const Lit& rendered, const glm::vec3& normal,
                               double tolerance) {
    double sum = 0, truth = 0;
    for (size_t i = 0; i < rendered.radiance.size(); ++i) {
        sum += rendered.radiance[i].x;
        truth += reflected_emission(scene, scenes::position_of(scene.camera, rendered.texels, i), normal);
    }
    EXPECT_NEAR(sum / truth, 1, tolerance);
}

// Light of low-order lobes or of diffusion between voxels passes the furnace, but not this.
TEST_P(Engines, LightCrossesTheRoomBetweenFarPlatesByTheirFormFactor) {
    if (!GetParam().emission_bounces) GTEST_SKIP() << "emitting surfaces light nothing else in this engine";
    for (const float distance : {1.0f, 4.0f}) {
        AnalyticScene scene;
        scenes::add_rectangle(scene.surfels, kO, kX, kY, 160, glm::vec3(0.5f));
        scenes::add_rectangle(scene.surfels, distance * kZ, kY, kX, 160, glm::vec3(0.5f));
        let_the_middle_emit(scene, -kZ);
        scene.camera = look(glm::vec3(.5f, .5f, .9f * distance), glm::vec3(.5f, .5f, 0), .4f / distance, 32);
        scene.settings.set(kOnlyBounce, 1);
        GetParam().fine(scene.settings);
        GetParam().finer(scene.settings);
        SCOPED_TRACE(distance);
        expect_reflected_emission(scene, render(scene), kZ, GetParam().far_transport);
    }
}

TEST_P(Engines, CeilingOfACubeIsLitByItsFloor) {
    if (!GetParam().emission_bounces) GTEST_SKIP() << "emitting surfaces light nothing else in this engine";
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(1, 160, glm::vec3(0.5f));
    let_the_middle_emit(scene, kZ);
    scene.camera = look(glm::vec3(.5f, .5f, .05f), glm::vec3(.5f, .5f, 1), .5f, 32);
    scene.settings.set(kOnlyBounce, 1);
    GetParam().fine(scene.settings);
    expect_reflected_emission(scene, render(scene), -kZ, GetParam().far_transport);
}

TEST_P(Engines, AWallThatIsLitFromBehindStaysDark) {
    AnalyticScene scene = floor_under_a_spot();
    scene.lights = {spot(glm::vec3(0.7f, 0.9f, -2), glm::vec3(1, 1, 0), 0.6f, 0.5f, 1e4f)};
    scene.settings.set(kOnlyBounce, -1);
    scene.settings.set(kBounces, 2);
    for (const glm::vec4& pixel : render(scene).radiance) ASSERT_EQ(glm::vec3(pixel), kO);
}

TEST_P(Engines, ASheetIsLitOnTheSideThatIsSeen) {
    for (const bool turned : {false, true}) {
        AnalyticScene scene = floor_under_a_spot();
        if (turned)
            for (Surfel& s : scene.surfels) s.normal = -s.normal;
        const auto rendered = render(scene);
        double sum = 0, truth = 0;
        for (size_t i = 0; i < rendered.radiance.size(); ++i) {
            sum += rendered.radiance[i].x;
            truth += lit_floor(scene.lights[0], scenes::position_of(scene.camera, rendered.texels, i));
        }
        EXPECT_NEAR(sum / truth, 1, 0.01) << turned;
    }
}

TEST_P(Engines, ThreeBouncesInALitRoomAreThoseOfTheReference) {
    if (!GetParam().one_bounce) GTEST_SKIP() << "no bounces";
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.6f));
    scene.lights = {spot(glm::vec3(.6f, 1, 1.8f), glm::vec3(1, 1, 0), .6f, .4f, 5)};
    scene.camera = look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, 32);
    scene.settings.set(kBounces, 3);
    many_paths(scene.settings);
    const auto truth = scenes::render(*device_, "reference", scene, 1);  // other paths than index 0
    ASSERT_TRUE(truth) << truth.error().line();
    GetParam().fine(scene.settings);
    EXPECT_NEAR(mean_luminance(render(scene).radiance) / mean_luminance(truth->radiance), 1,
                GetParam().of_reference);
}

TEST_P(Engines, NothingToSeeAndNothingToLightWithIsBlack) {
    AnalyticScene dark = floor_under_a_spot();
    dark.lights.clear();
    dark.settings.set(kOnlyBounce, -1);
    for (const glm::vec4& pixel : render(dark).radiance) ASSERT_EQ(glm::vec3(pixel), kO);
    AnalyticScene empty = floor_under_a_spot();
    empty.surfels.clear();
    empty.settings.set(kOnlyBounce, -1);
    for (const glm::vec4& pixel : render(empty).radiance) ASSERT_EQ(glm::vec3(pixel), kO);
}

TEST_P(Engines, LightOnASurfaceOrInsideAWallGivesFinitePictures) {
    for (const glm::vec3& place : {glm::vec3(1, 1, 0), glm::vec3(1, 1, -1e-4f), glm::vec3(1, 1, 1e-4f)}) {
        AnalyticScene scene = floor_under_a_spot();
        scene.lights = {spot(place, place + kZ, 1.2f, 1.0f, 10), spot(place, place - kZ, 1.2f, 1.0f, 10)};
        scene.settings.set(kOnlyBounce, -1);
        render(scene);
    }
}

TEST_P(Engines, SamePicturesEveryRun) {
    AnalyticScene scene = lit_corner();
    scene.settings.set(kOnlyBounce, -1);
    const auto first = render(scene), second = render(scene);
    EXPECT_EQ(first.radiance, second.radiance);
}

std::vector<Claims> registered() {
    std::vector<Claims> found;
    for (const auto& entry : engines())
        for (const Claims& claims : kClaims)
            if (entry.info.name == claims.engine) found.push_back(claims);
    return found;
}

INSTANTIATE_TEST_SUITE_P(All, Engines, testing::ValuesIn(registered()), [](const auto& tested) {
    return std::string(tested.param.engine) + tested.param.way;
});

TEST(EngineTable, EveryEngineIsTested) {
    for (const auto& entry : engines()) {
        if (entry.info.name == "unlit") continue;  // computes no light, and has tests of its own
        EXPECT_TRUE(std::ranges::any_of(kClaims, [&](const Claims& claims) {
            return entry.info.name == claims.engine;
        })) << entry.info.name;
    }
}

}  // namespace
}  // namespace lucarne::gi
