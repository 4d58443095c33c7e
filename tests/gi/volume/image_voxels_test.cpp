// Voxels of what pictures have shown: of analytic scenes, whose pictures are computed here.
#include "gi/volume/images/image_voxels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"
#include "gi/volume/images/seen.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

/// Returns the distance along a ray to a surface and its normal; infinity: none.
struct Hit {
    float distance = std::numeric_limits<float>::infinity();
    glm::vec3 normal{0.0f};
};
using Scene = std::function<Hit(const glm::vec3& from, const glm::vec3& along)>;

Hit ball(const glm::vec3& middle, float radius, const glm::vec3& from, const glm::vec3& along) {
    const glm::vec3 way = from - middle;
    const float a = glm::dot(along, along), b = glm::dot(way, along),
                c = glm::dot(way, way) - radius * radius;
    const float root = b * b - a * c;
    if (root < 0) return {};
    const float t = (-b - std::sqrt(root)) / a;
    return t > 0 ? Hit{t, (way + t * along) / radius} : Hit{};
}
/// A wall of points with x = `x`.
Hit wall(float x, const glm::vec3& from, const glm::vec3& along) {
    const float t = (x - from.x) / along.x;
    return t > 0 ? Hit{t, {from.x > x ? 1 : -1, 0, 0}} : Hit{};
}
Hit nearer(const Hit& a, const Hit& b) {
    return a.distance < b.distance ? a : b;
}

CameraView view_from(const glm::vec3& from, const glm::vec3& to, uint32_t side) {
    const glm::vec3 forward = glm::normalize(to - from);
    const glm::vec3 up = std::abs(forward.z) < .9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(forward, up));
    return {.origin = glm::vec4(from, .01f),
            .forward = glm::vec4(forward, 0),
            .right = glm::vec4(.6f * right, 0),
            .up = glm::vec4(.6f * glm::cross(right, forward), 0),
            .width = side,
            .height = side,
            .projection = kPerspective,
            .pad0 = 0};
}

std::vector<GBufferTexel> picture(const CameraView& view, const Scene& scene,
                                  const glm::vec3& albedo = glm::vec3(.5f)) {
    std::vector<GBufferTexel> texels(size_t{view.width} * view.height, GBufferTexel{});
    for (size_t i = 0; i < texels.size(); ++i) {
        const glm::vec2 at(static_cast<float>(i % view.width) + .5f,
                           static_cast<float>(i / view.width) + .5f);
        const Hit hit = scene(view_start(view, at), view_ray(view, at));
        if (!std::isfinite(hit.distance)) continue;
        texels[i] = {hit.distance, encode_octahedral(hit.normal), encode_albedo(albedo) | kSurfelHasNormal,
                     0};
    }
    return texels;
}

/// Pictures and what they are views of.
struct Taken {
    CameraView view;
    std::vector<GBufferTexel> texels;
    std::vector<glm::vec3> light = {};
    bool of_light = false;
    SeenImage image() const { return {view, texels, light, of_light}; }
};
Taken taken(const glm::vec3& from, const glm::vec3& to, const Scene& scene, uint32_t side = 128) {
    const CameraView view = view_from(from, to, side);
    return {view, picture(view, scene)};
}

constexpr float kSide = .125f;
const glm::vec3 kMiddle(2, 2, 2);
Hit one_ball(const glm::vec3& from, const glm::vec3& along) {
    return ball(kMiddle, 1, from, along);
}
ImageVoxels window() {
    return {glm::ivec3(32), kSide, glm::ivec3(0)};
}
std::vector<glm::vec3> around() {
    std::vector<glm::vec3> places;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 way(.3f, .2f, .1f);
            way[axis] = 3.5f * side;
            places.push_back(kMiddle + way);
        }
    return places;
}

