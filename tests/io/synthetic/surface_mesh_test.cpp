#include "io/synthetic/surface_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <embree3/rtcore.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"
#include "tests/io/synthetic/random_direction.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

double linear(uint8_t code) {
    const double value = code / 255.0;
    return value <= .04045 ? value / 12.92 : std::pow((value + .055) / 1.055, 2.4);
}

/// A mesh as any other program would trace it.
class TracedMesh {
 public:
    explicit TracedMesh(const SurfaceMesh& mesh) : device_(rtcNewDevice("threads=1")) {
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
        for (const auto& vertex : mesh.vertices)
            for (int axis = 0; axis < 3; ++axis) *vertices++ = vertex.position[axis];
        auto* corners = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
        for (const auto& triangle : mesh.triangles)
            for (const uint32_t corner : triangle) *corners++ = corner;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~TracedMesh() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    TracedMesh(const TracedMesh&) = delete;

    struct Hit {
        double distance;
        size_t triangle;
        double u, v;  ///< weights of the second and third corner
    };
    std::optional<Hit> cast(const glm::vec3& from, const glm::vec3& direction) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray{};
        ray.ray.org_x = from.x, ray.ray.org_y = from.y, ray.ray.org_z = from.z;
        ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
        ray.ray.tfar = INFINITY;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
        return Hit{ray.ray.tfar, ray.hit.primID, ray.hit.u, ray.hit.v};
    }

 private:
    RTCDevice device_;
    RTCScene scene_;
};

double area_of(const SurfaceMesh& mesh, const std::array<uint32_t, 3>& triangle) {
    const dvec3 a(mesh.vertices[triangle[0]].position), b(mesh.vertices[triangle[1]].position),
        c(mesh.vertices[triangle[2]].position);
    return glm::length(cross(b - a, c - a)) / 2;
}

