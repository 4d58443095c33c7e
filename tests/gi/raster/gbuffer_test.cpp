#include "gi/raster/gbuffer.h"

#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

TEST_P(GBufferTest, DiscCoversThePixelsWhoseRaysMeetItAtItsPlanesDepth) {
    // 2 to 150 pixels across: small and large discs, the latter also with rays beside the middles of their
    // pixels
    const std::pair<float, glm::vec2> kinds[] = {
        {2e-4f, {}}, {0.01f, {}}, {0.3f, {}}, {0.3f, {-.4f, .3f}}, {0.3f, {.5f, -.5f}}};
    for (const auto& [area, shift] : kinds) {
        const Surfel tilted{{0.3f, 3, 0.2f}, glm::normalize(glm::vec3(1, -2, 0.7f)), kWhite, 0, area, 3};
        CameraView view = look({0, 0, 0}, {0, 1, 0}, 320, 240);
        view.right.w = shift.x;
        view.up.w = shift.y;
        const Picture p = draw({tilted}, view);
        ASSERT_EQ(p.surfels.size(), 1u);
        const Surfel s = p.surfels[0];
        size_t covered = 0;
        for (uint32_t y = 0; y < 240; ++y)
            for (uint32_t x = 0; x < 320; ++x) {
                const size_t at = y * 320 + x;
                const glm::vec3 ray = p.ray(x, y);
                const float depth = glm::dot(s.normal, s.position - p.eye()) / glm::dot(s.normal, ray);
                const float distance = glm::length(p.eye() + depth * ray - s.position);
                if (distance < s.radius * 0.9999f) {
                    ASSERT_FALSE(p.empty(at)) << x << " " << y;
                }
                if (p.empty(at)) continue;
                ++covered;
                EXPECT_LT(distance, s.radius * 1.0001f);
                EXPECT_NEAR(p.texels[at].depth, depth, 1e-5f);
                EXPECT_GT(glm::dot(decode_octahedral(p.texels[at].normal), s.normal), 0.9999f);
                EXPECT_EQ(p.texels[at].material & 0xffff, 3u);
                EXPECT_NEAR(glm::unpackHalf2x16(p.texels[at].material).y, s.radius, s.radius * 1e-3f);
            }
        EXPECT_GT(covered, 3u);
    }
}

TEST_P(GBufferTest, DiscEndsAtItsLine) {
    // 2 to 150 pixels across: small and large discs. The line lies behind the disc from one eye, before it
    // from the other.
    for (const float area : {2e-3f, 0.01f, 0.3f})
        for (const bool blended : {false, true})
            for (const float eye : {0.0f, 6.0f}) {
                Surfel half{{0.3f, 3, 0.2f}, glm::normalize(glm::vec3(1, -2, 0.7f)), kWhite, 0, area, 3};
                const glm::vec3 toward = glm::normalize(glm::cross(half.normal, glm::vec3(0.3f, 0.2f, 1)));
                half.edge = toward / (0.5f * std::sqrt(area));
                const CameraView view = look({0, eye, 0}, half.position, 320, 240);
                const Picture p = draw({half}, view, 1024, blended);
                ASSERT_EQ(p.surfels.size(), 1u);
                const Surfel s = p.surfels[0];
                ASSERT_GT(glm::dot(glm::normalize(s.edge), toward), 0.998f);
                EXPECT_NEAR(glm::length(s.edge), glm::length(half.edge), 0.1f * glm::length(half.edge));
                size_t inside = 0, outside = 0;
                for (uint32_t y = 0; y < 240; ++y)
                    for (uint32_t x = 0; x < 320; ++x) {
                        const size_t at = y * 320 + x;
                        const glm::vec3 ray = p.ray(x, y);
                        const float depth =
                            glm::dot(s.normal, s.position - p.eye()) / glm::dot(s.normal, ray);
                        const glm::vec3 offset = p.eye() + depth * ray - s.position;
                        const float beyond = glm::dot(s.edge, offset), r = glm::length(offset) / s.radius;
                        if (r < 0.98f && beyond < 0.96f) {
                            ++inside;
                            ASSERT_FALSE(p.empty(at)) << x << " " << y;
                            EXPECT_EQ((p.texels[at].albedo & kTexelFromBehind) != 0, eye > 3);
                            EXPECT_NEAR(p.texels[at].depth, depth, 2e-3f);
                        } else if (r > 1.02f || beyond > 1.04f) {
                            outside += r < 0.98f;
                            ASSERT_TRUE(p.empty(at)) << x << " " << y << " beyond " << beyond;
                        }
                    }
                EXPECT_GT(inside, 2u);
                EXPECT_GT(outside, area > 5e-3f ? 5u : 0u);
            }
}