TEST(ImageVoxels, SamplesFillTheVoxelsOfTheirSurface) {
    ImageVoxels voxels = window();
    const Taken front = taken({-1.5f, 2, 2}, kMiddle, one_ball);
    const SeenImage image = front.image();
    voxels.update({&image, 1});
    EXPECT_GT(voxels.voxels().size(), 200u);
    for (const SeenVoxel& voxel : voxels.voxels()) {
        const glm::vec3 out = (glm::vec3(voxel.cell) + .5f) * kSide - kMiddle;
        EXPECT_NEAR(glm::length(out), 1, .87f * kSide);
        EXPECT_LT(out.x, .2f) << "only the visible half";
        EXPECT_GT(glm::dot(glm::normalize(out), decode_octahedral(voxel.normal)), .97f);
        EXPECT_NEAR(decode_albedo(voxel.albedo).x, .5f, .002f);
    }
}

TEST(ImageVoxels, ViewsFromAllSidesMakeTheWholeAndRepeatingThemChangesNothing) {
    for (const bool fused : {false, true}) {
        ImageVoxels voxels = window();
        size_t before = 0;
        for (const glm::vec3& from : around()) {
            const Taken view = taken(from, kMiddle, one_ball);
            const SeenImage image = view.image();
            voxels.update({&image, 1}, {.fused = fused});
            EXPECT_GE(voxels.voxels().size(), before);
            before = voxels.voxels().size();
        }
        // Every voxel whose middle lies within a quarter of a voxel of the ball is filled.
        size_t missing = 0, all = 0;
        for (int i = 0; i < 32 * 32 * 32; ++i) {
            const glm::ivec3 cell(i % 32, i / 32 % 32, i / 1024);
            const glm::vec3 middle = (glm::vec3(cell) + .5f) * kSide;
            if (std::abs(glm::length(middle - kMiddle) - 1) > .25f * kSide) continue;
            ++all;
            missing += voxels.at(cell) == nullptr;
        }
        EXPECT_GT(all, 400u);
        EXPECT_LE(missing, all / 100) << fused;
        for (const glm::vec3& from : around()) {
            const Taken view = taken(from, kMiddle, one_ball);
            const SeenImage image = view.image();
            voxels.update({&image, 1}, {.fused = fused});
        }
        EXPECT_NEAR(static_cast<double>(voxels.voxels().size()), static_cast<double>(before),
                    .02 * static_cast<double>(before));
    }
}

TEST(ImageVoxels, WhatHasGoneIsClearedWhereItIsSeenAndKeptWhereItIsNot) {
    for (const bool fused : {false, true}) {
        ImageVoxels voxels = window();
        const Scene both = [](const glm::vec3& from, const glm::vec3& along) {
            return nearer(ball({2, 2, 2}, .5f, from, along), wall(3.5f, from, along));
        };
        const Scene only_wall = [](const glm::vec3& from, const glm::vec3& along) {
            return wall(3.5f, from, along);
        };
        const ImageUpdate how{.fused = fused};
        const Taken before = taken({-1.5f, 2, 2}, kMiddle, both);
        const SeenImage image = before.image();
        voxels.update({&image, 1}, how);
        const glm::ivec3 front(12, 16, 16);  // of the ball, at x = 1.5
        ASSERT_NE(voxels.at(front), nullptr);
        EXPECT_EQ(voxels.at({28, 16, 16}), nullptr) << "the wall behind the ball has not been seen";
        // A view that does not show the place keeps it, be it behind the viewer or beside the picture.
        for (const glm::vec3& to : {glm::vec3(-9, 2, 2), glm::vec3(2, 40, 2)}) {
            const Taken away = taken({-1.5f, 2, 2}, to, only_wall);
            const SeenImage elsewhere = away.image();
            voxels.update({&elsewhere, 1}, how);
            EXPECT_NE(voxels.at(front), nullptr);
        }
        const Taken after = taken({-1.5f, 2, 2}, kMiddle, only_wall);
        const SeenImage gone = after.image();
        voxels.update({&gone, 1}, how);
        EXPECT_EQ(voxels.at(front), nullptr);
        EXPECT_NE(voxels.at({28, 16, 16}), nullptr) << "the wall";
        for (const SeenVoxel& voxel : voxels.voxels()) EXPECT_GE(voxel.cell.x, 27);
        // What hides again stays: the wall behind a ball that has come back.
        voxels.update({&image, 1}, how);
        EXPECT_NE(voxels.at({28, 16, 16}), nullptr);
        EXPECT_NE(voxels.at(front), nullptr);
    }
}

