// The engine without light, and clips, which every engine uses.
#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/registry.h"
#include "gi/scene/clip.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
constexpr uint32_t kWidth = 96, kHeight = 64;

class UnlitTest : public OnDevice {
 protected:
    Lit draw(const std::vector<Surfel>& surfels, const CameraView& camera, Shading shading,
             const LitOptions& with = {}) {
        const auto engine = make_engine("unlit");
        EXPECT_TRUE(engine);
        LitOptions options = with;
        options.unlit.shading = shading;
        return light_up(*device, **engine, SurfelCloud(surfels), camera, options);
    }
};

/// A wall across the view at y = `at`, from x = `from` on.
void add_wall(std::vector<Surfel>& surfels, float at, float from, const glm::vec3& albedo) {
    scenes::add_rectangle(surfels, {from, at, -3}, (4.0f - from) * kX, 6.0f * kZ, 120, albedo);
}
CameraView ahead() {
    return look({0, -4, 0}, {0, 1, 0}, kWidth, kHeight);
}

TEST_F(UnlitTest, FlatColoursAreThePointsOwnWhateverTheLights) {
    std::vector<Surfel> surfels;
    add_wall(surfels, 0, -4, {0.2f, 0.5f, 0.8f});
    LitOptions options;
    options.lights = {scenes::spot({0, -4, 0}, {0, 0, 0}, 0.2f, 0.2f, 1000)};
    options.materials = {scenes::material(1, 0, 1, 7)};
    const Lit flat = draw(surfels, ahead(), Shading::flat, options);
    for (const glm::vec4& pixel : flat.radiance)
        EXPECT_LT(glm::distance(glm::vec3(pixel), glm::vec3(0.2f, 0.5f, 0.8f)), 0.003f);
}

TEST_F(UnlitTest, DarkColoursAreShownSoManyTimesAsBrightAndNoneOverWhite) {
    std::vector<Surfel> surfels;
    add_wall(surfels, 0, -4, {0.1f, 0.2f, 0.8f});
    LitOptions options;
    options.unlit.brightness = 2;
    const Lit bright = draw(surfels, ahead(), Shading::flat, options);
    for (const glm::vec4& pixel : bright.radiance)
        EXPECT_LT(glm::distance(glm::vec3(pixel), glm::vec3(0.2f, 0.4f, 1.0f)), 0.006f);
}

TEST_F(UnlitTest, WhereNoPointIsTheBackgroundShows) {
    LitOptions options;
    options.background = {0.1f, 0.2f, 0.3f};
    for (const Shading shading : {Shading::flat, Shading::eye_dome, Shading::occlusion, Shading::relief}) {
        const Lit empty = draw({{{0, 5, 0}, {0, -1, 0}, kX, .001f, 1e-6f, 0}}, ahead(), shading, options);
        EXPECT_LT(glm::distance(empty.at(3, 3), glm::vec3(0.1f, 0.2f, 0.3f)), 1e-6f);
    }
}

TEST_F(UnlitTest, EyeDomeLeavesAWallAsItIsAndDrawsADarkEdgeBehindAStep) {
    std::vector<Surfel> surfels;
    add_wall(surfels, 0, -4, glm::vec3(0.5f));
    const Lit plane = draw(surfels, ahead(), Shading::eye_dome);
    for (const glm::vec4& pixel : plane.radiance) EXPECT_NEAR(pixel.x, 0.5f, 0.01f);

    add_wall(surfels, -1, 0, glm::vec3(0.5f));  // the right half comes nearer
    const Lit step = draw(surfels, ahead(), Shading::eye_dome);
    for (uint32_t y = 2; y < kHeight - 2; ++y) {
        uint32_t edge = 0;
        while (edge < kWidth && step.texels[y * kWidth + edge].depth > 3.5f) ++edge;
        ASSERT_GT(edge, 8u);
        ASSERT_LT(edge, kWidth - 8);
        EXPECT_LT(step.at(edge - 1, y).x, 0.2f) << "behind the edge, row " << y;
        EXPECT_NEAR(step.at(edge + 2, y).x, 0.5f, 0.01f) << "before it";
        EXPECT_NEAR(step.at(edge - 6, y).x, 0.5f, 0.01f) << "away from it";
    }
}