TEST_P(GBufferTest, PointsOfAFixedSizeHaveNoLines) {
    Surfel half{{0, 3, 0}, {0, -1, 0}, kWhite, 0, 0.01f, 0};
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 64, 64);
    const PointSize size{.pixels = 15};
    const Picture whole = draw({half}, view, 1024, false, size);
    half.edge = {40, 0, 0};
    EXPECT_EQ(draw({half}, view, 1024, false, size).ids, whole.ids);
}

TEST_P(GBufferTest, NormalsAreTurnedTowardTheViewer) {
    const Surfel away{{0, 3, 0}, {0, 1, 0}, kWhite, 0, 0.1f, 0};
    const Picture p = draw({away}, look({0, 0, 0}, {0, 1, 0}, 64, 64));
    EXPECT_LT(decode_octahedral(p.texels[32 * 64 + 32].normal).y, -0.999f);
}

TEST_P(GBufferTest, PointsThatFaceAwayAreLeftOutOnRequest) {
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 64, 64);
    const Surfel away{{0, 3, 0}, glm::normalize(glm::vec3(0, 1, 0.2f)), kWhite, 0, 0.1f, 0},
        behind{{0, 5, 0}, glm::normalize(glm::vec3(0.9f, -0.1f, 0)), kWhite, 0, 0.1f, 7},
        bare{{0.4f, 3, 0.4f}, glm::vec3(0.0f), kWhite, 0, 0.01f, 5};
    for (const float pixels : {0.0f, 9.0f})
        for (const bool front_only : {false, true}) {
            const Picture p =
                draw({away, behind, bare}, view, 1024, false, {.pixels = pixels, .front_only = front_only});
            const auto shown = [&](uint32_t material) {
                return std::ranges::count_if(p.texels, [&](const GBufferTexel& texel) {
                    return texel.depth > 0 && (texel.material & 0xffff) == material;
                });
            };
            EXPECT_EQ(shown(0) > 0, !front_only) << pixels;
            EXPECT_EQ(p.texels[32 * 64 + 32].material & 0xffff, front_only ? 7u : 0u)
                << "seen through the one that faces away, " << pixels;
            EXPECT_GT(shown(5), 0) << "without a normal, " << pixels;
        }
}

TEST_P(GBufferTest, SurfelWithoutANormalFacesTheViewer) {
    const Surfel bare{{1, 3, 1}, glm::vec3(0.0f), kWhite, 0, 0.1f, 0};
    const Picture p = draw({bare}, look({0, 0, 0}, {1, 3, 1}, 64, 64));
    const glm::vec3 normal = decode_octahedral(p.texels[32 * 64 + 32].normal);
    EXPECT_GT(glm::dot(normal, -glm::normalize(bare.position)), 0.999f);
}

TEST_P(GBufferTest, RedPlaneBehindAWhiteOneNeverShowsThrough) {
    constexpr float kSpacing = 0.02f;
    const float radius = std::sqrt(9 * kSpacing * kSpacing / 3.14159f);
    for (const float distance : {0.5f, 2.0f, 8.0f}) {
        auto surfels = wall(distance, 1.0f, kSpacing, kWhite, 1);
        append(surfels, wall(distance + 3 * radius, 1.0f, kSpacing, kRed, 2));
        const float field = std::min(1.0f, 2 * std::atan(0.9f / (distance + 3 * radius)));
        const CameraView camera = look({0, 0, 0}, {0, 1, 0}, 320, 320, field);
        Light spot{{0, 0, 0, std::cos(field / 2)}, {0, 1, 0, 1}, {1, 1, 1, 0}};
        for (const CameraView& view : {camera, spot_view(spot, 320)}) {
            const Picture p = draw(surfels, view);
            for (size_t at = 0; at < p.ids.size(); ++at) {
                ASSERT_FALSE(p.empty(at)) << "a hole at distance " << distance;
                ASSERT_FALSE(p.red(at)) << "red shows through at distance " << distance;
            }
        }
    }
}