TEST(ImageVoxels, PicturesOfNothingClearAllThatTheyShow) {
    ImageVoxels voxels = window();
    const Taken front = taken({-1.5f, 2, 2}, kMiddle, one_ball);
    const SeenImage image = front.image();
    voxels.update({&image, 1});
    const Taken nothing = taken({-1.5f, 2, 2}, kMiddle, [](const auto&, const auto&) { return Hit{}; });
    const SeenImage empty = nothing.image();
    voxels.update({&empty, 1});
    EXPECT_EQ(voxels.voxels().size(), 0u);
}

/// A wall that is seen at a grazing angle: the depth of its pixels changes by more than a voxel from one to
/// the next.
TEST(ImageVoxels, SlantedWallsStayUnlessDepthsAloneAreCompared) {
    const Scene both = [](const glm::vec3& from, const glm::vec3& along) { return wall(2.05f, from, along); };
    size_t kept[2] = {};
    for (const bool careful : {false, true}) {
        ImageVoxels voxels = window();
        const Taken straight = taken({-1.5f, 2, 2}, kMiddle, both);
        const SeenImage front = straight.image();
        voxels.update({&front, 1}, {.careful = careful});
        const size_t before = voxels.voxels().size();
        const Taken slanted = taken({1.9f, -3, 2}, {2.1f, 2, 2}, both, 32);
        const SeenImage along = slanted.image();
        voxels.update({&along, 1}, {.samples = 1, .careful = careful});
        kept[careful] = voxels.voxels().size();
        if (careful) {
            EXPECT_GE(kept[1], before);
        }
    }
    EXPECT_LT(kept[0], kept[1] * 9 / 10) << "depths alone clear what is there";
}

TEST(ImageVoxels, LightReplacesAndThatOfSeveralLightsAddsUp) {
    for (const bool fused : {false, true}) {
        ImageVoxels voxels = window();
        const Scene scene = [](const glm::vec3& from, const glm::vec3& along) {
            return wall(2.05f, from, along);
        };
        const auto lit = [&](float light, bool of_light) {
            Taken view = taken({-1.5f, 2, 2}, kMiddle, scene);
            view.light.assign(view.texels.size(), glm::vec3(light));
            view.of_light = of_light;
            return view;
        };
        const Taken first = lit(2, true), second = lit(3, true), camera = lit(7, false), dark = lit(0, true);
        const ImageUpdate how{.fused = fused};
        const auto light = [&] { return voxels.at({16, 16, 16})->light.x; };
        const std::vector<SeenImage> lights = {first.image(), second.image()};
        for (int i = 0; i < 3; ++i) {
            voxels.update(lights, how);
            EXPECT_FLOAT_EQ(light(), 5) << "nothing adds up over time";
        }
        const std::vector<SeenImage> all = {first.image(), second.image(), camera.image()};
        voxels.update(all, how);
        EXPECT_FLOAT_EQ(light(), 7);
        const std::vector<SeenImage> off = {dark.image(), dark.image()};
        voxels.update(off, how);
        EXPECT_EQ(light(), 0) << "no stale light stays";
    }
}

TEST(ImageVoxels, AMovedWindowKeepsWhatStaysInsideAndEqualsOneThatWasThereFromTheBeginning) {
    const Taken front = taken({-1.5f, 2, 2}, kMiddle, one_ball);
    const SeenImage image = front.image();
    ImageVoxels moved = window();
    moved.update({&image, 1});
    const std::vector<SeenVoxel> before(moved.voxels().begin(), moved.voxels().end());
    for (const glm::ivec3 low : {glm::ivec3(-5, 3, 0), glm::ivec3(4, 12, -7), glm::ivec3(0)}) {
        moved.move_to(low);
        for (const SeenVoxel& voxel : moved.voxels())
            EXPECT_TRUE(glm::all(glm::greaterThanEqual(voxel.cell, low)) &&
                        glm::all(glm::lessThan(voxel.cell, low + 32)));
        if (low == glm::ivec3(-5, 3, 0)) {
            const auto inside = std::ranges::count_if(
                before, [&](const SeenVoxel& v) { return v.cell.x < 27 && v.cell.y >= 3; });
            EXPECT_EQ(moved.voxels().size(), static_cast<size_t>(inside));
        }
    }
    EXPECT_LT(moved.voxels().size(), before.size()) << "what was outside for a while is forgotten";
    ImageVoxels there({32, 32, 32}, kSide, {4, 12, -7});
    moved.move_to({4, 12, -7});
    for (ImageVoxels* voxels : {&moved, &there}) voxels->update({&image, 1});
    const VoxelSet a = moved.set(), b = there.set();
    EXPECT_EQ(difference(a, b).all(), 0u);
    EXPECT_EQ(a.origin, b.origin);
    ASSERT_FALSE(a.voxels.empty());
    moved.clear();
    EXPECT_TRUE(moved.voxels().empty());
    moved.update({&image, 1});
    EXPECT_EQ(moved.voxels().size(), b.voxels.size());
}