/// A floor and a wall that meet at y = 2, z = -1.
std::vector<Surfel> crease(bool normals) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-4, -4, -1}, 8.0f * kX, 8.0f * kY, 200, glm::vec3(0.5f));
    scenes::add_rectangle(surfels, {-4, 2, -1}, 8.0f * kX, 4.0f * kZ, 200, glm::vec3(0.5f));
    if (!normals)
        for (Surfel& s : surfels) s.normal = glm::vec3(0.0f);
    return surfels;
}

TEST_F(UnlitTest, OcclusionDarkensACornerAndLeavesAnOpenFloorBright) {
    for (const bool normals : {true, false}) {
        const std::vector<Surfel> surfels = crease(normals);
        const CameraView camera = look({0, -3, 1}, {0, 1.6f, -0.6f}, kWidth, kHeight);
        LitOptions options;
        options.unlit.occlusion_reach = 12;
        const Lit lit = draw(surfels, camera, Shading::occlusion, options);
        float corner = 1, floor = 0;
        for (uint32_t y = 4; y < kHeight - 4; ++y) {
            const glm::vec3 p = lit.position(kWidth / 2, y);
            if (std::abs(p.y - 2) < 0.1f && std::abs(p.z + 1) < 0.1f)
                corner = std::min(corner, lit.at(kWidth / 2, y).x);
            if (p.z < -0.95f && p.y < 1) floor = std::max(floor, lit.at(kWidth / 2, y).x);
        }
        EXPECT_LT(corner, 0.38f) << "with normals: " << normals;
        EXPECT_GT(floor, 0.46f) << "with normals: " << normals;
    }
}

TEST_F(UnlitTest, ReliefTellsSidesOfOneColourApart) {
    std::vector<Surfel> surfels = crease(true);
    scenes::add_rectangle(surfels, {-2.5, 2, -1}, -2.0f * kY, 4.0f * kZ, 150,
                          glm::vec3(0.5f));  // to the left
    scenes::add_rectangle(surfels, {2.5, 2, -1}, -2.0f * kY, 4.0f * kZ, 150,
                          glm::vec3(0.5f));  // to the right
    const CameraView camera = look({0, -4, 1.5f}, {0, 2, 0.5f}, kWidth, kHeight);
    const auto brightest = [&](Shading shading, auto&& here) {
        const Lit lit = draw(surfels, camera, shading);
        float most = 0;
        for (uint32_t y = 4; y < kHeight - 4; ++y)
            for (uint32_t x = 4; x < kWidth - 4; ++x)
                if (lit.texels[y * kWidth + x].depth > 0 && here(lit.position(x, y)))
                    most = std::max(most, lit.at(x, y).x);
        return most;
    };
    const auto left = [](const glm::vec3& p) { return p.x < -2.45f && p.y < 1.7f && p.z > -.7f; };
    const auto right = [](const glm::vec3& p) { return p.x > 2.45f && p.y < 1.7f && p.z > -.7f; };
    const auto floor = [](const glm::vec3& p) { return p.z < -.95f && p.y < 1 && std::abs(p.x) < 1; };
    EXPECT_NEAR(brightest(Shading::occlusion, left), brightest(Shading::occlusion, right), .02f);
    EXPECT_LT(brightest(Shading::relief, left), .8f * brightest(Shading::relief, right))
        << "the light comes from the left";
    EXPECT_GT(brightest(Shading::relief, floor), 1.1f * brightest(Shading::relief, left));
}

