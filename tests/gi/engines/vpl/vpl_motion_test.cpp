// While something moves, light is made step by step, and pictures show earlier light meanwhile.
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/lighting.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "gi/shared/luminance.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

const StepBudget kOneStep = StepBudget::timed(0), kNoStep = StepBudget::paused();
constexpr int kMostSteps = 200;

double mean_luminance(const std::vector<glm::vec4>& radiance) {
    double sum = 0;
    for (const glm::vec4& pixel : radiance) sum += luminance(glm::vec3(pixel));
    return sum / static_cast<double>(radiance.size());
}

/// Returns how much two pictures differ, relative to their light. Some drivers give other last bits every
/// time.
double difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
        sum += std::abs(luminance(glm::dvec3(a[i])) - luminance(glm::dvec3(b[i])));
    return sum / static_cast<double>(a.size()) / mean_luminance(a);
}
constexpr double kSame = 1e-3;

class VplMotion : public OnDevice {
 protected:
    VplMotion() : cloud_(scenes::closed_box(2, 60, glm::vec3(.6f))) {
        options_.lights = {scenes::spot(glm::vec3(.6f, 1, 1.8f), glm::vec3(1, 1, 0), .6f, .6f, 5)};
        options_.settings.set(kBounces, 1);
        options_.settings.set(kVpls, 128);
        options_.settings.set(vpl::kAtlas, 512);
        options_.settings.set(vpl::kViewVpls, false);
        options_.settings.set(vpl::kReuse, false);
        options_.bounds = {glm::vec3(0), glm::vec3(2)};
    }
    std::vector<glm::vec4> picture(Engine& engine) {
        return light_up(*device, engine, cloud_, look(eye_, glm::vec3(1.2f, 1.3f, .9f), 48, 48), options_)
            .radiance;
    }
    std::vector<glm::vec4> at_once(Engine& engine) {
        options_.light_budget = {};
        return picture(engine);
    }
    std::vector<glm::vec4> in_motion(Engine& engine, const StepBudget& light_budget) {
        options_.moving = true;
        options_.light_budget = light_budget;
        return picture(engine);
    }
    /// Makes frames in motion until the engine has made all light. Returns the last.
    std::vector<glm::vec4> settled(Engine& engine, int* frames = nullptr) {
        for (int i = 1; i < kMostSteps; ++i) {
            auto radiance = in_motion(engine, kOneStep);
            if (frames) *frames = i;
            if (!engine.reads_light_cuts()) return radiance;
        }
        ADD_FAILURE() << "the light is never finished";
        return {};
    }

    const SurfelCloud cloud_;
    LitOptions options_;
    glm::vec3 eye_{.3f, .4f, .5f};
};

TEST_F(VplMotion, StepsEndWithTheLightThatIsMadeAtOnce) {
    for (const bool view_vpls : {false, true}) {
        // With as many VPLs, steps draw as many candidates for them as all at once do.
        options_.settings.set(vpl::kViewVpls, view_vpls);
        options_.settings.set(kVpls, view_vpls ? 4096 : 128);
        options_.settings.set(vpl::kAtlas, view_vpls ? 1024 : 512);
        auto engine = *make_engine("vpl"), other = *make_engine("vpl");
        int frames = 0;
        const auto stepwise = settled(*engine, &frames);
        EXPECT_GT(frames, 4) << "one step a frame";
        if (!view_vpls) {
            EXPECT_LT(difference(stepwise, at_once(*other)), kSame);
        }
        EXPECT_NEAR(mean_luminance(stepwise) / mean_luminance(at_once(*other)), 1, .05);
        EXPECT_LT(difference(in_motion(*engine, kOneStep), stepwise), kSame) << "nothing is made again";
    }
}

TEST_F(VplMotion, FirstFramesAreLitEvenlyAndNeverBlack) {
    auto engine = *make_engine("vpl"), direct = *make_engine("direct");
    in_motion(*engine, kOneStep);
    for (int i = 0; i < 4; ++i) in_motion(*engine, kOneStep);
    ASSERT_TRUE(engine->reads_light_cuts());
    const auto early = in_motion(*engine, kNoStep), lamp = at_once(*direct);
    const auto late = settled(*engine);
    for (size_t i = 0; i < early.size(); ++i) ASSERT_GT(early[i].x, lamp[i].x) << i;
    const double indirect = mean_luminance(late) - mean_luminance(lamp);
    EXPECT_NEAR((mean_luminance(early) - mean_luminance(lamp)) / indirect, 1, .6) << "about as bright";
}