TEST(ImageVoxels, AreTheSameForAnyNumberOfThreads) {
    const auto run = [](bool fused) {
        ImageVoxels voxels = window();
        for (const glm::vec3& from : around()) {
            const Taken view = taken(from, kMiddle, one_ball, 96);
            const SeenImage image = view.image();
            voxels.update({&image, 1}, {.samples = 64, .fused = fused});
        }
        return std::vector<SeenVoxel>(voxels.voxels().begin(), voxels.voxels().end());
    };
    for (const bool fused : {false, true}) {
        const auto all = run(fused);
        const ThreadLimit limit(1);
        const auto one = run(fused);
        EXPECT_TRUE(std::ranges::equal(all, one, [](const SeenVoxel& a, const SeenVoxel& b) {
            return a.cell == b.cell && a.normal == b.normal && a.albedo == b.albedo && a.light == b.light;
        }));
    }
}

TEST(ImageVoxels, FusedPassesFillTheVoxelsWhoseMiddlesShowASurface) {
    // Passes skip what no picture can show; here every voxel is asked, also those about a viewer in the
    // window.
    const auto room = [](const glm::vec3& from, const glm::vec3& along) {
        return nearer(one_ball(from, along), nearer(wall(3.6f, from, along), wall(.2f, from, along)));
    };
    const std::vector<Taken> pictures = {taken({-2, 1, 5}, kMiddle, room),
                                         taken({3, .5f, 2.2f}, kMiddle, room),
                                         taken({.3f, .4f, .4f}, {.3f, 3, .9f}, room, 37)};
    const glm::ivec3 size(35, 30, 33), low(-3, 1, -2);
    ImageVoxels voxels(size, kSide, low);
    std::vector<SeenImage> images;
    for (const Taken& one : pictures) images.push_back(one.image());
    voxels.update(images, {.fused = true});
    size_t filled = 0;
    for (int i = 0; i < size.x * size.y * size.z; ++i) {
        const glm::ivec3 cell = low + glm::ivec3(i % size.x, i / size.x % size.y, i / size.x / size.y);
        bool surface = false;
        for (const SeenImage& image : images) {
            size_t pixel = 0;
            surface = surface ||
                      VoxelSight(image, kSide).at((glm::vec3(cell) + .5f) * kSide, pixel) == Sight::surface;
        }
        EXPECT_EQ(voxels.at(cell) != nullptr, surface) << cell.x << " " << cell.y << " " << cell.z;
        filled += surface;
    }
    EXPECT_GT(filled, 1000u);
}

TEST(ImageVoxels, HostileDepthsFillNothingBeyondTheWindow) {
    ImageVoxels voxels = window();
    Taken view = taken({-1.5f, 2, 2}, kMiddle, one_ball, 16);
    constexpr float kOdd[] = {NAN, INFINITY, -INFINITY, -1, 1e30f, 1e-30f};
    for (size_t i = 0; i < view.texels.size(); ++i) view.texels[i].depth = kOdd[i % std::size(kOdd)];
    const SeenImage image = view.image();
    for (const bool fused : {false, true}) voxels.update({&image, 1}, {.fused = fused});
    EXPECT_TRUE(voxels.voxels().empty());
}

}  // namespace
}  // namespace lucarne::gi::volume