/// A camera that looks at the crease from a distance, orthographic or perspective; its view is 2 m high
/// there.
CameraView onto_crease(float distance, bool orthographic) {
    const glm::vec3 along = glm::normalize(glm::vec3(0, 1, -0.7f)), middle(0, 2, -1);
    CameraView view = look(middle - distance * along, middle, kWidth, kHeight);
    view.projection = orthographic ? kOrthographic : kPerspective;
    const float half = orthographic ? 1 : 1 / distance;
    view.up = glm::vec4(half * glm::normalize(glm::vec3(view.up)), 0);
    view.right = glm::vec4(half * kWidth / kHeight * glm::normalize(glm::vec3(view.right)), 0);
    return view;
}

TEST_F(UnlitTest, AnOrthographicViewIsShadedTheSameHoweverFarBackItStands) {
    for (const bool normals : {true, false})
        for (const Shading shading : {Shading::occlusion, Shading::eye_dome}) {
            SCOPED_TRACE(fmt::format("shading {}, normals {}", static_cast<int>(shading), normals));
            std::vector<Surfel> surfels = crease(normals);
            // A plate that floats above the floor has an edge.
            scenes::add_rectangle(surfels, {-1, 0.8f, -0.7f}, 2.0f * kX, 0.4f * kY, 60, glm::vec3(0.5f));
            LitOptions options;
            options.unlit.occlusion_reach = 12;
            const Lit near = draw(surfels, onto_crease(6, true), shading, options),
                      far = draw(surfels, onto_crease(100, true), shading, options);
            size_t differing = 0, shaded = 0;
            for (size_t i = 0; i < near.radiance.size(); ++i) {
                differing += std::abs(near.radiance[i].x - far.radiance[i].x) > 0.02f;
                shaded += far.radiance[i].x < 0.45f;
            }
            EXPECT_LT(differing, near.radiance.size() / 50)
                << "but for pixels that fall on either side of an edge";
            EXPECT_GT(shaded, near.radiance.size() / 100) << "there is something to be seen of it";
        }
}

TEST_F(UnlitTest, AnOrthographicCornerIsAsDarkAsFromAnEyeThatSeesItAsLarge) {
    const std::vector<Surfel> surfels = crease(true);
    LitOptions options;
    options.unlit.occlusion_reach = 12;
    const Lit parallel = draw(surfels, onto_crease(50, true), Shading::occlusion, options),
              eye = draw(surfels, onto_crease(2, false), Shading::occlusion, options);
    // Compares pixels across the crease, which lies in the middle of both pictures.
    for (uint32_t y = kHeight / 2 - 12; y < kHeight / 2 + 12; ++y) {
        float mean[2] = {};
        for (uint32_t x = kWidth / 2 - 16; x < kWidth / 2 + 16; ++x) {
            mean[0] += parallel.at(x, y).x / 32;
            mean[1] += eye.at(x, y).x / 32;
        }
        EXPECT_NEAR(mean[0], mean[1], 0.03f) << "row " << y;
    }
    EXPECT_LT(parallel.at(kWidth / 2, kHeight / 2).x, 0.42f);
}

TEST_F(UnlitTest, PointsOfAFixedSizeCoverThatManyPixels) {
    std::vector<Surfel> one = {{{0, 0, 0}, {0, -1, 0}, glm::vec3(1.0f), .01f, 1e-4f, 0}};
    LitOptions options;
    options.size.pixels = 9;
    const Lit drawn = draw(one, ahead(), Shading::flat, options);
    const auto lit = std::ranges::count_if(drawn.texels, [](const auto& t) { return t.depth > 0; });
    EXPECT_NEAR(static_cast<double>(lit), 3.1416 * 4.5 * 4.5, 8);
    for (const GBufferTexel& texel : drawn.texels)
        if (texel.depth > 0) {
            EXPECT_GT(decode_octahedral(texel.normal).y, -1.01f);
        }
}

