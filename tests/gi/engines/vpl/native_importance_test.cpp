// The importance map in C++ is that of the shaders.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/native/native.h"
#include "tests/gi/engines/vpl/light_view.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

class NativeImportance : public OnDevice {
 protected:
    struct Lamp {
        const char* name;
        Light light;
        uint32_t face;
    };
    static std::vector<Lamp> lamps() {
        const auto lamp = [](uint32_t kind, const glm::vec3& forward, float spread) {
            Light light{};
            light.kind = kind;
            light.position = glm::vec4(0, 0, 0, std::cos(spread));
            light.direction = glm::vec4(forward, std::cos(spread / 2));
            light.strength = glm::vec4(3, 2, 1, 0);
            light.extent = glm::vec4(1, 0, 0, 0);
            return light;
        };
        const glm::vec3 down(0, 0, -1);
        return {{"spot", lamp(kSpotLight, down, .7f), 0},
                {"sharp spot", lamp(kSpotLight, down, 0), 0},
                {"sun", lamp(kDirectionalLight, down, 0), 0},
                {"point", lamp(kPointLight, down, 0), 5},
                {"quarter of an area", lamp(kCosineLight, down, 0), 2}};
    }
    /// Returns all levels of the map of a view of random surfaces with holes.
    std::vector<glm::vec2> map(const Lamp& lamp, uint32_t width, uint32_t height, double& sum) {
        const CameraView view{glm::vec4(0, 0, 0, .01f),
                              glm::vec4(0, 0, -1, 0),
                              glm::vec4(1.1f, 0, 0, 0),
                              glm::vec4(0, 1.1f, 0, 0),
                              width,
                              height,
                              0,
                              0};
        std::mt19937 random(5);
        std::vector<GBufferTexel> texels(size_t{width} * height);
        for (GBufferTexel& texel : texels) {
            texel.depth = random() % 5 ? 1 + static_cast<float>(random() % 1000) / 200 : 0;
            texel.albedo = random();
            texel.material = random() & 0xffff0001u;
        }
        if (texels.size() > 3) texels[3].depth = NAN;
        GBuffer gbuffer;
        gbuffer.width = width;
        gbuffer.height = height;
        gbuffer.texels = *device->buffer(texels.size() * sizeof(GBufferTexel), "texels");
        gbuffer.texels.upload_all(texels);
        Buffer materials, target;
        EXPECT_TRUE(upload_materials(*device,
                                     {{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)},
                                      {glm::vec4(.5f, 0, .25f, 0), glm::vec4(0, 0, 0, 1)}},
                                     materials));
        const SurfelCloud nothing(std::vector<Surfel>{});
        const auto loaded = load_cloud(*device, nothing);
        const LightGBuffer seen{lamp.light, lamp.face, view, (*loaded)->cut, gbuffer};
        const auto flux = map_importance(*device, seen, materials, false, target);
        EXPECT_TRUE(flux);
        sum = flux ? *flux : 0;
        return target.download_all<glm::vec2>(target.bytes() / sizeof(glm::vec2));
    }
};

TEST_F(NativeImportance, IsThatOfTheShaders) {
    for (const Lamp& lamp : lamps())
        for (const auto& [width, height] : {std::pair{64u, 64u}, {37u, 21u}, {90u, 40u}, {1u, 1u}}) {
            double native_sum = 0, sum = 0;
            device->use_native_passes(true);
            const auto native = map(lamp, width, height, native_sum);
            device->use_native_passes(false);
            const auto shaders = map(lamp, width, height, sum);
            ASSERT_EQ(native.size(), shaders.size());
            EXPECT_NEAR(native_sum, sum, 1e-3 * sum) << lamp.name;
            size_t different = 0;
            for (size_t i = 0; i < native.size(); ++i)
                different += !(std::abs(native[i].x - shaders[i].x) <= 1e-4f * shaders[i].x + 1e-9f) ||
                             native[i].y != shaders[i].y;
            // A corner may lie on the border of a face or a cone, by rounding.
            EXPECT_LE(different, native.size() / 100) << lamp.name << " " << width << " x " << height;
        }
}

TEST_F(NativeImportance, EveryInstructionSetGivesTheSameBits) {
    double sum = 0;
    device->use_native_passes(true);
    const auto fastest = map(lamps().front(), 90, 40, sum);
    for (int set = 0; gi::native::use_instruction_set(set); ++set)
        EXPECT_EQ(map(lamps().front(), 90, 40, sum), fastest) << set;
}

}  // namespace
}  // namespace lucarne::gi::vpl
