// Shadow maps of VPLs placed by hand in small scenes of surfels.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/raster/native/native.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

/// The maps on the host.
struct Maps {
    AtlasLayout layout;
    std::vector<uint32_t> texels;
    std::vector<uint32_t> sources;  ///< empty if they were not requested
    uint32_t id_bits = 0;

    uint32_t at(uint32_t map, uint32_t x, uint32_t y) const {
        return texels[(size_t{map} * layout.side + y) * layout.side + x];
    }
    /// Returns the unit direction of the central ray of a texel, for a VPL that looks along +z; zero outside
    /// the hemisphere.
    glm::vec3 ray(uint32_t x, uint32_t y) const {
        const auto coordinate = [&](uint32_t i) {
            return (2 * static_cast<float>(i) + 1) / static_cast<float>(layout.side) - 1;
        };
        const float u = coordinate(x), v = coordinate(y), norm2 = u * u + v * v;
        return norm2 >= 1 ? glm::vec3(0.0f) : glm::vec3(2 * u, 2 * v, 1 - norm2) / (1 + norm2);
    }
    /// Calls body(ray, texel) for every texel of a map's hemisphere.
    template <class Body>
    void each(uint32_t map, const Body& body) const {
        for (uint32_t y = 0; y < layout.side; ++y)
            for (uint32_t x = 0; x < layout.side; ++x)
                if (const glm::vec3 w = ray(x, y); w != glm::vec3(0.0f)) body(w, at(map, x, y));
    }
};

/// A VPL at the origin that looks along +z, so that the frame of its map is that of the world.
VplLight upward() {
    VplLight light = kDeadLight;
    light.position = {0, 0, 0, 0.01f};
    light.normal = {0, 0, 1, 0};
    return light;
}

/// Draws maps by shaders or natively.
class VplShadowMaps : public OnDevice, public ::testing::WithParamInterface<bool> {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (GetParam() && !device->native_passes()) GTEST_SKIP() << "no native passes on this device";
        device->use_native_passes(GetParam());
    }
    /// Draws maps in an atlas of `atlas` texels along a side, shared by the lights.
    Maps draw(const std::vector<Surfel>& surfels, const std::vector<VplLight>& lights, uint32_t atlas,
              bool sources = false) {
        Maps maps;
        const auto layout = atlas_layout(atlas, static_cast<uint32_t>(lights.size()));
        EXPECT_TRUE(layout);
        maps.layout = *layout;
        Seeds seeds;
        seeds.host_lights = lights;
        seeds.lights = *device->buffer(lights.size() * sizeof(VplLight), "lights");
        seeds.lights.upload_all(lights);
        const SurfelCloud cloud(surfels);
        auto loaded = load_cloud(*device, cloud);
        EXPECT_TRUE(loaded) << loaded.error().line();
        PassTimes times(*device);
        ShadowMaps drawn;
        EXPECT_TRUE(decode_casters(*device, (*loaded)->cut, drawn));
        const auto done = draw_shadow_maps(*device, (*loaded)->cut, seeds, *layout, sources, times, drawn);
        EXPECT_TRUE(done) << done.error().line();
        maps.texels = drawn.atlas.download_all<uint32_t>(layout->texels());
        if (sources) maps.sources = drawn.sources.download_all<uint32_t>(layout->texels());
        maps.id_bits = drawn.id_bits;
        return maps;
    }
};

/// A square of side 2 `half` at height z over the origin, facing down.
std::vector<Surfel> ceiling(float z, float half, int n) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, glm::vec3(-half, -half, z), 2 * half * kY, 2 * half * kX, n,
                          glm::vec3(0.5f));
    return surfels;
}