/// A random clip of up to three boxes and two planes.
Clip random_clip(std::mt19937& random) {
    std::uniform_real_distribution<double> place(-3, 3), length(0.5, 4), turn(-3, 3);
    std::uniform_int_distribution<int> coin(0, 1), few(0, 3);
    Clip clip;
    for (int i = few(random); i > 0; --i) {
        const glm::dvec3 low(place(random), place(random), place(random));
        clip.boxes.push_back({low, low + glm::dvec3(length(random), length(random), length(random)),
                              turn(random), coin(random) == 1});
    }
    for (int i = few(random) / 2; i > 0; --i)
        clip.planes.push_back({{place(random), place(random), place(random)},
                               {turn(random), turn(random), turn(random) + 4},
                               coin(random) == 1});
    return clip;
}

/// The rule of data/README.md, computed in doubles.
bool rule_keeps(const Clip& clip, const glm::dvec3& p) {
    bool asked = false, inside_one = false;
    for (const ClipBox& box : clip.boxes) {
        const glm::dvec3 middle = (box.min + box.max) / 2.0, d = p - middle, half = (box.max - box.min) / 2.0;
        const double c = std::cos(box.rotation), s = std::sin(box.rotation);
        const bool inside = std::abs(c * d.x + s * d.y) <= half.x && std::abs(-s * d.x + c * d.y) <= half.y &&
                            std::abs(d.z) <= half.z;
        if (box.inverted && inside) return false;
        asked |= !box.inverted;
        inside_one |= !box.inverted && inside;
    }
    for (const ClipPlane& plane : clip.planes)
        if ((glm::dot(plane.normal, p - plane.position) < 0) != plane.inverted) return false;
    return !asked || inside_one;
}

/// Returns whether the rule keeps any point within `slack` of a point.
bool keeps_near(const Clip& clip, const glm::dvec3& p, double slack) {
    bool close = rule_keeps(clip, p);
    for (int corner = 0; corner < 8 && !close; ++corner)
        close = rule_keeps(
            clip, p + slack * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
    return close;
}

std::vector<Surfel> cloud_of_points(std::mt19937& random) {
    std::uniform_real_distribution<float> place(-4, 4);
    std::vector<Surfel> surfels;
    for (int i = 0; i < 20000; ++i)
        surfels.push_back(
            {{place(random), place(random), place(random)}, {0, -1, 0}, glm::vec3(0.5f), .05f, .004f, 0});
    return surfels;
}

TEST_F(UnlitTest, NoPixelShowsAClippedPointAndEveryKeptPointStays) {
    std::mt19937 random(5);
    const SurfelCloud cloud(cloud_of_points(random), {{-8, -8, -8}, 16}, 64);
    auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    const auto all = (*loaded)->pool.download((*loaded)->cut);
    size_t shown = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const Clip clip = random_clip(random);
        DeviceCut cut;
        const glm::dvec3 origin(0.25, -0.5, 0.125);
        ASSERT_TRUE((*loaded)->pool.make_cut(*device, cloud, cloud.whole(), origin, cut, clip));
        const auto kept = (*loaded)->pool.download(cut);
        size_t expected = 0;
        for (const Surfel& s : all) expected += rule_keeps(clip, glm::dvec3(s.position));
        EXPECT_NEAR(static_cast<double>(kept.size()), static_cast<double>(expected), 2) << "but for rounding";
        for (const Surfel& s : kept) {
            const glm::dvec3 p = glm::dvec3(s.position) + origin;
            EXPECT_TRUE(keeps_near(clip, p, 1e-5)) << "but for a float's rounding";
        }
        // The device follows the same rule: the depths seen are those of kept points.
        GBuffer seen;
        const CameraView camera = look({-0.25f, -7.5f, -0.125f}, {0, 0, 0}, 160, 120);
        PointSize pixels;
        pixels.pixels = 1;
        ASSERT_TRUE(rasterize(*device, cut, camera, seen, pixels));
        Lit lit{camera, {}, seen.texels.download_all<GBufferTexel>(160 * 120)};
        for (uint32_t i = 0; i < lit.texels.size(); ++i) {
            if (!(lit.texels[i].depth > 0)) continue;
            ++shown;  // a pixel is .11 m wide where the farthest points are
            const glm::vec3 p = lit.position(i % 160, i / 160);
            EXPECT_TRUE(keeps_near(clip, glm::dvec3(p) + origin, 0.04) ||
                        std::ranges::any_of(
                            kept, [&](const Surfel& s) { return glm::distance(s.position, p) < 0.1f; }))
                << trial;
        }
    }
    EXPECT_GT(shown, 20000u) << "something was to be seen";
}

