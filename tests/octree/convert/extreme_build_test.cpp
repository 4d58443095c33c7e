// Clouds that are hard for converters: all points at one place, in one plane, within a millimetre, far apart.
#include <cmath>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

constexpr uint64_t kLittle = uint64_t{32} << 20;
/// Records of 24 bytes: no node of these clouds has to be larger than the largest sample of eight leaves.
constexpr uint32_t kMostOfANode = 20'000;

ComputedSource points_at(uint64_t points, std::function<glm::dvec3(uint64_t)> place) {
    return {io::Schema{}, points,
            [place](uint64_t index, std::byte* record) { io::store(record, place(index)); }};
}

glm::dvec3 on_a_statue(uint64_t index) {
    Random random(9, index);
    const double z = 2 * random.uniform() - 1, angle = 2 * M_PI * random.uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Extreme {
    const char* name;
    uint64_t points;
    std::function<glm::dvec3(uint64_t)> place;
};

std::ostream& operator<<(std::ostream& out, const Extreme& extreme) {
    return out << extreme.name;
}

const Extreme kExtremes[] = {
    {"AMillionTimesOnePoint", 1'000'000, [](uint64_t) { return glm::dvec3(4.5e5, 5.4e6, 312.25); }},
    {"OnePointManyTimesInASurface", 300'000,
     [](uint64_t i) {
         Random random(1, i);
         return i % 4 ? glm::dvec3(.25, .5, 0) : glm::dvec3(random.uniform(), random.uniform(), 0);
     }},
    {"AllInOnePlane", 300'000,
     [](uint64_t i) {
         Random random(2, i);
         return glm::dvec3(50 * random.uniform(), 30 * random.uniform(), 7);
     }},
    {"AllOnOneLine", 300'000, [](uint64_t i) { return glm::dvec3(1e-4 * static_cast<double>(i), 0, 0); }},
    {"AHundredKilometresAroundAStatue", 400'000,
     [](uint64_t i) { return i < 2 ? glm::dvec3(i ? 5e4 : -5e4) : on_a_statue(i); }},
    {"AllInAMillimetre", 200'000,
     [](uint64_t i) {
         Random random(3, i);
         return 1e-3 * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
     }},
    {"AllInAMillimetreBesideAFarPoint", 500'000,
     [](uint64_t i) {
         Random random(3, i);
         return i ? 1e-3 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()) : glm::dvec3(1e4);
     }},
    {"TwoPointsFarBeyondTheStars", 2, [](uint64_t i) { return glm::dvec3(i ? 1e30 : 0.0); }},
    {"AStrayFarBeyondTheStars", 10'001,
     [](uint64_t i) { return i == 10'000 ? glm::dvec3(1e30, -1e30, 1e30) : on_a_statue(i); }},
    {"AStatueOfTheLargestSize", 100'000, [](uint64_t i) { return 1e30 * on_a_statue(i); }},
    {"AStatueOfNoSize", 100'000, [](uint64_t i) { return 1e-30 * on_a_statue(i); }},
    {"TwoPointsAsNearAsDoublesTell", 2, [](uint64_t i) { return glm::dvec3(i ? 5e-324 : 0.0); }},
};

class ExtremeBuild : public ::testing::TestWithParam<std::tuple<Extreme, NormalsMode>> {};

TEST_P(ExtremeBuild, EndsWithEveryPointInNodesOfAnOrdinarySize) {
    const TempFolder folder;
    const auto& [extreme, normals] = GetParam();
    const auto source = points_at(extreme.points, extreme.place);
    BuildOptions options;
    options.inputs = {&source};
    options.output = folder / "extreme.luc";
    options.normals = normals;
    options.memory = kLittle;
    const auto report = build_cache(options);
    ASSERT_TRUE(report) << report.error().line();
    const auto verified = verify_cache(options.output, [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    const auto cache = open_cache(options.output);
    ASSERT_TRUE(cache) << cache.error().line();
    for (const auto& node : (*cache)->nodes()) EXPECT_LE(node.count, kMostOfANode);
    EXPECT_EQ((*cache)->header().points, extreme.points);
    EXPECT_TRUE(test::sorted_records(**cache, 24) == test::sorted_records(source, 24));
}

INSTANTIATE_TEST_SUITE_P(Clouds, ExtremeBuild,
                         ::testing::Combine(::testing::ValuesIn(kExtremes),
                                            ::testing::Values(NormalsMode::none, NormalsMode::estimate)),
                         [](const auto& named) {
                             return std::string(std::get<0>(named.param).name) +
                                    (std::get<1>(named.param) == NormalsMode::none ? "" : "WithNormals");
                         });

TEST(ExtremeBuild, PlacesThatAreDividedComeOutTheSameForAnyMemory) {
    const TempFolder folder;
    const auto source = points_at(500'000, kExtremes[1].place);
    std::string first;
    for (const uint64_t memory : {uint64_t{16} << 20, uint64_t{1} << 30}) {
        BuildOptions options;
        options.inputs = {&source};
        options.output = folder / (std::to_string(memory) + ".luc");
        options.normals = NormalsMode::none;
        options.memory = memory;
        ASSERT_TRUE(build_cache(options));
        const std::string bytes = io::testing::read_bytes(options.output);
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first);
    }
}

}  // namespace
}  // namespace lucarne::octree
