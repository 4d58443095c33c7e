// Pixels lit between the places of a grid, in one pass, against upsample() and the formulas of one number.
#include "gi/engines/paths/native/grid_light.h"

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/native/native.h"
#include "gi/shared/brdf.h"
#include "gi/shared/surfel_code.h"
#include "tests/gi/engines/analytic_frame.h"

namespace lucarne::gi::paths {
namespace {

/// A picture of two slopes side by side, with noisy normals, some pixels without a surface, and some
/// that look elsewhere.
struct NoisyPicture {
    CameraView camera;
    std::vector<GBufferTexel> texels;
    std::vector<Material> materials =
        device_materials({{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)},
                          {glm::vec4(.3f, .9f, 2, .2f), glm::vec4(0, 0, 0, 9)}});

    NoisyPicture(uint32_t width, uint32_t height, bool parallel) {
        camera = scenes::look({3, -2, 5}, {3, 1, 0}, 0.5f, height);
        camera.width = width;
        camera.right.w = 0.3f;
        camera.up.w = -0.2f;
        if (parallel) {
            camera.projection = kOrthographic;
            camera.right *= 3.0f;
            camera.up *= 3.0f;
        }
        std::mt19937 random(5);
        std::uniform_real_distribution<float> uniform(-1, 1);
        for (uint32_t i = 0; i < width * height; ++i) {
            const bool left = i % width < width / 2;
            glm::vec3 normal = left ? glm::vec3(0.2f, -0.5f, 1) : glm::vec3(-0.6f, -0.1f, 1);
            normal += 0.1f * glm::vec3(uniform(random), uniform(random), uniform(random));
            if (uniform(random) > 0.95f) normal = {1, -1, 0};
            const float depth =
                uniform(random) > 0.9f ? 0 : 5 + 0.02f * uniform(random) + (left ? 0.0f : 0.3f);
            const uint32_t material = uniform(random) > 0 ? 1 : 0;
            texels.push_back({depth, encode_octahedral(glm::normalize(normal)),
                              encode_albedo(glm::vec3(0.5f + 0.5f * uniform(random), 0.4f, 0.7f)),
                              material | (glm::packHalf2x16({0, 0.03f}) & 0xffff0000u)});
        }
    }
};

struct Lit {
    std::vector<glm::vec4> radiance;
    std::vector<uint32_t> missing;
    bool operator==(const Lit&) const = default;
};

/// Light that grows from row to row.
glm::vec3 light_of(size_t place) {
    return {1 + 0.01f * static_cast<float>(place), 2, 0.5f};
}

Lit in_one_pass(const NoisyPicture& picture, const GatherGrid& grid, float least_share = 0) {
    std::vector<native::GridLight> lights;
    for (uint32_t row = 0; row < grid.rows(); ++row)
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const std::vector<uint32_t> pixel = {grid.pixel(column, row)};
            const SurfacePoint at = visible_surfaces(picture.camera, picture.texels, pixel)[0];
            lights.push_back({at.position - glm::vec3(picture.camera.origin), at.radius > 0 ? 1.0f : 0.0f,
                              at.normal, light_of(lights.size())});
        }
    Lit lit{std::vector<glm::vec4>(picture.texels.size(), glm::vec4(1, 2, 3, 4)), {}};
    const gi::native::DiffuseTables reflectances(picture.materials);
    lit.missing = native::add_grid_light(
        {picture.camera, picture.texels, grid, lights, reflectances, lit.radiance, least_share});
    return lit;
}

