// Rims of surfaces: the discs beyond an outline, which are seen from behind.
#include "gi/raster/rims.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>

#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

constexpr float kColumnRadius = 0.3f;  // m
const glm::vec2 kAxis(0, 3);           // of the column: x and y, m

/// A column that stands before a wall, with an uneven pattern of surfels whose normals point outward (`side`
/// 1) or inward (-1).
std::vector<Surfel> column_before_wall(float spacing, float side = 1) {
    auto surfels = wall(5, 3, 2 * spacing, kRed, 3);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> jitter(-0.5f, 0.5f);
    for (float turn = 0; turn < 6.2831f; turn += spacing / kColumnRadius)
        for (float z = -1; z <= 1; z += spacing) {
            const float angle = turn + jitter(random) * spacing / kColumnRadius;
            const float height = z + jitter(random) * spacing;
            const glm::vec3 normal(std::cos(angle), std::sin(angle), 0);
            const glm::vec3 at(kAxis.x + kColumnRadius * normal.x, kAxis.y + kColumnRadius * normal.y,
                               height);
            surfels.push_back({at, side * normal, kWhite, 0, spacing * spacing, 0});
        }
    return surfels;
}

/// Two faces that meet in the upright line through (0, 2), with noise of .2 spacings: one at y = 2, which
/// faces the viewer, and one at x = 0 from there to y = `end`, which faces away from him. Their discs end at
/// the line.
std::vector<Surfel> two_faces(float spacing, float end) {
    std::vector<Surfel> surfels;
    std::mt19937 random(6);
    std::normal_distribution<float> noise(0, 0.2f * spacing);
    const float beyond = 0.05f * spacing;
    for (float along = 0.5f * spacing; along < 1; along += spacing)
        for (float z = -0.5f; z <= 0.5f; z += spacing) {
            surfels.push_back({{-along, 2 + noise(random), z}, {0, -1, 0}, kWhite, 0, spacing * spacing, 0});
            surfels.back().edge = {1 / (along + beyond), 0, 0};
        }
    const float back = end > 2 ? 1.0f : -1.0f;
    for (float along = 0.5f * spacing; along < back * (end - 2); along += spacing)
        for (float z = -0.5f; z <= 0.5f; z += spacing) {
            surfels.push_back(
                {{noise(random), 2 + back * along, z}, {1, 0, 0}, kWhite, 0, spacing * spacing, 0});
            surfels.back().edge = {0, -back / (along + beyond), 0};
        }
    return surfels;
}

class Rims : public GBufferTest {
 protected:
    /// Draws surfels blended, with their rims turned or not.
    Picture picture(const std::vector<Surfel>& surfels, const CameraView& view, bool turned) {
        const SurfelCloud cloud(surfels, {{-32, -32, -32}, 64}, 1024);
        auto loaded = load_cloud(*device, cloud);
        EXPECT_TRUE(loaded) << loaded.error().line();
        GBuffer target;
        EXPECT_TRUE(rasterize(*device, (*loaded)->cut, view, target));
        EXPECT_TRUE(blend(*device, (*loaded)->cut, view, target));
        if (turned) {
            EXPECT_TRUE(turn_rims(*device, view, target));
        }
        const size_t pixels = size_t{view.width} * view.height;
        return {view,
                target.texels.download_all<GBufferTexel>(pixels),
                target.ids.download_all<uint32_t>(pixels),
                {}};
    }
};

/// Returns the number of pixels of the column whose normal points into it.
size_t lit_inside(const Picture& p) {
    size_t count = 0;
    for (size_t at = 0; at < p.texels.size(); ++at) {
        if (p.empty(at) || p.red(at)) continue;
        const glm::vec2 pixel(static_cast<float>(at % p.view.width), static_cast<float>(at / p.view.width));
        const glm::vec3 place = texel_position(p.view, pixel, p.texels[at]);
        const glm::vec2 outward = glm::normalize(glm::vec2(place) - kAxis);
        if (glm::dot(glm::vec2(texel_normal(p.texels[at])), outward) < 0) ++count;
    }
    return count;
}

TEST_P(Rims, OutlinesOfASolidAreLitOnItsOutside) {
    for (const float side : {1.0f, -1.0f})  // scans without stations may have normals on the other side
        for (const float spacing : {0.008f, 0.02f, 0.04f}) {
            const auto surfels = column_before_wall(spacing, side);
            const CameraView view = look({0, 0, 0}, {0, 1, 0}, 320, 240, 0.7f);
            const size_t before = lit_inside(picture(surfels, view, false));
            EXPECT_GT(before, 20u) << spacing;
            EXPECT_LE(lit_inside(picture(surfels, view, true)), before / 20) << spacing;
        }
}