TEST_P(GBufferTest, WindowInAWallStaysOpen) {
    constexpr float kSpacing = 0.02f, kHalf = 0.3f;
    const float radius = std::sqrt(9 * kSpacing * kSpacing / 3.14159f) * 1.05f;  // areas are exact to 9 %
    auto surfels = wall(2, 1.5f, kSpacing, kWhite, 1);
    std::erase_if(surfels, [&](const Surfel& s) {
        return std::max(std::abs(s.position.x), std::abs(s.position.z)) < kHalf;
    });
    append(surfels, wall(4, 2.5f, kSpacing, kRed, 2));
    const CameraView camera = look({0, 0, 0}, {0, 1, 0}, 240, 240, 1.0f);
    const Light spot{{0, 0, 0, std::cos(0.5f)}, {0, 1, 0, 1}, {1, 1, 1, 0}};
    for (const CameraView& view : {camera, spot_view(spot, 240)}) {
        const Picture p = draw(surfels, view);
        const float pixel = 2 * 2 * std::tan(0.5f) / 240;  // on the wall
        size_t open = 0;
        for (uint32_t y = 0; y < 240; ++y)
            for (uint32_t x = 0; x < 240; ++x) {
                const glm::vec3 hit = p.ray(x, y) * 2.0f;
                const float away = std::max(std::abs(hit.x), std::abs(hit.z));
                if (away < kHalf - radius - pixel) {
                    ++open;
                    ASSERT_TRUE(p.red(y * 240 + x)) << "the window is closed at " << x << " " << y;
                }
                if (away > kHalf + pixel) {
                    ASSERT_FALSE(p.red(y * 240 + x)) << "the wall is open at " << x << " " << y;
                }
            }
        EXPECT_GT(open, 2000u);
    }
}

TEST_P(GBufferTest, DiscSeenEdgeOnKeepsThePixelOfItsCentreAtASaneDepth) {
    const Surfel edge{{0.001f, 5, 0.001f}, {0, 0, 1}, kWhite, 0, 1e-4f, 0};
    const Picture p = draw({edge}, look({0, 0, 0.001f}, {0, 1, 0.001f}, 101, 101));
    size_t covered = 0;
    for (size_t at = 0; at < p.ids.size(); ++at) {
        if (p.empty(at)) continue;
        ++covered;
        EXPECT_NEAR(p.texels[at].depth, 5, p.surfels[0].radius * 1.001f);
    }
    EXPECT_GE(covered, 1u);
    EXPECT_LE(covered, 2u);
}

TEST_P(GBufferTest, DiscSmallerThanAPixelTakesOnePixel) {
    const Surfel speck{{0.1f, 5, 0.1f}, {0, -1, 0}, kWhite, 0, 1e-8f, 0};
    const Picture p = draw({speck}, look({0, 0, 0}, {0, 1, 0}, 64, 64));
    EXPECT_EQ(std::count_if(p.ids.begin(), p.ids.end(), [](uint32_t id) { return id != kNoSurfel; }), 1);
}

TEST_P(GBufferTest, DiscThatReachesBehindTheEyeCoversOnlyWhatIsBeforeIt) {
    const Surfel floor{{0, 0, -1}, {0, 0, 1}, kWhite, 0, 50, 0};
    const Picture p = draw({floor}, look({0, 0, 0}, {0, 1, 0}, 64, 64, 1.5f));
    const float radius = p.surfels[0].radius;
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 64; ++x) {
            const glm::vec3 ray = p.ray(x, y);
            const bool met = ray.z < 0 && glm::length(ray / -ray.z + glm::vec3(0, 0, 1)) < radius;
            EXPECT_EQ(!p.empty(y * 64 + x), met) << x << " " << y;
        }
}

TEST_P(GBufferTest, SurfelsBehindTheEyeAreNotSeen) {
    const Surfel behind{{0, -3, 0}, {0, 1, 0}, kWhite, 0, 0.1f, 0};
    const Picture p = draw({behind}, look({0, 0, 0}, {0, 1, 0}, 64, 64));
    for (size_t at = 0; at < p.ids.size(); ++at) EXPECT_TRUE(p.empty(at));
}

TEST_P(GBufferTest, PictureDoesNotDependOnTheOrderOfTheSurfels) {
    auto surfels = wall(2, 1.0f, 0.01f, kWhite, 1);
    const CameraView view = look({0, 0, 0}, {0.2f, 1, 0}, 200, 160);
    const Picture first = draw(surfels, view, 1u << 20);
    std::shuffle(surfels.begin(), surfels.end(), std::mt19937(3));
    const Picture second = draw(surfels, view, 1u << 20);
    size_t different = 0;
    for (size_t at = 0; at < first.texels.size(); ++at)
        different += std::memcmp(&first.texels[at], &second.texels[at], sizeof(GBufferTexel)) != 0;
    EXPECT_LE(different, 3u) << "only equal keys may go to another surfel";
}