TEST_F(UnlitTest, TheHostsTestOfAPointFollowsTheRule) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-4, 4);
    size_t kept = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        const Clip clip = random_clip(random);
        for (int i = 0; i < 50; ++i) {
            const glm::dvec3 p(place(random), place(random), place(random));
            ASSERT_EQ(keeps(clip, p), rule_keeps(clip, p));
            kept += keeps(clip, p);
        }
    }
    EXPECT_GT(kept, 5000u);
    EXPECT_LT(kept, 45000u);
    const Clip face{{{{0.1, 0.1, 0.1}, {0.7, 0.7, 0.7}}}, {}, false};
    EXPECT_TRUE(keeps(face, {0.1, 0.7, 0.3})) << "faces are kept";
}

TEST_F(UnlitTest, CubesAreNeverSaidToBeWhollyKeptOrGoneWhenTheyAreNot) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> place(-4, 4), share(0, 1);
    for (int trial = 0; trial < 2000; ++trial) {
        const Clip clip = random_clip(random);
        const octree::Cube cube{{place(random), place(random), place(random)}, 0.1 + 2 * share(random)};
        const Kept said = kept(clip, cube);
        for (int i = 0; i < 50; ++i) {
            const bool keeps_it = rule_keeps(
                clip, cube.min + cube.size * glm::dvec3(share(random), share(random), share(random)));
            if (said != Kept::some) {
                EXPECT_EQ(keeps_it, said == Kept::all);
            }
        }
    }
}

TEST_F(UnlitTest, ALampBehindAClippedWallLightsTheRoomInEveryEngine) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-2, -2, -1}, 4.0f * kX, 4.0f * kY, 100, glm::vec3(0.5f));
    std::vector<Surfel> open = surfels;
    scenes::add_rectangle(surfels, {-2, -2, 1}, 4.0f * kX, 4.0f * kY, 100,
                          glm::vec3(0.5f));  // a lid under the lamp
    Clip clip;
    clip.planes = {{{0, 0, 0.5}, {0, 0, -1}, false}};
    LitOptions options;
    options.lights = {scenes::spot({0, 0, 2}, {0, 0, -1}, 0.5f, 0.5f, 30)};
    options.settings.set(kBounces, 0);
    const CameraView camera = look({0, -3, 0.4f}, {0, 0, -1}, kWidth, kHeight);
    const auto mean = [&](const Lit& lit) {
        double sum = 0;
        for (const glm::vec4& pixel : lit.radiance) sum += pixel.x;
        return sum / static_cast<double>(lit.radiance.size());
    };
    for (const char* name : {"direct", "vpl", "reference"}) {
        const auto draw_with = [&](const std::vector<Surfel>& scene, const Clip& by) {
            const auto engine = make_engine(name);
            LitOptions clipped = options;
            clipped.clip = by;
            return mean(light_up(*device, **engine, SurfelCloud(scene), camera, clipped));
        };
        const double dark = draw_with(surfels, {}), lit = draw_with(surfels, clip),
                     truth = draw_with(open, {});
        EXPECT_GT(truth, 0.1) << name;
        EXPECT_LT(dark, 0.01 * truth) << name;
        EXPECT_NEAR(lit / truth, 1, 0.02) << name;
    }
}

}  // namespace
}  // namespace lucarne::gi
