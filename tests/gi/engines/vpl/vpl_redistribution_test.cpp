// Redistribution: VPLs of one bounce become those of the next.
#include <cmath>

#include <gtest/gtest.h>

#include "gi/engines/vpl/redistribution/redistribution.h"
#include "gi/lighting/direct_light.h"
#include "io/core/random.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

constexpr float kAlbedo = .5f, kRoomSide = 2, kLobeExponent = 400;
const glm::vec3 kIncident(.6f, 0, .8f);

class VplRedistribution : public OnDevice {
 protected:
    /// VPLs on the floor of a closed white box, and the VPLs of the next bounce.
    struct Step {
        std::vector<VplLight> before, after;
    };
    /// With a lobe, VPLs reflect by the lobe alone. `noise` moves the floor's surfels up and tilts them, m.
    Step redistributed(uint32_t seed, bool best_candidate = false, float specular = 0, float noise = 0) {
        constexpr uint32_t kCount = 256;
        Step step;
        for (uint32_t i = 0; i < kCount; ++i) {
            VplLight light = kDeadLight;
            const float x = .1f + 1.8f * static_cast<float>(i % 16) / 15,
                        y = .1f + 1.8f * static_cast<float>(i / 16) / 15;
            light.position = {x, y, 0, kRoomSide * kRoomSide / kCount};
            light.normal = {0, 0, 1, .02f};
            light.flux = {1, 1, 1, 1};
            light.diffuse = glm::vec4(glm::vec3(specular > 0 ? 0 : kAlbedo / 3.14159265f), kLobeExponent);
            light.incident = glm::vec4(kIncident, specular);
            step.before.push_back(light);
        }
        std::vector<Surfel> box = scenes::closed_box(kRoomSide, 150, glm::vec3(kAlbedo));
        Random random(7);
        for (Surfel& s : box) {
            if (s.normal.z < .9f) continue;
            const auto any = [&] { return static_cast<float>(2 * random.uniform() - 1); };
            s.position.z += noise * (1 + any());
            s.normal = glm::normalize(s.normal + glm::vec3(any(), any(), 0) * noise / s.radius);
        }
        const SurfelCloud cloud(box);
        auto loaded = load_cloud(*device, cloud);
        EXPECT_TRUE(loaded);
        const std::vector<Material> white = {{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)}};
        Buffer materials;
        EXPECT_TRUE(upload_materials(*device, white, materials));
        Seeds seeds;
        seeds.lights = *device->buffer(kCount * sizeof(VplLight), "lights");
        seeds.lights.upload_all(step.before);
        seeds.host_lights = step.before;
        PassTimes times(*device);
        ShadowMaps maps;
        const auto layout = atlas_layout(1024, kCount);
        EXPECT_TRUE(decode_casters(*device, (*loaded)->cut, maps));
        EXPECT_TRUE(draw_shadow_maps(*device, (*loaded)->cut, seeds, *layout, true, times, maps));
        Redistribution scratch;
        Seeds next;
        scratch.best_candidate = best_candidate;
        EXPECT_TRUE(
            redistribute(*device, (*loaded)->cut, maps, materials, specular > 0, seed, seeds, scratch, next));
        step.after = next.host_lights;
        return step;
    }
};

double sum_of_flux(const std::vector<VplLight>& lights) {
    double sum = 0;
    for (const VplLight& l : lights) sum += l.flux.x;
    return sum;
}

TEST_F(VplRedistribution, inAClosedBoxAllReflectedFluxLands) {
    double landed = 0, returned = 0, left = 0;
    for (uint32_t seed = 0; seed < 4; ++seed) {
        const Step step = redistributed(seed);
        left += kAlbedo * sum_of_flux(step.before);
        landed += sum_of_flux(step.after);
        for (const VplLight& l : step.after) returned += 3.14159265 * l.diffuse.x / kAlbedo;
    }
    EXPECT_NEAR(landed / left, 1, .02);    // each VPL by its own race
    EXPECT_NEAR(returned / left, 1, .04);  // by all races together, and with discs instead of points
}