TEST_P(GBufferTest, RunsGiveTheSamePixels) {
    auto surfels = wall(2, 1.0f, 0.005f, kWhite, 1);
    const size_t count = surfels.size();
    for (size_t i = 0; i < count; i += 3) surfels.push_back(surfels[i]);  // ties
    const CameraView view = look({0, 0, 0}, {0.2f, 1, 0}, 200, 160);
    const Picture first = draw(surfels, view);
    for (int run = 0; run < 5; ++run) {
        const Picture again = draw(surfels, view);
        ASSERT_EQ(first.ids, again.ids);
        ASSERT_EQ(
            std::memcmp(first.texels.data(), again.texels.data(), first.texels.size() * sizeof(GBufferTexel)),
            0);
    }
}

TEST_P(GBufferTest, NoSurfelsGiveAnEmptyPicture) {
    const Picture p = draw({}, look({0, 0, 0}, {0, 1, 0}, 64, 48));
    for (size_t at = 0; at < p.ids.size(); ++at) {
        ASSERT_TRUE(p.empty(at));
        ASSERT_EQ(p.texels[at].depth, 0.0f);
    }
}

TEST_P(GBufferTest, ManyLargeDiscsOverflowTheirQueueWithoutHoles) {
    // More discs of over 256 pixels than the queue holds, all in one place: the nearest must win.
    std::vector<Surfel> surfels;
    for (int i = 0; i < 70000; ++i)
        surfels.push_back({{0, 4 + 1e-4f * static_cast<float>(i % 10000), 0},
                           {0, -1, 0},
                           i % 10000 ? kRed : kWhite,
                           0,
                           0.2f,
                           0});
    const Picture p = draw(surfels, look({0, 0, 0}, {0, 1, 0}, 48, 48), 1u << 20);
    EXPECT_FALSE(p.empty(24 * 48 + 24));
    EXPECT_FALSE(p.red(24 * 48 + 24));
    EXPECT_EQ(p.ids[24 * 48 + 24], 0u) << "the smallest id of those with the same key";
}

TEST_P(GBufferTest, SpotViewSeesTheWholeConeAndNothingElse) {
    const Light spot{{1, 2, 3, std::cos(0.4f)}, {0, 0, -1, 1}, {1, 1, 1, 0}};
    const CameraView view = spot_view(spot, 128);
    EXPECT_NEAR(glm::length(glm::vec3(view.right.x, view.right.y, view.right.z)), std::tan(0.4f), 1e-5f);
    EXPECT_NEAR(glm::length(glm::vec3(view.up.x, view.up.y, view.up.z)), std::tan(0.4f), 1e-5f);
    EXPECT_EQ(view.width, 128u);
}

TEST_P(GBufferTest, AnOrthographicViewDrawsAlikeAtAnyDepthAndPutsTexelsOnTheirSurface) {
    CameraView view{};
    view.origin = {0, 0, 0, 0.01f};
    view.forward = {0, 1, 0, 0};
    view.right = {4, 0, 0, 0};  // m
    view.up = {0, 0, 3, 0};
    view.width = 80;
    view.height = 60;
    view.projection = kOrthographic;
    const auto covered = [&](float depth, float spacing) {
        const Picture p = draw(wall(depth, 1.5f, spacing, kRed, 3), view);
        size_t pixels = 0;
        for (size_t at = 0; at < p.texels.size(); ++at) {
            if (p.empty(at)) continue;
            ++pixels;
            EXPECT_NEAR(p.texels[at].depth, depth, 0.1f);
        }
        return static_cast<double>(pixels);
    };
    const double fine = covered(3, 0.03f), coarse = covered(3, 0.3f);  // small discs, and large ones
    EXPECT_NEAR(fine, 30 * 30, 0.15 * 900) << "3 m by 3 m, ten pixels a metre, and a rim of half a disc";
    EXPECT_GT(coarse, fine) << "a wider rim";
    EXPECT_NEAR(covered(30, 0.03f), fine, 0.01 * fine) << "ten times as far it is as large";
    EXPECT_NEAR(covered(30, 0.3f), coarse, 0.01 * coarse);
}

INSTANTIATE_TEST_SUITE_P(Passes, GBufferTest, ::testing::Bool(), passes_name);

}  // namespace
}  // namespace lucarne::gi
