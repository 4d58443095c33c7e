// The shared text of camera rays and discs, and the native passes' vectors beside it.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "gi/native/texels-inl.h"
#include "gi/raster/native/disc-inl.h"
#include "gi/raster/native/large_disc.h"
#include "gi/shared/disc.h"
#include "gi/shared/edge.h"
#include "gi/shared/frame.h"

namespace lucarne::gi {
namespace {

namespace vectors = native::HWY_NAMESPACE;

/// Numbers from -1 to 1.
class Numbers {
 public:
    float operator()() { return uniform_(random_); }
    vec3 unit() {
        vec3 v((*this)(), (*this)(), (*this)());
        while (dot(v, v) < 0.01f || dot(v, v) > 1) v = vec3((*this)(), (*this)(), (*this)());
        return normalize(v);
    }

 private:
    std::mt19937 random_{11};
    std::uniform_real_distribution<float> uniform_{-1, 1};
};

CameraView some_view(Numbers& number, uint32_t projection) {
    const vec3 forward = number.unit();
    vec3 right, up;
    frame_about(forward, right, up);
    CameraView view{};
    view.origin = vec4(3.0f * number.unit(), 0.01f);
    view.forward = vec4(forward, 0);
    view.right = vec4(0.8f * right, 0.5f * number());
    view.up = vec4(-0.6f * up, 0.5f * number());
    view.width = 160;
    view.height = 120;
    view.projection = projection;
    return view;
}

TEST(CameraRays, GoThroughTheMiddleTheCornersAndShiftedPixels) {
    CameraView view{};
    view.origin = {1, 2, 3, 0.01f};
    view.forward = {0, 1, 0, 0};
    view.right = {0.5f, 0, 0, 0};
    view.up = {0, 0, 0.25f, 0};
    view.width = 40;
    view.height = 20;
    EXPECT_EQ(view_ray(view, {20, 10}), vec3(0, 1, 0));
    EXPECT_EQ(view_ray(view, {0, 0}), vec3(-0.5f, 1, 0.25f));
    EXPECT_EQ(view_point(view, {40, 20}, 4), vec3(3, 6, 2));
    EXPECT_EQ(pixel_height(view, 4), 0.1f);
    view.right.w = 20;
    EXPECT_EQ(view_ray(view, {0, 10}), vec3(0, 1, 0));
    view.right.w = 0;
    view.projection = kOrthographic;
    EXPECT_EQ(view_ray(view, {0, 0}), vec3(0, 1, 0));
    EXPECT_EQ(view_start(view, {0, 0}), vec3(0.5f, 2, 3.25f));
    EXPECT_EQ(view_point(view, {40, 20}, 4), vec3(1.5f, 6, 2.75f));
    EXPECT_EQ(toward_viewer(view, {9, 9, 9}), vec3(0, -1, 0));
}

TEST(CameraRays, PlacesAreTheInverseOfPoints) {
    Numbers number;
    for (const uint32_t projection : {kPerspective, kOrthographic})
        for (int i = 0; i < 1000; ++i) {
            const CameraView view = some_view(number, projection);
            const vec2 at(80 + 80 * number(), 60 + 60 * number());
            const float depth = 3 + 2 * number();
            float found = 0;
            const vec2 place = view_place(view, view_point(view, at, depth), found);
            EXPECT_NEAR(place.x, at.x, 1e-3f);
            EXPECT_NEAR(place.y, at.y, 1e-3f);
            EXPECT_NEAR(found, depth, 1e-5f);
            const vec3 offset = view_point(view, at, depth) - xyz_of(view.origin);
            EXPECT_LT(length(view_offset(view, at, depth) - offset), 2e-6f);
        }
}

TEST(CameraRays, OfVectorsAreTheSame) {
    const auto lane = [](vectors::F v) { return vectors::hn::GetLane(v); };
    Numbers number;
    for (const uint32_t projection : {kPerspective, kOrthographic})
        for (int i = 0; i < 1000; ++i) {
            const CameraView view = some_view(number, projection);
            const int x = static_cast<int>(80 + 79 * number()), y = static_cast<int>(60 + 59 * number());
            const vec2 at = vec2(x, y) + 0.5f;
            const float depth = 3 + 2 * number();
            const auto column = vectors::view_columns(view, x), row = vectors::view_row(view, y);
            const vectors::V3 offset = vectors::view_offset(view, column, row, vectors::set(depth));
            const vec3 expected = view_offset(view, at, depth);
            EXPECT_LT(length(vec3(lane(offset.x), lane(offset.y), lane(offset.z)) - expected), 2e-6f);
            const vectors::V3 ray = vectors::view_ray(view, column, row);
            EXPECT_LT(length(vec3(lane(ray.x), lane(ray.y), lane(ray.z)) - view_ray(view, at)), 1e-6f);
            const vectors::Places places = vectors::view_places(view, offset);
            EXPECT_NEAR(lane(places.x), at.x, 1e-3f);
            EXPECT_NEAR(lane(places.y), at.y, 1e-3f);
            EXPECT_NEAR(lane(places.depth), depth, 1e-5f);
            EXPECT_NEAR(lane(vectors::pixel_heights(view, vectors::set(depth))), pixel_height(view, depth),
                        1e-7f);
        }
}

DiscView picture_of(float orthographic) {
    DiscView view{};
    view.right = {1, 0, 0, 0.8f};
    view.down = {0, 1, 0, 0.6f};
    view.forward = {0, 0, 1, 0.01f};
    view.origin = {0, 0, 0, orthographic};
    view.shift = {0.3f, -0.2f};
    view.width = 160;
    view.height = 120;
    return view;
}

ViewDisc some_disc(Numbers& number) {
    ViewDisc disc;
    disc.centre = {number(), number(), 2 + 1.5f * number()};
    disc.normal = number.unit();
    disc.radius = 0.3f + 0.25f * number();
    disc.extent = disc_reach(disc.radius, disc.normal.z);
    disc.push = kRimPush * disc.radius;
    disc.edge = cross(disc.normal, number.unit()) / disc.radius;
    return disc;
}

/// The ray of a pixel in the space of the view.
struct PixelRay {
    vec3 start, ray;
};
PixelRay ray_of(const DiscView& view, int x, int y) {
    const vec2 at = (vec2(x, y) + 0.5f + view.shift) / vec2(view.width, view.height);
    const vec2 tangent = (2.0f * at - 1.0f) * vec2(view.right.w, view.down.w);
    if (view.origin.w > 0) return {vec3(tangent, 0), vec3(0, 0, 1)};
    return {vec3(0), vec3(tangent, 1)};
}

TEST(Disc, IsMetInItsPlaneAndWithinItsRim) {
    Numbers number;
    for (int i = 0; i < 1000; ++i) {
        ViewDisc disc = some_disc(number);
        disc.edge = vec3(0.0f);
        vec3 along, other;
        frame_about(disc.normal, along, other);
        const vec3 inside = disc.centre + 0.99f * disc.radius * along;
        const vec3 outside = disc.centre + 1.01f * disc.radius * along;
        if (std::abs(dot(disc.normal, normalize(disc.centre))) < 0.1f) continue;  // edge-on
        const DiscHit hit = meet_disc(disc.centre, disc.normal, inside / inside.z);
        EXPECT_NEAR(hit.t, inside.z, 1e-4f * inside.z);
        EXPECT_TRUE(on_disc(hit, disc.radius));
        EXPECT_FALSE(on_disc(meet_disc(disc.centre, disc.normal, outside), disc.radius));
        EXPECT_EQ(disc_key(disc, vec3(0), outside / outside.z, 0.01f, false), kNoKey);
        EXPECT_NE(disc_key(disc, vec3(0), outside / outside.z, 0.01f, true), kNoKey)
            << "the pixel of its centre";
        EXPECT_EQ(disc_key(disc, vec3(0), inside / inside.z, inside.z + disc.radius, false), kNoKey)
            << "before the near plane";
    }
}

TEST(Disc, BoxHasEveryPixelWhoseRayMeetsIt) {
    Numbers number;
    size_t covered = 0;
    for (const float orthographic : {0.0f, 1.0f}) {
        const DiscView view = picture_of(orthographic);
        for (int i = 0; i < 60; ++i) {
            const ViewDisc disc = some_disc(number);
            const auto box = native::large_box(disc, view);
            for (int y = 0; y < 120; ++y)
                for (int x = 0; x < 160; ++x) {
                    const PixelRay ray = ray_of(view, x, y);
                    if (disc_key(disc, ray.start, ray.ray, 0.01f, false) == kNoKey) continue;
                    ++covered;
                    ASSERT_TRUE(box);
                    EXPECT_TRUE(x >= box->rect.x0 && x < box->rect.x1 && y >= box->rect.y0 &&
                                y < box->rect.y1)
                        << x << " " << y;
                }
        }
    }
    EXPECT_GT(covered, 10'000u);
    ViewDisc nowhere = some_disc(number);
    nowhere.centre.x = nowhere.centre.y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(native::large_box(nowhere, picture_of(0)));
}

TEST(Disc, OfVectorsIsTheSame) {
    Numbers number;
    for (const float orthographic : {0.0f, 1.0f}) {
        const DiscView view = picture_of(orthographic);
        for (int i = 0; i < 1000; ++i) {
            const ViewDisc disc = some_disc(number);
            const int x = static_cast<int>(80 + 79 * number()), y = static_cast<int>(60 + 59 * number());
            const PixelRay ray = ray_of(view, x, y);
            const DiscHit hit = meet_disc(disc.centre - ray.start, disc.normal, ray.ray);
            const vectors::Meeting met = vectors::meet(disc, view, vectors::row_tangent(view, y), x);
            const auto lane = [](vectors::Row v) { return vectors::hn::GetLane(v); };
            // Without fused operations the bits are the same.
            EXPECT_EQ(lane(met.z), hit.t);
            EXPECT_EQ(lane(met.distance2), hit.distance2);
            EXPECT_EQ(lane(met.beyond), dot(disc.edge, hit.offset));
            EXPECT_EQ(lane(vectors::in_disc(disc, met.z)), disc_depth_within(disc, hit.t));
        }
    }
}

TEST(Disc, LinesOfVectorsAreTheSame) {
    Numbers number;
    const DiscView view = picture_of(0);
    for (int i = 0; i < 10'000; ++i) {
        const auto any = [&] { return static_cast<uint32_t>((number() + 1) * 0x7fffff80); };
        const uint32_t b = any(), c = encode_octahedral(number.unit()) ^ (any() & 0x000f000fu),
                       d = any() | (i % 3 ? kSurfelHasEdge : 0u);
        const vec3 expected = d & kSurfelHasEdge ? edge_of_code(surfel_edge_code(c, d), decode_octahedral(c),
                                                                std::sqrt(surfel_own_area(b, 4.0f)))
                                                 : vec3(0.0f);
        const auto found = vectors::disc_edges(view, vectors::word(b), vectors::word(c), vectors::word(d),
                                               vectors::set(4.0f));
        const auto lane = [](vectors::F v) { return vectors::hn::GetLane(v); };
        const vec3 edge(lane(found.x), lane(found.y), lane(found.z));
        EXPECT_LE(length(edge - expected), 2e-6f * length(expected)) << i;
    }
}

}  // namespace
}  // namespace lucarne::gi