TEST(SurfaceMesh, RaysHitTheMeshWhereTheyHitTheScene) {
    constexpr int kRays = 20'000;
    for (const auto& scene : synthetic_scenes()) {
        const auto geometry = SceneGeometry::create(scene.name).value();
        const SurfaceMesh mesh = surface_mesh(geometry->mesh(), .25);
        const TracedMesh traced(mesh);
        Random random(21);
        int other_place = 0, other_normal = 0, rays = 0;
        for (const dvec3& station : geometry->model().stations)
            for (int i = 0; i < kRays; ++i, ++rays) {
                const dvec3 direction = random_direction(random);
                const auto expected = geometry->cast(station, direction);
                const auto hit = traced.cast(station, direction);
                if (expected.has_value() != hit.has_value() ||
                    (hit && std::abs(hit->distance - expected->distance) > 1e-4)) {
                    ++other_place;
                    continue;
                }
                if (!hit) continue;
                const auto& corners = mesh.triangles[hit->triangle];
                const auto normal = [&](size_t corner) { return mesh.vertices[corners[corner]].normal; };
                const dvec3 smooth = glm::normalize(normal(0) * static_cast<float>(1 - hit->u - hit->v) +
                                                    normal(1) * static_cast<float>(hit->u) +
                                                    normal(2) * static_cast<float>(hit->v));
                other_normal += dot(smooth, expected->normal) < std::cos(3 * M_PI / 180) ? 1 : 0;
            }
        // Rays that graze a silhouette may be rounded to either side of it. The scene's quads are bilinear,
        // the mesh's triangles linear, so normals differ a little within strongly bent quads.
        EXPECT_LE(other_place, rays / 20'000) << scene.name;
        EXPECT_LE(other_normal, rays / 200) << scene.name;
        EXPECT_GE(rays, kRays) << scene.name;
    }
}

TEST(SurfaceMesh, AreasAreThoseOfTheScene) {
    for (const auto& scene : synthetic_scenes()) {
        const auto geometry = SceneGeometry::create(scene.name).value();
        for (const double step : {.2, 100.0}) {
            const SurfaceMesh mesh = surface_mesh(geometry->mesh(), step);
            double area = 0;
            for (const auto& triangle : mesh.triangles) area += area_of(mesh, triangle);
            EXPECT_NEAR(area, geometry->area(), 2e-5 * geometry->area()) << scene.name << " " << step;
        }
    }
}

TEST(SurfaceMesh, CornersTurnLeftSeenFromTheAir) {
    for (const auto& scene : synthetic_scenes()) {
        const auto geometry = SceneGeometry::create(scene.name).value();
        const SurfaceMesh mesh = surface_mesh(geometry->mesh(), .2);
        double wrong = 0;
        for (const auto& triangle : mesh.triangles) {
            const auto& [a, b, c] = triangle;
            const auto& v = mesh.vertices;
            const glm::vec3 front = cross(v[b].position - v[a].position, v[c].position - v[a].position);
            if (dot(front, v[a].normal + v[b].normal + v[c].normal) <= 0) wrong += area_of(mesh, triangle);
        }
        EXPECT_LT(wrong, 1e-5 * geometry->area()) << scene.name;
    }
}

TEST(SurfaceMesh, ColoursKeepTheMeanAlbedoOfTheScan) {
    // The nave's joints (4 mm) and its dark tiles (60 cm) are finer and coarser than the cells.
    for (const char* scene : {"cornell", "nave", "two-rooms"}) {
        const auto geometry = SceneGeometry::create(scene).value();
        const SurfaceMesh mesh = surface_mesh(geometry->mesh(), .1);
        dvec3 of_mesh(0), of_scan(0);
        for (const auto& triangle : mesh.triangles)
            for (const uint32_t corner : triangle) {
                const auto& codes = mesh.vertices[corner].albedo;
                of_mesh += dvec3(linear(codes[0]), linear(codes[1]), linear(codes[2])) *
                           (area_of(mesh, triangle) / 3 / geometry->area());
            }
        SyntheticOptions options;
        options.scene = scene;
        options.even = true;
        options.points = 300'000;
        const auto source = synthetic_source(options).value();
        const size_t color = source->schema().find(names::color)->offset;
        const auto reader = source->open().value();
        PointBatch batch;
        while (const size_t count = reader->read(batch, 1 << 16).value())
            for (size_t i = 0; i < count; ++i) {
                const std::byte* at = batch.bytes.data() + i * source->schema().stride + color;
                of_scan += dvec3(linear(load<uint8_t>(at)), linear(load<uint8_t>(at + 1)),
                                 linear(load<uint8_t>(at + 2))) /
                           static_cast<double>(options.points);
            }
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(of_mesh[channel] / of_scan[channel], 1, .005) << scene << " " << channel;
    }
}

TEST(SurfaceMesh, OnlySurfacesWithAPatternAreDivided) {
    const auto cornell = SceneGeometry::create("cornell").value(),
               nave = SceneGeometry::create("nave").value();
    EXPECT_EQ(surface_mesh(cornell->mesh(), .05).triangles.size(),
              surface_mesh(cornell->mesh(), 100).triangles.size());
    const SurfaceMesh fine = surface_mesh(nave->mesh(), .2);
    EXPECT_GT(fine.triangles.size(), 2 * surface_mesh(nave->mesh(), 100).triangles.size());
    double large = 0;
    for (const auto& triangle : fine.triangles) {
        float longest = 0;
        for (size_t i = 0; i < 3; ++i)
            longest = std::max(longest, glm::length(fine.vertices[triangle[i]].position -
                                                    fine.vertices[triangle[(i + 1) % 3]].position));
        // A diagonal is shorter than two sides.
        if (longest > .4f) large += area_of(fine, triangle);
    }
    EXPECT_GT(large, .1);  // the cross on the altar is gilt
    EXPECT_LT(large, 1);
}

}  // namespace
}  // namespace lucarne::io
