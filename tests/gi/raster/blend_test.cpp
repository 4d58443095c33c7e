#include "gi/raster/blend.h"

#include <algorithm>
#include <cstring>

#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

const glm::vec3 kDark(0.2f);

class BlendTest : public GBufferTest {
 protected:
    Picture blended(std::vector<Surfel> surfels, const CameraView& view) {
        return draw(std::move(surfels), view, 1u << 20, true);
    }
    Picture single(std::vector<Surfel> surfels, const CameraView& view) {
        return draw(std::move(surfels), view, 1u << 20, false);
    }
};

struct Spread {
    double mean = 0, deviation = 0;
};

/// Returns mean and deviation of the red channel in the middle of a picture.
Spread brightness(const Picture& p) {
    double sum = 0, squares = 0, count = 0;
    for (uint32_t y = p.view.height / 4; y < p.view.height * 3 / 4; ++y)
        for (uint32_t x = p.view.width / 4; x < p.view.width * 3 / 4; ++x) {
            const double value = decode_albedo(p.texels[y * p.view.width + x].albedo).x;
            sum += value;
            squares += value * value;
            count += 1;
        }
    return {sum / count, std::sqrt(std::max(squares / count - sum / count * sum / count, 0.0))};
}

/// Two scans of one wall, one of them twice as bright, point by point in turns.
std::vector<Surfel> two_exposures(float spacing) {
    auto surfels = wall(2, 1.2f, spacing, kWhite, 1);
    std::mt19937 random(9);
    for (Surfel& s : surfels)
        if (random() % 2 == 0) s.albedo = 0.5f * kWhite;
    return surfels;
}

TEST_P(BlendTest, TwoScansOfOneWallGiveOneColourWithoutChangingItsMean) {
    for (const float spacing : {0.004f, 0.02f, 0.1f}) {  // under a pixel; small discs; large ones
        const CameraView view = look({0, 0, 0}, {0, 1, 0}, 160, 160, 0.9f);
        const Spread before = brightness(single(two_exposures(spacing), view));
        const Spread after = brightness(blended(two_exposures(spacing), view));
        EXPECT_NEAR(after.mean, before.mean, 0.04 * before.mean) << spacing;
        EXPECT_GT(before.deviation, 0.15) << spacing;
        EXPECT_LT(after.deviation, 0.6 * before.deviation) << spacing;
    }
}

TEST_P(BlendTest, NoiseOfNormalsAndDepthsIsAveraged) {
    auto surfels = wall(2, 1.2f, 0.03f, kWhite, 1);
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (Surfel& s : surfels) {
        s.position.y += 0.002f * normal(random);
        s.normal = glm::normalize(glm::vec3(0.08f * normal(random), -1, 0.08f * normal(random)));
    }
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 160, 160, 0.9f);
    const auto errors = [&](const Picture& p) {
        double angle = 0, depth = 0;
        for (const GBufferTexel& texel : p.texels) {
            const glm::vec3 n = decode_octahedral(texel.normal);
            angle += n.x * n.x + n.z * n.z;
            depth += (texel.depth - 2) * (texel.depth - 2);
        }
        return glm::dvec2(std::sqrt(angle), std::sqrt(depth));
    };
    const glm::dvec2 before = errors(single(surfels, view)), after = errors(blended(surfels, view));
    EXPECT_LT(after.x, 0.7 * before.x);
    EXPECT_LT(after.y, 0.8 * before.y);
}

TEST_P(BlendTest, ColumnOfCoarsePointsHasNoFacets) {
    std::vector<Surfel> surfels;
    constexpr float kRadius = 0.4f, kSpacing = 0.08f;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> jitter(-0.5f, 0.5f);
    for (float z = -1; z <= 1; z += kSpacing)
        for (float angle = 0; angle < 6.28f; angle += kSpacing / kRadius) {
            const float a = angle + jitter(random) * kSpacing / kRadius;
            const glm::vec3 n(std::cos(a), std::sin(a), 0);
            surfels.push_back({kRadius * n + glm::vec3(0, 3, z + jitter(random) * kSpacing), n, kWhite, 0,
                               kSpacing * kSpacing, 0});
        }
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 240, 240, 0.2f);
    const auto largest_step = [&](const Picture& p) {  // between neighbouring pixels, radians
        double most = 0;
        for (uint32_t y = 0; y < 240; ++y)
            for (uint32_t x = 60; x < 180; ++x) {
                const float cosine = glm::dot(decode_octahedral(p.texels[y * 240 + x].normal),
                                              decode_octahedral(p.texels[y * 240 + x + 1].normal));
                most = std::max(most, std::acos(std::min<double>(cosine, 1)));
            }
        return most;
    };
    EXPECT_GT(largest_step(single(surfels, view)), 0.2);
    EXPECT_LT(largest_step(blended(surfels, view)), 0.07);
}