TEST_P(Rims, TurnedNormalsFaceTheViewer) {
    const auto surfels = column_before_wall(0.02f);
    const CameraView view = look({0.1f, 0, 0}, {0.05f, 1, 0.1f}, 320, 240, 0.7f);
    const Picture before = picture(surfels, view, false), after = picture(surfels, view, true);
    size_t turned = 0;
    for (uint32_t at = 0; at < after.texels.size(); ++at) {
        if (before.texels[at].normal == after.texels[at].normal) continue;
        ++turned;
        // What faces away, were it only because normals are rounded, reflects nothing: a black point.
        const glm::vec3 ray = glm::normalize(after.ray(at % view.width, at / view.width));
        const float cosine = -glm::dot(texel_normal(after.texels[at]), ray);
        EXPECT_GT(cosine, 0) << at;
        EXPECT_LT(cosine, 0.01f) << at;
    }
    EXPECT_GT(turned, 100u);
}

TEST_P(Rims, SurfacesSeenFromBehindStayAsTheyAre) {
    // Walls seen from behind, straight on and at a low angle.
    for (const glm::vec3& eye : {glm::vec3(0, 5, 0), glm::vec3(3, 2.6f, 0)}) {
        const auto surfels = wall(2, 2, 0.02f, kWhite, 2);
        const CameraView view = look(eye, {0, 2, 0}, 160, 120, 0.9f);
        const Picture before = picture(surfels, view, false), after = picture(surfels, view, true);
        EXPECT_EQ(std::memcmp(before.texels.data(), after.texels.data(),
                              before.texels.size() * sizeof(GBufferTexel)),
                  0);
    }
}

TEST_P(Rims, FlippedNormalsOfAWallStillFaceTheViewer) {
    auto surfels = wall(2, 2, 0.02f, kWhite, 2);
    std::mt19937 random(7);
    for (Surfel& s : surfels)
        if (random() % 20 == 0) s.normal = -s.normal;
    const CameraView view = look({3, 1.4f, 0}, {0, 2, 0}, 160, 120, 0.9f);
    const Picture p = picture(surfels, view, true);
    size_t shown = 0;
    for (uint32_t at = 0; at < p.texels.size(); ++at) {
        if (p.empty(at)) continue;
        ++shown;
        const glm::vec3 ray = p.ray(at % view.width, at / view.width);
        EXPECT_LE(glm::dot(texel_normal(p.texels[at]), ray), 1e-3f * glm::length(ray));
        EXPECT_LT(texel_normal(p.texels[at]).y, -0.7f) << "as the wall's";
    }
    EXPECT_GT(shown, 5000u);
}

TEST_P(Rims, HiddenFacesOfASolidDoNotShowAtItsEdges) {
    for (const float spacing : {0.01f, 0.02f})
        for (const bool before_wall : {true, false}) {
            auto surfels = two_faces(spacing, 3);
            if (before_wall) append(surfels, wall(5, 5, 0.04f, kRed, 3));
            const CameraView view = look({-0.7f, 0, 0}, {-0.2f, 2, 0}, 480, 360, 0.7f);
            const Picture before = picture(surfels, view, false), after = picture(surfels, view, true);
            size_t hidden = 0, left = 0, behind = 0;
            for (uint32_t at = 0; at < after.texels.size(); ++at) {
                const GBufferTexel& texel = after.texels[at];
                if (before.empty(at) || before.red(at) || texel_normal(before.texels[at]).y < -0.9f) {
                    EXPECT_EQ(std::memcmp(&before.texels[at], &texel, sizeof(GBufferTexel)), 0);
                    continue;
                }
                ++hidden;
                const glm::vec2 pixel(static_cast<float>(at % view.width),
                                      static_cast<float>(at / view.width));
                const glm::vec3 place = texel_position(view, pixel, texel);
                if (after.empty(at) || after.red(at)) {  // beyond the block
                    ++behind;
                    EXPECT_NE(after.ids[at], before.ids[at]);
                    EXPECT_EQ(after.empty(at), !before_wall);
                    EXPECT_EQ(after.empty(at), texel.depth == 0);
                    EXPECT_NEAR(before_wall ? place.y : 5, 5, 0.03f);
                } else if (texel_normal(texel).y > -0.9f) {
                    ++left;
                } else {
                    EXPECT_NEAR(place.y, 2, 1.2f * spacing);
                    EXPECT_EQ(texel.albedo, before.texels[at].albedo);
                    EXPECT_EQ(after.ids[at], before.ids[at]);
                }
            }
            EXPECT_GT(hidden, 50u) << spacing;
            EXPECT_LE(left, hidden / 20) << spacing;
            EXPECT_GT(behind, hidden / 2) << spacing;
        }
}

