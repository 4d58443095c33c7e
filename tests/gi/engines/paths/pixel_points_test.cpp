#include "gi/engines/paths/pixel_points.h"

#include <vector>

#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

TEST(PixelPoints, OfLargePicturesAreKeptAsFarAsMemoryGoes) {
    const auto bake = bake_of(input_of(scenes::closed_box(1, 24, glm::vec3(.5f)), 80, 64));
    std::vector<SurfacePoint> surfaces;
    for (size_t i = 0; i < 150'000; ++i) {
        SurfacePoint& at = surfaces.emplace_back();
        const auto share = [&](size_t of) {
            return (static_cast<float>(i % of) + .5f) / static_cast<float>(of);
        };
        at.position = {share(389), share(241), 0};
        at.normal = kZ;
        at.radius = i % 7 == 0 ? 0.0f : .01f;  // nothing is seen there
    }
    const auto sums = [&](PixelPoints& points) {
        std::vector<float> of_pixels(surfaces.size(), 0);
        points.begin(*bake, {}, {}, kO, 1);
        points.visit(PixelPoints::List::grid, surfaces, [&](size_t i, std::span<const PointShare> about) {
            for (const PointShare& share : about)
                of_pixels[i] += share.share * static_cast<float>(share.point);
        });
        return of_pixels;
    };
    PixelPoints all, some(700'000), none(0);
    const std::vector<float> first = sums(all);
    EXPECT_EQ(sums(all), first);
    EXPECT_EQ(all.searched(), surfaces.size()) << "found once";
    for (PixelPoints* points : {&some, &none}) {
        EXPECT_EQ(sums(*points), first);
        EXPECT_EQ(sums(*points), first);
        EXPECT_EQ(points->alone(), all.alone());
    }
    EXPECT_EQ(none.searched(), 2 * surfaces.size());
    EXPECT_GT(some.searched(), surfaces.size());
    EXPECT_LT(some.searched(), 2 * surfaces.size());
}

}  // namespace
}  // namespace lucarne::gi::paths
