#include "octree/stream/joined_source.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/stream/cut.h"
#include "octree/stream/residency.h"
#include "tests/octree/plane_source.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using lucarne::test::ComputedSource;
using lucarne::test::TempFolder;
using test::PlaneSource;
using Sources = std::vector<std::shared_ptr<const NodeSource>>;

/// A square of points at `corner`, as a small cache.
std::filesystem::path make_cache(const TempFolder& folder, size_t number, const glm::dvec3& corner,
                                 uint64_t points, bool intensity) {
    io::Schema schema;
    if (intensity) schema.add(std::string(io::names::intensity), io::ScalarType::u16);
    ComputedSource scan(schema, points, [&](uint64_t i, std::byte* record) {
        io::store(record, corner.x + 1e-2 * static_cast<double>(i % 50));
        io::store(record + 8, corner.y + 1e-2 * static_cast<double>(i / 50));
        io::store(record + 16, corner.z);
    });
    BuildOptions options;
    options.inputs = {&scan};
    options.output = folder / ("part" + std::to_string(number) + ".luc");
    options.normals = NormalsMode::none;
    EXPECT_TRUE(build_cache(options));
    return options.output;
}

View from_above(const glm::dvec3& position, uint32_t pixels) {
    View view;
    view.position = position;
    view.forward = {0, 0, -1};
    view.right = {1, 0, 0};
    view.up = {0, 1, 0};
    view.tan_half_width = view.tan_half_height = 0.5;
    view.width = view.height = pixels;
    return view;
}

TEST(JoinedSource, OneSourceIsItselfAndNoneIsRejected) {
    const auto plane = std::make_shared<const PlaneSource>(3, 10, 1.0);
    EXPECT_EQ(join_sources({plane}).value(), plane);
    const auto none = join_sources({});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().kind, ErrorKind::input_rejected);
}

TEST(JoinedSource, PartsKeepTheirCubesSchemasAndPlacesAndStandUnderTheirOwnRoots) {
    const TempFolder folder;
    const glm::dvec3 far_away(500'000, 5'400'000, 300);  // projected coordinates
    Sources parts;
    parts.push_back(open_cache(make_cache(folder, 0, far_away, 4000, false)).value());
    parts.push_back(open_cache(make_cache(folder, 1, far_away + glm::dvec3(7, 0, 1), 900, true)).value());
    const auto joined = join_sources(parts).value();
    ASSERT_EQ(joined->parts(), 2u);
    EXPECT_EQ(joined->header().points, 4900u);
    EXPECT_EQ(joined->header().min, parts[0]->header().min);
    EXPECT_EQ(joined->header().max, glm::max(parts[0]->header().max, parts[1]->header().max));
    EXPECT_EQ(joined->header().scans.size(), 2u);
    const auto roots = joined->roots();
    ASSERT_EQ(roots.size(), 2u);
    EXPECT_EQ(roots[1], parts[0]->nodes().size());
    for (uint32_t node = 0; node < joined->nodes().size(); ++node) {
        const uint32_t part = node < roots[1] ? 0 : 1, own = node - roots[part];
        const NodeInfo &info = joined->nodes()[node], &original = parts[part]->nodes()[own];
        EXPECT_EQ(joined->part_of(node).index, part);
        EXPECT_EQ(joined->cube(node).min, parts[part]->cube(own).min);
        EXPECT_EQ(joined->record_bytes(node), parts[part]->record_bytes(own));
        EXPECT_EQ(joined->load(node).value().records, parts[part]->load(own).value().records);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            const uint32_t child = info.child(octant);
            ASSERT_EQ(child == kNoNode, original.child(octant) == kNoNode);
            EXPECT_TRUE(child == kNoNode || joined->nodes()[child].parent == node);
        }
    }
    uint64_t directories = 0;
    for (const auto& part : parts) directories += part->directory_bytes();
    EXPECT_EQ(joined->directory_bytes(), directories) << "the parts' nodes are not copied";
}

TEST(JoinedSource, PartsInFeetAndMetresMeetInMetres) {
    class InFeet final : public PlaneSource {
     public:
        InFeet() : PlaneSource(2, 100, 100.0) {
            feet_ = PlaneSource::header();
            feet_.metres_per_unit = 0.3048;
        }
        const SourceHeader& header() const override { return feet_; }

     private:
        SourceHeader feet_;
    };
    const auto joined =
        join_sources({std::make_shared<const PlaneSource>(2, 100, 100.0), std::make_shared<const InFeet>()})
            .value();
    EXPECT_EQ(joined->header().metres_per_unit, 1.0);
    const uint32_t metres = joined->roots()[0], feet = joined->roots()[1];
    EXPECT_NEAR(joined->cube(feet).size, 30.48, 1e-12);
    EXPECT_NEAR(joined->nodes()[feet].spacing() / joined->nodes()[metres].spacing(), 0.3048, 1e-6);
    EXPECT_EQ(joined->header().max.x, 100.0);
}

TEST(JoinedSource, OneCutOverTwoHundredCachesKeepsToOneBudgetAndAFewHandles) {
    const TempFolder folder;
    const auto handles = std::make_shared<HandlePool>(16);
    Sources parts;
    for (size_t i = 0; i < 200; ++i) {
        const glm::dvec3 corner(static_cast<double>(i % 20), static_cast<double>(i / 20), 0);
        const auto path = make_cache(folder, i, corner, 500, i % 2 == 0);
        parts.push_back(open_cache(InputFile::open_shared(path, handles).value()).value());
    }
    const auto joined = join_sources(std::move(parts)).value();
    EXPECT_EQ(joined->header().points, 100'000u);
    const View view = from_above({10, 5, 30}, 2000);
    for (const uint64_t budget : {1'000u, 20'000u, 1'000'000u}) {
        const Cut cut = view_cut(*joined, view, budget, 1e-3);
        EXPECT_LE(cut.points, budget);
        EXPECT_GT(cut.points, std::min<uint64_t>(budget, 100'000) * 9 / 10);
        std::vector<uint64_t> of_part(200, 0);
        for (const CutNode& node : cut.nodes) of_part[joined->part_of(node.node).index] += node.count;
        EXPECT_GT(std::ranges::min(of_part), 0u) << "every scan is seen";
    }
    // All of it through a residency whose cap holds only a part.
    const Cut cut = full_cut(*joined);
    const Cut* cuts[] = {&cut};
    Residency residency(*joined, {.memory = uint64_t{1} << 30, .threads = 4});
    residency.want(cuts);
    EXPECT_TRUE(residency.wait());
    uint64_t points = 0;
    for (const auto& event : residency.poll()) points += event.data->count;
    EXPECT_EQ(points, 100'000u);
    EXPECT_TRUE(residency.take_error());
    EXPECT_LE(handles->open(), 16u);
}

}  // namespace
}  // namespace lucarne::octree
