#include "gi/surfels/surfel_edge.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "gi/shared/edge.h"
#include "gi/shared/frame.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi {
namespace {

/// Surfels of any place, normal, colour and area.
class SomeSurfels {
 public:
    PackedSurfel operator()() {
        vec3 normal(number(), number(), number());
        while (dot(normal, normal) < 0.01f) normal = vec3(number(), number(), number());
        PackedSurfel surfel;
        surfel.a = random_();
        surfel.b = (random_() & 0xffffu) | (random_() % 200 << 16);
        surfel.c = encode_octahedral(normalize(normal));
        surfel.d = (random_() & 0x3fffffffu) | kSurfelHasNormal;
        return surfel;
    }
    float number() { return uniform_(random_); }

 private:
    std::mt19937 random_{5};
    std::uniform_real_distribution<float> uniform_{-1, 1};
};

float root_of(const PackedSurfel& surfel) {
    return std::sqrt(surfel_own_area(surfel.b, 1.0f));
}

TEST(SurfelEdge, IsFoundAgainAndHardlyChangesNormalAndColour) {
    SomeSurfels some;
    float turned = 0, moved = 0;
    int none = 0;
    for (int i = 0; i < 50'000; ++i) {
        const PackedSurfel plain = some();
        const vec3 normal = decode_octahedral(plain.c);
        vec3 along, other;
        frame_about(normal, along, other);
        const float angle = 3.2f * some.number(), distance = 0.1f + 3.8f * std::abs(some.number());
        const vec3 toward = std::cos(angle) * along + std::sin(angle) * other;
        PackedSurfel surfel = plain;
        pack_edge(toward, distance * root_of(plain), surfel);
        if (!(surfel.d &
              kSurfelHasEdge)) {  // its normal lies between two axes, and each code turns it to the other
            ++none;
            continue;
        }
        EXPECT_EQ(surfel.a, plain.a);
        EXPECT_EQ(surfel.b, plain.b);
        const vec3 edge =
            edge_of_code(surfel_edge_code(surfel.c, surfel.d), decode_octahedral(surfel.c), root_of(surfel));
        turned = std::max(turned, std::acos(std::min(1.0f, dot(normalize(edge), toward))));
        moved = std::max(moved, std::abs(1 / length(edge) / root_of(surfel) - distance));
        EXPECT_NEAR(dot(edge, decode_octahedral(surfel.c)) / length(edge), 0, 1e-5f);
        EXPECT_LT(length(cross(normal, decode_octahedral(surfel.c))), 0.0011f);
        for (uint32_t channel = 0; channel < 30; channel += 10)
            EXPECT_LE(std::abs(static_cast<int>(surfel.d >> channel & 1023u) -
                               static_cast<int>(plain.d >> channel & 1023u)),
                      3);
        EXPECT_TRUE(surfel.d & kSurfelHasNormal);
    }
    std::printf("a line turns by %.3f rad and moves by %.4f roots of the area at most\n",
                static_cast<double>(turned), static_cast<double>(moved));
    EXPECT_LE(none, 50);
    EXPECT_LT(turned, 0.055f);
    EXPECT_LT(moved, 0.0157f);
}

TEST(SurfelEdge, IsLeftOutWhereTheCodeDoesNotReachOrNothingIsKnown) {
    SomeSurfels some;
    const vec3 up(0, 0, 1), along(1, 0, 0);
    PackedSurfel plain = some();
    plain.c = encode_octahedral(up);
    const auto unchanged = [&](const PackedSurfel& before, float distance) {
        PackedSurfel surfel = before;
        pack_edge(along, distance, surfel);
        return surfel.c == before.c && surfel.d == before.d;
    };
    EXPECT_FALSE(unchanged(plain, root_of(plain)));
    EXPECT_FALSE(unchanged(plain, 0)) << "the nearest line that has a code";
    EXPECT_TRUE(unchanged(plain, 4 * root_of(plain)));
    EXPECT_TRUE(unchanged(plain, std::numeric_limits<float>::quiet_NaN()));
    PackedSurfel bare = plain, unknown = plain;
    bare.d &= ~kSurfelHasNormal;
    unknown.b |= kUnknownArea << 16;
    EXPECT_TRUE(unchanged(bare, root_of(plain)));
    EXPECT_TRUE(unchanged(unknown, root_of(plain)));
}

TEST(SurfelEdge, WithoutAnAreaIsInfinitelyFarAway) {
    EXPECT_EQ(edge_of_code(77, vec3(0, 0, 1), 0), vec3(0.0f));
    EXPECT_EQ(edge_of_code(0, vec3(0, 0, 1), 1), vec3(0.0f));
}

}  // namespace
}  // namespace lucarne::gi