TEST_F(VplMotion, EarlierLightIsShownMeanwhile) {
    auto engine = *make_engine("vpl");
    const auto still = at_once(*engine);
    // The lamp is dimmed: direct light follows at once, light from the walls when it is made.
    for (Light& light : options_.lights) light.strength *= .5f;
    auto direct = *make_engine("direct");
    const double half = mean_luminance(at_once(*direct));
    const double meanwhile = mean_luminance(in_motion(*engine, kNoStep));
    EXPECT_NEAR(meanwhile, mean_luminance(still) - half, 1e-4 * meanwhile);
    EXPECT_NEAR(mean_luminance(settled(*engine)), mean_luminance(still) / 2, .05 * meanwhile);
}

TEST_F(VplMotion, ALampThatNeverRestsIsFollowed) {
    auto engine = *make_engine("vpl");
    at_once(*engine);
    bool finished = false;
    for (int i = 0; i < kMostSteps && !finished; ++i) {
        options_.lights[0].position.x += .001f;
        options_.lights[0].strength = glm::vec4(10, 10, 10, 0);
        in_motion(*engine, kOneStep);
        finished = i > 0 && !engine->reads_light_cuts();
    }
    EXPECT_TRUE(finished);
}

TEST_F(VplMotion, VplsOfAllBouncesShareTheTimeOfOne) {
    options_.settings.set(kBounces, 3);
    auto engine = *make_engine("vpl");
    const double all = mean_luminance(at_once(*engine));
    const double united = mean_luminance(in_motion(*engine, kNoStep));
    EXPECT_NEAR(united / all, 1, .04);
    options_.settings.set(kOnlyBounce, 2);
    auto second = *make_engine("vpl");
    const auto one = at_once(*second);
    EXPECT_LT(difference(in_motion(*second, kNoStep), one), kSame) << "a single bounce is shown as it is";
}

TEST_F(VplMotion, AFrameThatIsGivenUpLeavesNothingBehind) {
    const std::atomic<bool> stop = true;
    for (const bool first : {true, false}) {
        auto engine = *make_engine("vpl"), fresh = *make_engine("vpl");
        options_.moving = false;
        if (!first) at_once(*engine);
        eye_.x += .1f;
        options_.index = 1;
        options_.stop = &stop;
        at_once(*engine);
        EXPECT_FALSE(engine->reads_light_cuts());
        options_.index = 0;
        options_.stop = nullptr;
        EXPECT_LT(difference(at_once(*engine), at_once(*fresh)), kSame);
        EXPECT_LT(difference(settled(*engine), at_once(*fresh)), kSame);
    }
}

TEST(UnitedBounces, SharesFollowTheLightAndKeepIt) {
    auto device = *Device::headless();
    vpl::Lighting lighting;
    lighting.layout = *vpl::atlas_layout(256, 64);
    const float light[] = {8, 2, 0};
    for (const float strength : light) {
        vpl::Bounce bounce;
        vpl::VplLight vpl = vpl::kDeadLight;
        vpl.diffuse = glm::vec4(strength, strength, strength, 1);
        vpl.position.w = .1f;
        bounce.seeds.host_lights.assign(64, vpl);
        bounce.seeds.lights = *device->buffer(64 * sizeof(vpl::VplLight), "lights");
        bounce.seeds.lights.upload_all(bounce.seeds.host_lights);
        bounce.atlas = *device->buffer(lighting.layout.texels() * sizeof(uint32_t), "atlas");
        bounce.atlas.clear(static_cast<uint32_t>(strength));
        lighting.bounces.push_back(std::move(bounce));
    }
    ASSERT_TRUE(vpl::unite_bounces(*device, lighting));
    const auto united = lighting.united.seeds.lights.download_all<vpl::VplLight>(64);
    const auto atlas = lighting.united.atlas.download_all<uint32_t>(lighting.layout.texels());
    double sum = 0;
    size_t second = 0;
    for (size_t i = 0; i < united.size(); ++i) {
        sum += static_cast<double>(united[i].diffuse.x);
        const bool of_second = atlas[i * atlas.size() / united.size()] == 2;
        second += of_second;
        EXPECT_NEAR(united[i].position.w, united[i].diffuse.x / (of_second ? 2 : 8) * .1f, 1e-6f);
    }
    EXPECT_EQ(second, 16u) << "at least one for each tile of 4 x 4 pixels";
    EXPECT_NEAR(sum, 64 * (8 + 2), 1e-3);
}

}  // namespace
}  // namespace lucarne::gi