TEST_P(BlendTest, ColoursAndNormalsDoNotCrossACrease) {
    auto surfels = wall(3, 1.5f, 0.02f, kWhite, 1);
    for (Surfel s : wall(0, 1.5f, 0.02f, kRed, 2)) {  // a floor that meets the wall
        s.position = {s.position.x, 1.5f + s.position.z, -0.5f};
        s.normal = {0, 0, 1};
        surfels.push_back(s);
    }
    const CameraView view = look({0, 0, 0}, {0, 3, -0.5f}, 200, 200, 0.6f);
    const Picture p = blended(surfels, view);
    size_t red = 0, white = 0;
    for (size_t at = 0; at < p.texels.size(); ++at) {
        if (p.empty(at)) continue;
        const glm::vec3 colour = decode_albedo(p.texels[at].albedo),
                        n = decode_octahedral(p.texels[at].normal);
        ASSERT_TRUE(colour.y < 0.01f || colour.y > 0.78f) << "a mixture of both planes";
        (colour.y < 0.01f ? red : white) += 1;
        EXPECT_GT(colour.y < 0.01f ? n.z : -n.y, 0.98f);
    }
    EXPECT_GT(red, 5000u);
    EXPECT_GT(white, 5000u);
}

TEST_P(BlendTest, FarSideOfAThinDoorDoesNotShine) {
    constexpr float kSpacing = 0.02f;
    auto surfels = wall(2, 1, kSpacing, kWhite, 1);
    for (Surfel s : wall(2.006f, 1, kSpacing, kRed, 2)) {  // nearer than the slab is thick
        s.normal = -s.normal;
        surfels.push_back(s);
    }
    const Picture p = blended(surfels, look({0, 0, 0}, {0, 1, 0}, 160, 160, 0.5f));
    size_t mixed = 0;
    for (const GBufferTexel& texel : p.texels) {
        const float green = decode_albedo(texel.albedo).y;
        mixed += green > 0.01f && green < 0.78f;
    }
    EXPECT_EQ(mixed, 0u);
}

TEST_P(BlendTest, MaterialsDoNotMix) {
    auto surfels = wall(2, 1, 0.02f, kWhite, 1);
    for (Surfel& s : surfels)
        if (s.position.x > 0) {
            s.albedo = kRed;
            s.material = 7;
        }
    const Picture p = blended(surfels, look({0, 0, 0}, {0, 1, 0}, 160, 160, 0.5f));
    for (const GBufferTexel& texel : p.texels) {
        const float green = decode_albedo(texel.albedo).y;
        EXPECT_TRUE((texel.material & 0xffffu) == 7 ? green < 0.01f : green > 0.78f);
    }
}

TEST_P(BlendTest, IdsStayThoseOfTheFrontDiscs) {
    const auto surfels = two_exposures(0.02f);
    const CameraView view = look({0, 0, 0}, {0.2f, 1, 0}, 120, 100);
    EXPECT_EQ(blended(surfels, view).ids, single(surfels, view).ids);
}