TEST_F(VplRedistribution, newLightsStandOnTheWallsAndFaceInward) {
    size_t on_the_floor = 0;
    for (const VplLight& l : redistributed(1).after) {
        const glm::vec3 p(l.position), n(l.normal), middle(kRoomSide / 2);
        const glm::vec3 off = glm::abs(p - middle);
        EXPECT_NEAR(std::max({off.x, off.y, off.z}), kRoomSide / 2, 1e-3);
        EXPECT_GT(glm::dot(n, middle - p), .9f);
        on_the_floor += p.z < 1e-3f;
    }
    EXPECT_EQ(on_the_floor, 0u);  // points of a plane do not see each other
}

// Shading drops light between points of one noisy surface, so light that the race sent there would be lost.
TEST_F(VplRedistribution, newLightsDoNotStandOnTheirOwnNoisyFloor) {
    const Step step = redistributed(1, false, 0, .008f);
    size_t on_the_floor = 0, alive = 0;
    double returned = 0;
    for (const VplLight& l : step.after) {
        alive += glm::vec3(l.normal) != glm::vec3(0);
        on_the_floor += l.position.z < .05f;
        returned += 3.14159265 * l.diffuse.x / kAlbedo;
    }
    EXPECT_LE(on_the_floor, 8u);  // some stand low on the walls
    EXPECT_EQ(alive, step.before.size());
    EXPECT_NEAR(returned / (kAlbedo * sum_of_flux(step.before)), 1, .06);
}

TEST_F(VplRedistribution, theLightOfALobeLandsWhereTheLobePoints) {
    const Step step = redistributed(5, false, .5f);
    // The modified Phong lobe returns its share times the cosine of the mirror direction.
    const double lobe = .5 * kIncident.z * (kLobeExponent + 2) / (kLobeExponent + 1);
    EXPECT_NEAR(sum_of_flux(step.after) / sum_of_flux(step.before) / lobe, 1, .02);
    const glm::vec3 mirrored(-kIncident.x, -kIncident.y, kIncident.z);
    double off = 0, far = 0;
    for (size_t i = 0; i < step.after.size(); ++i) {
        if (step.before[i].position.x < 1) continue;  // footprints are wide near the wall
        off += 1 - glm::dot(-glm::vec3(step.after[i].incident), mirrored);
        ++far;
    }
    EXPECT_GT(off / far, .8 / (kLobeExponent + 1));  // the mean of 1 - cos over the lobe is 1 / (n + 1)
    EXPECT_LT(off / far, 3 / (kLobeExponent + 1));   // footprints and texels widen the lobe
}

TEST_F(VplRedistribution, footprintsShareOutTheSurfaceThatIsLit) {
    double area = 0;
    for (const VplLight& l : redistributed(2).after) area += l.position.w;
    EXPECT_NEAR(area / (5 * kRoomSide * kRoomSide), 1,
                .25);  // 1 / density, a noisy estimate of the walls and the ceiling
}

TEST_F(VplRedistribution, theSameEveryRunAndAnotherForAnotherSeed) {
    const Step first = redistributed(3), again = redistributed(3), other = redistributed(4);
    size_t differ = 0;
    for (size_t i = 0; i < first.after.size(); ++i) {
        EXPECT_EQ(first.after[i].position, again.after[i].position);
        EXPECT_EQ(first.after[i].diffuse, again.after[i].diffuse);
        differ += first.after[i].position != other.after[i].position;
    }
    EXPECT_GT(differ, first.after.size() / 2);
}

TEST_F(VplRedistribution, theBestCandidateClumpsWhereTheRaceSpreads) {
    // All VPLs see the middle of the ceiling most strongly, and the choice of the paper puts all new VPLs
    // there.
    const auto spread = [](const Step& step) {
        double sum = 0;
        for (const VplLight& l : step.after)
            sum += glm::length(glm::vec3(l.position) - glm::vec3(kRoomSide / 2, kRoomSide / 2, kRoomSide));
        return sum / static_cast<double>(step.after.size());
    };
    double strayed = 0;
    const Step best = redistributed(1, true);
    for (size_t i = 0; i < best.after.size(); ++i)
        strayed += glm::length(glm::vec2(best.after[i].position) - glm::vec2(best.before[i].position));
    EXPECT_LT(strayed / static_cast<double>(best.after.size()), .3);  // straight above each, always
    EXPECT_GT(spread(redistributed(1)), .5);
}

}  // namespace
}  // namespace lucarne::gi::vpl