TEST_P(VplShadowMaps, texelsHoldTheDistanceToTheSurfacesPlane) {
    // A slanted wall: depths differ by half over one splat, which a single depth per splat would get wrong
    // by as much.
    std::vector<Surfel> wall;
    scenes::add_rectangle(wall, glm::vec3(-4, -4, 0), glm::vec3(8, 0, 4), glm::vec3(0, 8, 0), 400,
                          glm::vec3(0.5f));
    const glm::vec3 normal = glm::normalize(glm::vec3(-.5f, 0, 1));
    size_t hits = 0;
    const Maps maps = draw(wall, {upward()}, 128);
    maps.each(0, [&](const glm::vec3& ray, uint32_t texel) {
        if (texel == kNothing) return;
        const float truth = glm::dot(normal, glm::vec3(0, 0, 2)) / glm::dot(normal, ray);
        const glm::vec3 hit = truth * ray;
        if (std::max(std::abs(hit.x), std::abs(hit.y)) > 3.7f) return;  // skip the rims
        ++hits;
        EXPECT_NEAR(map_distance(texel) / truth, 1, .01) << ray.x << " " << ray.y;
    });
    EXPECT_GT(hits, 5000u);
}

TEST_P(VplShadowMaps, redWallBehindAWhiteOneNeverShowsThrough) {
    // The surfels are far finer than the map, so that all but a few in a hundred are left out of it.
    std::vector<Surfel> walls = ceiling(1, 3, 500);
    const auto behind = ceiling(2, 6, 500);
    walls.insert(walls.end(), behind.begin(), behind.end());
    const Maps maps = draw(walls, std::vector<VplLight>(16, upward()), 256);
    size_t rays = 0, through = 0;
    for (uint32_t map = 0; map < 16; ++map)
        maps.each(map, [&](const glm::vec3& ray, uint32_t texel) {
            if (ray.z < .4f) return;  // the white wall ends 18 degrees above the horizon
            ++rays;
            if (texel == kNothing || map_distance(texel) * ray.z > 1.5f) ++through;
        });
    EXPECT_GT(rays, 15'000u);
    EXPECT_LE(static_cast<double>(through), .001 * static_cast<double>(rays));
}

TEST_P(VplShadowMaps, openDoorStaysOpenAndAClosedOneClosed) {
    // A wall at height 2 with a door of 1 x 1 in its middle, ten texels wide in the map, and a far wall at 6.
    std::vector<Surfel> open = ceiling(6, 12, 500);
    for (const auto& [corner, u, v] : {std::tuple{glm::vec3(-4, -4, 2), 3.5f * kX, 8.0f * kY},
                                       std::tuple{glm::vec3(.5f, -4, 2), 3.5f * kX, 8.0f * kY},
                                       std::tuple{glm::vec3(-.5f, -4, 2), 1.0f * kX, 3.5f * kY},
                                       std::tuple{glm::vec3(-.5f, .5f, 2), 1.0f * kX, 3.5f * kY}}) {
        // Square cells of 2 cm in every piece.
        std::vector<Surfel> piece;
        const int nu = static_cast<int>(std::lround(glm::length(u) / .02f));
        const int nv = static_cast<int>(std::lround(glm::length(v) / .02f));
        for (int j = 0; j < nv; ++j)
            for (int i = 0; i < nu; ++i)
                piece.push_back({corner + u * ((static_cast<float>(i) + .5f) / static_cast<float>(nu)) +
                                     v * ((static_cast<float>(j) + .5f) / static_cast<float>(nv)),
                                 -kZ, glm::vec3(.5f), .015f, 4e-4f, 0});
        open.insert(open.end(), piece.begin(), piece.end());
    }
    std::vector<Surfel> closed = open;
    scenes::add_rectangle(closed, glm::vec3(-.5f, -.5f, 2), kY, kX, 50, glm::vec3(.5f));

    const auto share_through = [&](const std::vector<Surfel>& scene, float half) {
        const Maps maps = draw(scene, std::vector<VplLight>(16, upward()), 256);
        size_t rays = 0, through = 0;
        for (uint32_t map = 0; map < 16; ++map)
            maps.each(map, [&](const glm::vec3& ray, uint32_t texel) {
                const glm::vec3 at = ray * (2 / std::max(ray.z, .1f));
                if (std::max(std::abs(at.x), std::abs(at.y)) > half) return;
                ++rays;
                if (map_distance(texel) * ray.z > 4) ++through;
            });
        EXPECT_GT(rays, 200u);
        return static_cast<double>(through) / static_cast<double>(rays);
    };
    EXPECT_GT(share_through(open, .25f),
              .99);  // the splats of the frame reach a texel and a half into the door
    EXPECT_GT(share_through(open, .5f), .5);
    EXPECT_LT(share_through(closed, .5f), .002);
}

TEST_P(VplShadowMaps, pullPushFillsHolesAndNeverCrossesFromOneMapToAnother) {
    // Every second VPL is dead. Its map must stay empty, whatever its neighbours in the buffer hold.
    std::vector<VplLight> lights;
    for (int i = 0; i < 16; ++i) lights.push_back(i % 2 ? kDeadLight : upward());
    const Maps maps = draw(ceiling(1, 60, 1000), lights, 256);
    for (uint32_t map = 0; map < 16; ++map) {
        size_t rays = 0, filled = 0;
        maps.each(map, [&](const glm::vec3& ray, uint32_t texel) {
            if (map % 2) {
                EXPECT_EQ(texel, kNothing) << map;
                return;
            }
            if (ray.z < .12f) return;  // splats are thinner than a texel here
            ++rays;
            filled += texel != kNothing;
        });
        EXPECT_GE(filled, rays * 998 / 1000) << map;
    }
}

TEST_P(VplShadowMaps, ownSurfaceAndWhatLiesBehindItAreNotDrawn) {
    std::vector<Surfel> floor;
    scenes::add_rectangle(floor, glm::vec3(-2, -2, 0), 4.0f * kX, 4.0f * kY, 200, glm::vec3(.5f));
    scenes::add_rectangle(floor, glm::vec3(-2, -2, -1), 4.0f * kX, 4.0f * kY, 200, glm::vec3(.5f));
    VplLight light = upward();
    light.normal.w = .02f;
    const Maps maps = draw(floor, {light}, 64);
    maps.each(0, [&](const glm::vec3& ray, uint32_t texel) { EXPECT_EQ(texel, kNothing) << ray.z; });
}

TEST_P(VplShadowMaps, atlasesAreSharedOutAndTooManyMapsAreRefused) {
    const auto layout = atlas_layout(2048, 256);
    ASSERT_TRUE(layout);
    EXPECT_EQ(layout->side, 128u);
    const auto odd = atlas_layout(2048, 300);
    ASSERT_TRUE(odd);
    EXPECT_LE(odd->texels(), size_t{2048} * 2048);
    EXPECT_EQ(odd->side % 8, 0u);
    for (const auto& refused : {atlas_layout(2048, 0), atlas_layout(64, 100)}) {
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::arguments);
    }
}

