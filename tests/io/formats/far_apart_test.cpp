#include "io/formats/far_apart.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucarne::io {
namespace {

using glm::dvec3;

PlacedScan at(const std::string& name, const dvec3& low, double size) {
    return {name, {low, low + dvec3(size)}};
}

TEST(FarApart, ProjectedAndLocalCoordinatesTogetherAreWarnedOf) {
    const std::vector<PlacedScan> scans = {at("utm.las", {500'000, 5'400'000, 300}, 40),
                                           at("local.las", {-3, -2, 0}, 25)};
    EXPECT_THAT(far_apart(scans),
                ::testing::AllOf(::testing::HasSubstr("utm.las"), ::testing::HasSubstr("local.las"),
                                 ::testing::HasSubstr("times as far apart")));
}

TEST(FarApart, TilesOfACountryAndScansOfOneSiteAreNot) {
    std::vector<PlacedScan> tiles;
    for (int i = 0; i < 1000; ++i) tiles.push_back(at("tile", {500'000 + 1000.0 * i, 5'400'000, 0}, 1000));
    EXPECT_EQ(far_apart(tiles), "");
    EXPECT_EQ(far_apart(std::vector{at("a", dvec3(0), 10), at("b", {900, 0, 0}, 10)}), "");
    EXPECT_EQ(far_apart(std::vector{at("a", dvec3(0), 10)}), "");
    EXPECT_EQ(far_apart(std::vector<PlacedScan>{}), "");
}

TEST(FarApart, BoxesOfDamagedHeadersDoNotCount) {
    EXPECT_EQ(far_apart(std::vector{at("a", dvec3(0), 10), at("b", dvec3(NAN), 10), at("c", dvec3(1e9), -1)}),
              "");
    ScanInfo near, far;
    near.path = "near", far.path = "far";
    near.stated_box = {dvec3(0), dvec3(1)};
    EXPECT_EQ(far_apart(std::vector{near, far}), "") << "states no box";
    far.stated_box = {dvec3(1000), dvec3(1001)};
    EXPECT_NE(far_apart(std::vector{near, far}), "");
}

}  // namespace
}  // namespace lucarne::io
