// VPLs and maps are kept from frame to frame until something that they depend on changes.
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class VplHeld : public OnDevice {
 protected:
    struct Shot {
        float albedo = .5f, light_x = .6f;
        glm::vec3 eye{.3f, .4f, .5f};
        uint32_t bounces = 2;
    };
    std::vector<glm::vec4> picture(Engine& engine, const Shot& shot) {
        const SurfelCloud cloud(scenes::closed_box(2, 60, glm::vec3(shot.albedo)));
        LitOptions options;
        options.lights = {scenes::spot(glm::vec3(shot.light_x, 1, 1.8f), glm::vec3(1, 1, 0), .6f, .6f, 5)};
        options.settings.set(kBounces, shot.bounces);
        options.settings.set(kVpls, 64);
        options.settings.set(vpl::kAtlas, 512);
        return light_up(*device, engine, cloud, look(shot.eye, glm::vec3(1.2f, 1.3f, .9f), 48, 48), options)
            .radiance;
    }
    std::vector<glm::vec4> anew(const Shot& shot) { return picture(**make_engine("vpl"), shot); }
};

TEST_F(VplHeld, everyFrameIsWhatAnEngineOfItsOwnMakes) {
    auto engine = *make_engine("vpl");
    const Shot shots[] = {{},
                          {.eye = {.5f, .4f, .5f}},  // the camera alone moves
                          {.light_x = .9f},          // the light moves
                          {.light_x = .9f, .eye = {.5f, .4f, .5f}},
                          {.albedo = .7f, .light_x = .9f},  // the surfels change
                          {.albedo = .7f, .light_x = .9f, .bounces = 1},
                          {.albedo = .7f, .light_x = .9f, .bounces = 3}};
    for (const Shot& shot : shots) EXPECT_EQ(picture(*engine, shot), anew(shot)) << (&shot - shots);
}

}  // namespace
}  // namespace lucarne::gi