TEST_P(VplShadowMaps, sameMapsEveryRun) {
    const auto room = scenes::closed_box(2, 100, glm::vec3(.5f));
    VplLight light = upward();
    light.position = {1, 1, .1f, .01f};
    const std::vector<VplLight> lights(300, light);  // more than one run of maps
    EXPECT_EQ(draw(room, lights, 256).texels, draw(room, lights, 256).texels);
}

class NativeVplShadowMaps : public VplShadowMaps {};

/// A room with furniture, a wall at a low angle, surfels without normals, and VPLs all over it.
struct Furnished {
    std::vector<Surfel> surfels;
    std::vector<VplLight> lights;
};
Furnished furnished() {
    Furnished room;
    scenes::add_rectangle(room.surfels, glm::vec3(-4, -4, 2), 8.0f * kY, 8.0f * kX, 250, glm::vec3(0.5f));
    scenes::add_rectangle(room.surfels, glm::vec3(-4, -4, 0), glm::vec3(8, 0, 4), glm::vec3(0, 8, 0), 150,
                          glm::vec3(0.5f));
    scenes::add_rectangle(room.surfels, glm::vec3(1, -1, 0), glm::vec3(0, 0, 1), glm::vec3(0, 2, 0), 40,
                          glm::vec3(0.5f));
    for (size_t i = 0; i < room.surfels.size(); i += 9) room.surfels[i].normal = glm::vec3(0.0f);
    for (int i = 0; i < 40; ++i) {
        VplLight light = upward();
        const float angle = 0.7f * static_cast<float>(i), out = 0.08f * static_cast<float>(i);
        light.position = {out * std::cos(angle), out * std::sin(angle), 0.02f * static_cast<float>(i % 7),
                          0.01f};
        const glm::vec3 normal = glm::normalize(glm::vec3(std::sin(angle), 0.3f, std::cos(2 * angle)));
        light.normal = {normal.x, normal.y, normal.z, 0.02f};
        room.lights.push_back(i == 20 ? kDeadLight : light);
    }
    return room;
}

