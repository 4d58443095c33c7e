#include "gi/gather/upsample.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/gi/engines/analytic_frame.h"

namespace lucarne::gi {
namespace {

/// A picture of a floor whose left half is four metres lower, seen from above; `empty`: columns without a
/// surface.
struct Picture {
    CameraView camera = scenes::look({0, 0, 5}, {0, 0, 0}, 0.5f, 32);
    std::vector<SurfacePoint> surfaces = std::vector<SurfacePoint>(32 * 32);

    Picture() {
        for (size_t i = 0; i < surfaces.size(); ++i) {
            const float x = static_cast<float>(i % 32), y = static_cast<float>(i / 32);
            surfaces[i] = {
                {x / 6, y / 6, x < 16 ? -4.0f : 0.0f}, {0, 0, 1}, {0, 0, 1}, glm::vec3(0.5f), 0.02f, 0};
        }
    }
    /// The light that the grid gathered: 1 on the lower floor, 2 on the upper.
    std::vector<glm::vec4> gathered(const GatherGrid& grid) const {
        std::vector<glm::vec4> light;
        for (uint32_t row = 0; row < grid.rows(); ++row)
            for (uint32_t column = 0; column < grid.columns(); ++column)
                light.push_back(glm::vec4(surfaces[grid.pixel(column, row)].position.z < -0.5f ? 1 : 2));
        return light;
    }
};

TEST(Upsample, DoesNotMixSurfaces) {
    const Picture picture;
    for (const uint32_t step : {2u, 4u})
        for (const uint32_t place : {0u, step / 2, step - 1}) {
            const GatherGrid grid{32, 32, step, place, place};
            std::vector<glm::vec4> light(picture.surfaces.size());
            const auto missing =
                upsample(picture.camera, picture.surfaces, grid, picture.gathered(grid), light);
            EXPECT_LT(missing.size(), light.size() / 4);
            for (size_t i = 0; i < light.size(); ++i)
                if (!std::ranges::binary_search(missing, i)) {
                    EXPECT_NEAR(light[i].x, i % 32 < 16 ? 1 : 2, 1e-4) << step << " " << place << " " << i;
                }
        }
}

TEST(Upsample, ReturnsPixelsThatNothingGatheredFor) {
    Picture picture;
    const GatherGrid grid{32, 32, 4, 2, 2};
    // A thin pole between the pixels that gather.
    for (size_t y = 0; y < 32; ++y) picture.surfaces[32 * y + 20].normal = {0, 1, 0};
    std::vector<glm::vec4> light(picture.surfaces.size());
    const auto missing = upsample(picture.camera, picture.surfaces, grid, picture.gathered(grid), light);
    for (uint32_t y = 0; y < 32; ++y) EXPECT_TRUE(std::ranges::binary_search(missing, 32 * y + 20)) << y;
}

TEST(Upsample, LeavesPixelsWithoutASurfaceBlack) {
    Picture picture;
    for (size_t i = 0; i < 32; ++i) picture.surfaces[i].radius = 0;
    const GatherGrid grid{32, 32, 4, 2, 2};
    std::vector<glm::vec4> light(picture.surfaces.size(), glm::vec4(7));
    const auto missing = upsample(picture.camera, picture.surfaces, grid, picture.gathered(grid), light);
    for (size_t i = 0; i < 32; ++i) EXPECT_EQ(light[i], glm::vec4(0));
    EXPECT_FALSE(std::ranges::binary_search(missing, 3u));
}

}  // namespace
}  // namespace lucarne::gi
