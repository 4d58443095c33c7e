// Engines that use OpenCL share the device of their OpenGL device.
#include <gtest/gtest.h>

#include "gi/device/cl/cl_device.h"
#include "gi/registry.h"
#include "tests/added_engine/paint/bands.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using OpenClEngines = OnDevice;

TEST_F(OpenClEngines, TwoShareOneDeviceAndItsPrograms) {
    const SurfelCloud cloud(scenes::closed_box(4, 60, glm::vec3(.5f)));
    const CameraView camera = look({2, 1, 2}, {2, 4, 2}, 48, 48);
    const uint64_t before = device->memory_used();
    {
        const auto first = make_engine("paint"), second = make_engine("paint");
        ASSERT_TRUE(first && second);
        for (int frame = 0; frame < 2; ++frame)
            for (const auto* engine : {&first, &second}) {
                const Lit lit = light_up(*device, ***engine, cloud, camera, {});
                EXPECT_EQ(lit.at(24, 24), glm::vec3(0, 1, 0));
            }
        EXPECT_GE(device->memory_used(), before + 2 * paint::kBands * sizeof(glm::vec4))
            << "each has its buffer";
        const auto opencl = device->opencl();
        ASSERT_TRUE(opencl) << opencl.error().line();
        EXPECT_EQ((*opencl)->programs_built(), 1u);
    }
    EXPECT_EQ(device->memory_used(), before) << "engines return their buffers before the device goes";
}

}  // namespace
}  // namespace lucarne::gi