TEST_P(Rims, WallsSeenFromBehindStayAsTheyAreInCorners) {
    const auto surfels = two_faces(0.02f, 1);
    const CameraView view = look({-0.7f, 0.5f, 0}, {-0.1f, 2, 0}, 320, 240, 0.7f);
    const Picture before = picture(surfels, view, false), after = picture(surfels, view, true);
    size_t behind = 0, changed = 0;
    for (uint32_t at = 0; at < after.texels.size(); ++at) {
        behind += (before.texels[at].albedo & kTexelFromBehind) != 0;
        changed += std::memcmp(&before.texels[at], &after.texels[at], sizeof(GBufferTexel)) != 0;
    }
    EXPECT_GT(behind, 5000u);
    EXPECT_LE(changed, behind / 1000);
}

/// A noisy ceiling that is seen at so low an angle that some of its discs show their other side.
TEST_P(Rims, MostTexelsOfASurfaceDecideOnItsSide) {
    for (const float side : {1.0f, -1.0f}) {
        std::vector<Surfel> surfels;
        std::mt19937 random(9);
        std::normal_distribution<float> tilt(0, 0.1f);
        for (float x = -2; x <= 2; x += 0.02f)
            for (float y = 1; y <= 6; y += 0.02f) {
                const float along = tilt(random), across = tilt(random);
                surfels.push_back({{x, y, 0.25f},
                                   side * glm::normalize(glm::vec3(along, across, -1)),
                                   kWhite,
                                   0,
                                   4e-4f,
                                   0});
            }
        const CameraView view = look({0, 0, 0}, {0, 1, 0.02f}, 320, 240, 0.3f);
        const Picture before = picture(surfels, view, false), after = picture(surfels, view, true);
        const auto above = [&](const Picture& p) {  // texels that would be lit from above
            size_t count = 0;
            for (size_t at = 0; at < p.texels.size(); ++at)
                count += !p.empty(at) && texel_normal(p.texels[at]).z > 0;
            return count;
        };
        EXPECT_GT(above(before), 100u);
        EXPECT_LE(above(after), above(before) / 4);
    }
}

TEST_P(Rims, TheSameAsByShaders) {
    auto column = column_before_wall(0.02f);
    auto corner = two_faces(0.02f, 3);
    append(corner, wall(5, 5, 0.04f, kRed, 3));
    for (const std::vector<Surfel>* surfels : {&column, &corner}) {
        const float x = surfels == &column ? 0.2f : -0.7f;
        const CameraView view = look({x, 0, 0}, {0, 1, 0.1f}, 320, 240, 0.7f);
        GBuffer target;
        const SurfelCloud cloud(*surfels, {{-32, -32, -32}, 64}, 1024);
        auto loaded = load_cloud(*device, cloud);
        ASSERT_TRUE(loaded) << loaded.error().line();
        ASSERT_TRUE(rasterize(*device, (*loaded)->cut, view, target));
        const size_t pixels = size_t{view.width} * view.height;
        const auto drawn = target.texels.download_all<GBufferTexel>(pixels);
        const auto drawn_ids = target.ids.download_all<uint32_t>(pixels);
        ASSERT_TRUE(turn_rims(*device, view, target));
        const auto turned = target.texels.download_all<GBufferTexel>(pixels);
        const auto turned_ids = target.ids.download_all<uint32_t>(pixels);
        target.texels.upload_all(drawn);
        target.ids.upload_all(drawn_ids);
        device->use_native_passes(false);
        ASSERT_TRUE(turn_rims(*device, view, target));
        device->use_native_passes(GetParam());
        const auto by_shaders = target.texels.download_all<GBufferTexel>(pixels);
        const auto ids_by_shaders = target.ids.download_all<uint32_t>(pixels);
        size_t changed = 0, replaced = 0, others = 0;
        for (size_t at = 0; at < pixels; ++at) {
            changed += std::memcmp(&drawn[at], &turned[at], sizeof(GBufferTexel)) != 0;
            const float apart = glm::distance(texel_normal(turned[at]), texel_normal(by_shaders[at]));
            replaced += turned_ids[at] != drawn_ids[at];
            others += !(apart < 2e-3f) || turned_ids[at] != ids_by_shaders[at] ||
                      turned[at].albedo != by_shaders[at].albedo ||
                      !(std::abs(turned[at].depth - by_shaders[at].depth) <= 1e-5f * turned[at].depth);
        }
        EXPECT_GT(changed, 20u);
        EXPECT_EQ(replaced > 20, surfels == &corner) << replaced;
        EXPECT_LE(others, 2u) << "where the last bits decide";
    }
}

INSTANTIATE_TEST_SUITE_P(Passes, Rims, ::testing::Bool(), passes_name);

}  // namespace
}  // namespace lucarne::gi
