#include "gi/engines/paths/surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "io/core/random.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

/// A floor that goes on below a wall, which stands across it at x = 0.
class SurfacesAboutAWall : public testing::Test {
 protected:
    static std::vector<Surfel> surfels() {
        std::vector<Surfel> surfels;
        scenes::add_rectangle(surfels, {-1.013f, -.5f, 0}, 2.0f * kX, 2.0f * kY, 60, glm::vec3(.5f));
        scenes::add_rectangle(surfels, {0, -.5f, -.004f}, 2.0f * kY, 2.0f * kZ, 60, glm::vec3(.5f));
        return surfels;
    }
    const Surfaces surfaces_ = surfaces_of(surfels());
};

TEST_F(SurfacesAboutAWall, DividesDiscsThatReachThroughIt) {
    size_t through = 0;
    for (const CutOffPart& part : surfaces_.parts()) {
        const Surfel disc = surfaces_.surfels()[part.side / 2];
        if (disc.normal.z < .5f || part.side % 2 || disc.position.y < .1f || disc.position.y > .9f) continue;
        EXPECT_LT(disc.position.x * part.position.x, 0) << "the part is behind the wall";
        EXPECT_LT(std::abs(disc.position.x), disc.radius);
        ++through;
    }
    EXPECT_GT(through, 15u);
    for (const CutOffPart& part : surfaces_.parts())
        EXPECT_FALSE(part.side % 2 && surfaces_.surfels()[part.side / 2].normal.z > .5f &&
                     std::abs(part.position.x) < .1f)
            << "nothing is below the floor";
}

TEST_F(SurfacesAboutAWall, TellWhichPartARayMeets) {
    size_t met = 0;
    for (float x = -.05f; x < .05f; x += .0037f)
        for (float y = .2f; y < .8f; y += .013f) {
            const glm::vec3 from(x + (x > 0 ? .1f : -.1f), y, .1f);
            const glm::vec3 direction = glm::normalize(glm::vec3(x, y, 0) - from);
            const auto hit = surfaces_.tracer().first_hit(from, direction);
            ASSERT_TRUE(hit);
            if (surfaces_.surfels()[hit->surfel].normal.z < .5f) continue;
            const glm::vec3 place = from + direction * hit->distance;
            const Side side = surfaces_.side_of(*hit, place);
            EXPECT_GT(surfaces_.surfels()[side / 2].position.x * x, 0) << "light comes from this side";
            met += surfaces_.is_part(side);
        }
    EXPECT_GT(met, 20u);
}

TEST_F(SurfacesAboutAWall, KeepTheAreasOfDiscs) {
    double sum = 0, discs = 0;
    for (Side side = 0; side < 2 * surfaces_.surfels().size(); ++side)
        if (surfaces_.exists(side)) sum += surfaces_.area_of(side);
    for (const Surfel& disc : surfaces_.tracer().surfels()) discs += 2 * disc.area;
    EXPECT_NEAR(sum / discs, 1, 1e-4);
    EXPECT_FALSE(surfaces_.parts().empty());
}

TEST(SurfacesOfFoliage, HaveAtMostTwoPartsADisc) {
    // Discs that cut each other, those of one half more often than those of the other.
    std::vector<Surfel> surfels;
    Random random(3);
    for (int i = 0; i < 3000; ++i) {
        glm::vec3 at, normal;
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = static_cast<float>(random.uniform());
            normal[axis] = static_cast<float>(random.uniform() - .5);
        }
        surfels.push_back({at, glm::normalize(normal), glm::vec3(.5f), at.x < .5f ? .08f : .05f, .01f, 0});
    }
    const Surfaces surfaces = surfaces_of(surfels);
    EXPECT_LE(surfaces.parts().size(), 2 * surfels.size());
    EXPECT_GT(surfaces.parts().size(), surfels.size() / 2);
    // Sides with many parts have none, wherever they are in the order.
    size_t most = 0;
    for (Side side = 0; side < 2 * surfels.size(); ++side)
        most = std::max(most, surfaces.parts_of(side).size());
    EXPECT_LT(most, 6u);
    std::ranges::reverse(surfels);
    const Surfaces reversed = surfaces_of(surfels);
    EXPECT_EQ(reversed.parts().size(), surfaces.parts().size());
    double sum = 0, discs = 0;
    for (Side side = 0; side < 2 * surfaces.surfels().size(); ++side)
        if (surfaces.exists(side)) sum += surfaces.area_of(side);
    for (const Surfel& disc : surfaces.tracer().surfels()) discs += 2 * disc.area;
    EXPECT_NEAR(sum / discs, 1, 1e-4);
}

TEST(SurfacesInTheOpen, AreWhole) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, 2.0f * kX, kY, 40, glm::vec3(.5f));
    EXPECT_TRUE(surfaces_of(surfels).parts().empty());
    EXPECT_TRUE(surfaces_of({}).parts().empty());
}

}  // namespace
}  // namespace lucarne::gi::paths