Lit by_upsample(const NoisyPicture& picture, const GatherGrid& grid) {
    const auto surfaces = visible_surfaces(picture.camera, picture.texels);
    std::vector<glm::vec4> gathered, light(surfaces.size());
    for (size_t i = 0; i < size_t{grid.rows()} * grid.columns(); ++i) gathered.emplace_back(light_of(i), 0);
    Lit lit{std::vector<glm::vec4>(surfaces.size(), glm::vec4(1, 2, 3, 4)),
            upsample(picture.camera, surfaces, grid, gathered, light)};
    for (size_t i = 0; i < surfaces.size(); ++i) {
        if (!(surfaces[i].radius > 0) || std::ranges::binary_search(lit.missing, i)) continue;
        const Reflectance r = make_reflectance(
            picture.materials[surfaces[i].material % picture.materials.size()], surfaces[i].albedo);
        lit.radiance[i] += glm::vec4(r.kd / kPi, 0) * light[i];
    }
    return lit;
}

TEST(GridLight, PathsReflectWhatUpsampleInterpolates) {
    for (const bool parallel : {false, true})
        for (const auto& [width, height] : {std::pair{61u, 47u}, {64u, 32u}, {3u, 2u}, {1u, 1u}})
            for (const uint32_t step : {2u, 4u}) {
                const NoisyPicture picture(width, height, parallel);
                const GatherGrid grid{width, height, step, step / 2, step / 2};
                const std::string what = fmt::format("{} x {}, {}, {}", width, height, step, parallel);
                Lit lit = in_one_pass(picture, grid);
                std::ranges::sort(lit.missing);
                const Lit truth = by_upsample(picture, grid);
                // Rounding may decide which side of the threshold a pixel is on.
                std::vector<uint32_t> decided;
                std::ranges::set_symmetric_difference(lit.missing, truth.missing,
                                                      std::back_inserter(decided));
                EXPECT_LE(decided.size(), picture.texels.size() / 500) << what;
                for (size_t i = 0; i < truth.radiance.size(); ++i) {
                    if (std::ranges::binary_search(decided, i)) continue;
                    for (int c = 0; c < 4; ++c)
                        ASSERT_NEAR(lit.radiance[i][c], truth.radiance[i][c], 2e-4f)
                            << what << ", pixel " << i;
                }
                if (width > 32) {
                    EXPECT_GT(lit.missing.size(), picture.texels.size() / 50) << what;
                    EXPECT_LT(lit.missing.size(), picture.texels.size() / 4) << what;
                }
            }
}

TEST(GridLight, PathsLeaveOutPixelsBetweenTooFewPlaces) {
    const NoisyPicture picture(61, 47, false);
    const GatherGrid grid{61, 47, 4, 2, 2};
    Lit all = in_one_pass(picture, grid);
    std::ranges::sort(all.missing);
    for (const float least : {.3f, .6f, .9f}) {
        Lit sure = in_one_pass(picture, grid, least);
        std::ranges::sort(sure.missing);
        EXPECT_TRUE(std::ranges::includes(sure.missing, all.missing));
        EXPECT_GT(sure.missing.size(), all.missing.size()) << least;
        for (uint32_t i = 0; i < all.radiance.size(); ++i) {
            const bool is_missing = std::ranges::binary_search(sure.missing, i);
            ASSERT_EQ(sure.radiance[i], is_missing ? glm::vec4(1, 2, 3, 4) : all.radiance[i]) << i;
        }
        all = sure;  // a larger share leaves out more
    }
    // Those before the first column of places are beside two of four at most.
    for (uint32_t row = 0; row < 47; ++row)
        for (const uint32_t column : {0u, 1u}) {
            const uint32_t pixel = row * 61 + column;
            EXPECT_TRUE(picture.texels[pixel].depth == 0 || std::ranges::binary_search(all.missing, pixel));
        }
}

TEST(GridLight, PathsGiveTheSameBitsWithEveryInstructionSet) {
    const NoisyPicture picture(61, 47, false);
    const GatherGrid grid{61, 47, 4, 2, 2};
    const Lit fastest = in_one_pass(picture, grid, .6f);
    for (int set = 0; gi::native::use_instruction_set(set); ++set)
        EXPECT_TRUE(in_one_pass(picture, grid, .6f) == fastest) << "set " << set;
    gi::native::use_instruction_set(-1);
}

}  // namespace
}  // namespace lucarne::gi::paths
