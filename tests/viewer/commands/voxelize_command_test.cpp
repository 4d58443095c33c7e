#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/formats/scan.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

using testing::HasSubstr;

using test::lucarne;

class VoxelizeCommand : public testing::Test {
 protected:
    void SetUp() override {
        // A tetrahedron, red, with right angles at the origin. Its edges avoid the middles of voxels.
        std::ofstream(path("mesh.ply"))
            << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
               "z\n"
               "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 4\n"
               "property list uchar int vertex_indices\nend_header\n"
               "0 0 0 200 0 0\n1 0 0 200 0 0\n0 .9 0 200 0 0\n0 0 .8 200 0 0\n"
               "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    }
    std::string path(const std::string& name) const { return folder_ / name; }
    nlohmann::json report() const { return nlohmann::json::parse(std::ifstream(path("r.json"))); }
    test::TemporaryFolder folder_;
};

TEST_F(VoxelizeCommand, WritesTheVoxelsOfAMeshByEachMethod) {
    const double area = (.9 + .8 + .72 + std::hypot(.72, .8, .9)) / 2;
    for (const std::string method : {"area", "geometry", "slices"}) {
        const auto done = lucarne("voxelize " + path("mesh.ply") + " -o " + path("v.ply") +
                                  " --grid 32 --by " + method + " --json " + path("r.json") + " --overwrite");
        ASSERT_EQ(done.code, 0) << done.output;
        EXPECT_EQ(report().at("grid"), nlohmann::json({32, 29, 26}));
        EXPECT_NEAR(report().at("area").get<double>(), area, method == "area" ? 1e-5 : .03) << method;
        const auto scan = io::open_scan(path("v.ply")).value();
        EXPECT_EQ(scan->info().declared_points, report().at("voxels").get<uint64_t>());
        const auto reader = scan->open().value();
        io::PointBatch batch;
        const size_t count = reader->read(batch, 100'000).value();
        ASSERT_GT(count, 1000u);
        const auto* color = scan->schema().find(io::names::color);
        const auto* voxel_area = scan->schema().find("voxel_area");
        ASSERT_TRUE(color && voxel_area && scan->schema().find(io::names::normal));
        double sum = 0;
        for (size_t i = 0; i < count; ++i) {
            const std::byte* at = batch.bytes.data() + i * scan->schema().stride;
            const glm::dvec3 p = io::position_of(scan->schema(), at);
            EXPECT_GT(std::min({p.x, p.y, p.z}), 0);
            EXPECT_LT(p.x + p.y / .9 + p.z / .8, 1.06) << "half a voxel beyond the slanted side";
            EXPECT_NEAR(io::load<uint8_t>(at + color->offset), 200, 1);
            sum += static_cast<double>(io::load<float>(at + voxel_area->offset));
        }
        EXPECT_NEAR(sum, report().at("area").get<double>(), 1e-4);
    }
}

TEST_F(VoxelizeCommand, TakesTheSurfelsOfScans) {
    ASSERT_EQ(lucarne("generate cornell -o " + path("a.ply") + " --points 30k --even --normals").code, 0);
    const auto done = lucarne("voxelize " + path("a.ply") + " -o " + path("v.ply") +
                              " --grid 24 --no-cache --json " + path("r.json"));
    ASSERT_EQ(done.code, 0) << done.output;
    EXPECT_GT(report().at("voxels").get<int>(), 2000);
}

TEST_F(VoxelizeCommand, AnswersImpossibleRequestsInOneLine) {
    const std::string mesh = "voxelize " + path("mesh.ply") + " -o " + path("v.ply");
    for (const std::string wrong :
         {" --grid 0", " --grid 1000000", " --vertex-limit 9", " --by geometry --vertex-limit 2",
          " --by geometry --bits 8", " --by voodoo"}) {
        const auto outcome = lucarne(mesh + wrong);
        EXPECT_EQ(outcome.code, 2) << wrong;
        EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 1) << outcome.output;
    }
    const auto large = lucarne(mesh + " --by slices --grid 1000 --device-memory 100M");
    EXPECT_EQ(large.code, 1);
    EXPECT_THAT(large.output, HasSubstr("smaller grid"));
    std::ofstream(path("flat.obj")) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n";
    const auto flat = lucarne("voxelize " + path("flat.obj") + " -o " + path("v.ply") + " --by area");
    EXPECT_EQ(flat.code, 2);
    EXPECT_THAT(flat.output, HasSubstr("no triangles"));
    const auto two = lucarne("voxelize " + path("mesh.ply") + " " + path("flat.obj") + " -o " +
                             path("v.ply") + " --by area");
    EXPECT_EQ(two.code, 2);
    EXPECT_EQ(lucarne("voxelize " + path("none.ply") + " -o " + path("v.ply")).code, 3);
    EXPECT_FALSE(std::filesystem::exists(path("v.ply")));
}

TEST_F(VoxelizeCommand, OneVoxelIsAGrid) {
    const auto done = lucarne("voxelize " + path("mesh.ply") + " -o " + path("v.ply") + " --grid 1 --json " +
                              path("r.json"));
    ASSERT_EQ(done.code, 0) << done.output;
    EXPECT_EQ(report().at("voxels"), 1);
}

}  // namespace
}  // namespace lucarne