TEST_P(BlendTest, PointsUnderAPixelFlickerLess) {
    auto surfels = wall(2, 0.6f, 0.003f, kWhite, 1);
    std::mt19937 random(3);
    for (Surfel& s : surfels)
        if (random() % 2 == 0) s.albedo = glm::vec3(0.02f);
    const auto flicker = [&](bool mixed) {
        std::vector<GBufferTexel> last;
        double squares = 0;
        for (int step = 0; step < 6; ++step) {
            const float shift = 0.002f * static_cast<float>(step);  // a quarter of a pixel
            const Picture p =
                draw(surfels, look({shift, 0, 0}, {shift, 1, 0}, 100, 100, 0.4f), 1u << 20, mixed);
            for (size_t i = 0; i < last.size(); ++i) {
                const float change = decode_albedo(p.texels[i].albedo).x - decode_albedo(last[i].albedo).x;
                squares += change * change;
            }
            last = p.texels;
        }
        return std::sqrt(squares);
    };
    EXPECT_LT(flicker(true), 0.5 * flicker(false));
}

TEST_P(BlendTest, RunsGiveTheSamePixels) {
    const auto surfels = two_exposures(0.01f);
    const CameraView view = look({0, 0, 0}, {0.2f, 1, 0}, 200, 160);
    const Picture first = blended(surfels, view);
    for (int run = 0; run < 3; ++run) {
        const Picture again = blended(surfels, view);
        ASSERT_EQ(
            std::memcmp(first.texels.data(), again.texels.data(), first.texels.size() * sizeof(GBufferTexel)),
            0);
    }
}

TEST_P(BlendTest, PictureOfManyRowsIsBlendedInBandsWithoutASeam) {
    std::vector<Surfel> surfels = wall(2, 1.2f, 0.05f, kWhite, 1);
    std::mt19937 random(9);
    for (Surfel& s : surfels) s.albedo = random() % 2 ? kWhite : kDark;
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 1000, 4600, 0.9f);  // 147 MB of sums
    const Picture p = blended(surfels, view);
    const auto grey = [&](size_t row) {  // share of pixels with a colour that no disc has
        size_t count = 0;
        for (size_t at = row * 1000; at < (row + 1) * 1000; ++at) {
            const float value = decode_albedo(p.texels[at].albedo).x;
            count += value > 0.21f && value < 0.79f;
        }
        return count;
    };
    for (size_t row = 0; row < 4600; row += 50) EXPECT_GT(grey(row), 300u) << row;
}

TEST_P(BlendTest, HostilePilesOfDiscsGiveADefinedPicture) {
    // More discs in one place than the sums hold: the front disc remains.
    std::vector<Surfel> pile(300'000, {{0, 3, 0}, {0, -1, 0}, kWhite, 0, 0.01f, 0});
    pile.front().albedo = kRed;
    const Picture piled = blended(pile, look({0, 0, 0}, {0, 1, 0}, 32, 32, 0.3f));
    for (const GBufferTexel& texel : piled.texels) {
        if (!(texel.depth > 0)) continue;
        EXPECT_NEAR(texel.depth, 3, 0.02f);
        EXPECT_LT(decode_octahedral(texel.normal).y, -0.99f);
        EXPECT_NEAR(decode_albedo(texel.albedo).x, 0.8f, 0.02f);
    }
    // Normals that are all wrong, no colour at all, no normals.
    auto noise = wall(2, 1, 0.02f, glm::vec3(0.0f), 1);
    std::mt19937 random(4);
    std::normal_distribution<float> any;
    for (Surfel& s : noise) {
        s.normal = glm::normalize(glm::vec3(any(random), any(random), any(random)));
        if (random() % 3 == 0) s.normal = glm::vec3(0.0f);
    }
    for (const GBufferTexel& texel : blended(noise, look({0, 0, 0}, {0, 1, 0}, 160, 160, 0.5f)).texels) {
        EXPECT_TRUE(texel.depth == 0 || std::abs(texel.depth - 2) < 0.1f) << texel.depth;
        EXPECT_NEAR(glm::length(decode_octahedral(texel.normal)), 1, 1e-5f);
        EXPECT_EQ(decode_albedo(texel.albedo), glm::vec3(0.0f));
    }
    for (const GBufferTexel& texel : blended({}, look({0, 0, 0}, {0, 1, 0}, 16, 16)).texels)
        EXPECT_EQ(texel.depth, 0.0f);
}

INSTANTIATE_TEST_SUITE_P(Passes, BlendTest, ::testing::Bool(), passes_name);

}  // namespace
}  // namespace lucarne::gi