TEST_P(NativeVplShadowMaps, EveryInstructionSetGivesTheSameMaps) {
    const Furnished room = furnished();
    const Maps fastest = draw(room.surfels, room.lights, 512, true);
    for (int set = 0; gi::native::use_instruction_set(set); ++set) {
        const Maps maps = draw(room.surfels, room.lights, 512, true);
        EXPECT_TRUE(maps.texels == fastest.texels && maps.sources == fastest.sources) << set;
    }
    gi::native::use_instruction_set(-1);
}

TEST_P(NativeVplShadowMaps, NativeMapsAreThoseOfTheShaders) {
    const Furnished room = furnished();
    const Maps maps = draw(room.surfels, room.lights, 512, true);
    device->use_native_passes(false);
    const Maps shaders = draw(room.surfels, room.lights, 512, true);
    // Both round differently in the last bits: a texel at the rim of a disc may be taken or not, and a code
    // may be the next one.
    size_t drawn = 0, others = 0, other_sources = 0;
    for (size_t i = 0; i < maps.texels.size(); ++i) {
        const uint32_t a = maps.texels[i], b = shaders.texels[i];
        drawn += b != kNothing;
        const bool same = a == b || (a != kNothing && b != kNothing &&
                                     std::abs(map_distance(a) / map_distance(b) - 1) < 1e-3f);
        others += !same;
        const uint32_t ids = (1u << maps.id_bits) - 1;
        other_sources += (maps.sources[i] & ids) != (shaders.sources[i] & ids);
    }
    EXPECT_GT(drawn, maps.texels.size() / 4);
    EXPECT_LE(others, drawn / 200);
    EXPECT_LE(other_sources, drawn / 50);
}

// A million points at the place of a VPL took hours: each of them covered the whole map.
TEST_P(NativeVplShadowMaps, HundredsOfDiscsOverOneMapAreAllDrawnAndThousandsAreNot) {
    const auto distance = [&](size_t discs) {
        std::vector<Surfel> surfels(discs, ceiling(3, 3, 1).front());
        // The second along the curve through space is drawn in the middle of all (order_evenly()); the first
        // is behind the VPL.
        surfels[0].position.z = -2;
        surfels[1].position.z = 2;
        const Maps maps = draw(surfels, {upward()}, 64);
        return map_distance(maps.at(0, maps.layout.side / 2, maps.layout.side / 2));
    };
    EXPECT_NEAR(distance(300), 2, .02);
    EXPECT_NEAR(distance(4000), 3, .03);
}

INSTANTIATE_TEST_SUITE_P(Passes, NativeVplShadowMaps, ::testing::Values(true));
INSTANTIATE_TEST_SUITE_P(Passes, VplShadowMaps, ::testing::Bool(),
                         [](const auto& native) { return native.param ? "native" : "shaders"; });

}  // namespace
}  // namespace lucarne::gi::vpl
