// Meshes become points: evenly by area, as blue noise, with the colours and normals of their surface. Meshes
// that make no sense are rejected.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "io/core/parallel.h"
#include "io/core/random.h"
#include "io/formats/mesh/sampler.h"
#include "tests/io/formats/mesh/mesh_scan.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the fixture and its options
using ::testing::HasSubstr;

/// Distances between nearby points, found with a grid.
class Neighbours {
 public:
    Neighbours(const std::vector<glm::dvec3>& points, double cell) : points_(points), cell_(cell) {
        for (size_t i = 0; i < points.size(); ++i) cells_[key(points[i])].push_back(i);
    }
    /// Returns the distance to the nearest point other than `self`, if it is less than two cells.
    double nearest(const glm::dvec3& from, size_t self) const {
        double least = 2 * cell_;
        for (int k = 0; k < 125; ++k) {
            const glm::dvec3 shift(k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2);
            const auto found = cells_.find(key(from + shift * cell_));
            if (found == cells_.end()) continue;
            for (const size_t i : found->second)
                if (i != self) least = std::min(least, glm::length(points_[i] - from));
        }
        return least;
    }

 private:
    using Key = std::array<int, 3>;
    Key key(const glm::dvec3& p) const {
        const glm::dvec3 at = glm::floor(p / cell_);
        return {static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)};
    }
    const std::vector<glm::dvec3>& points_;
    double cell_;
    std::map<Key, std::vector<size_t>> cells_;
};

/// Returns a sphere of radius 1 as `rings` rings of quads, which turn left seen from outside.
std::string sphere(int rings, bool normals) {
    std::string text;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i < 2 * rings; ++i) {
            const double down = M_PI * j / rings, around = M_PI * i / rings;
            const glm::dvec3 p(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around),
                               std::cos(down));
            text += fmt::format("v {:.9f} {:.9f} {:.9f}\n", p.x, p.y, p.z);
            if (normals) text += fmt::format("vn {:.9f} {:.9f} {:.9f}\n", p.x, p.y, p.z);
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < 2 * rings; ++i) {
            const int next = (i + 1) % (2 * rings), row = 2 * rings * j, below = row + 2 * rings;
            text += "f";
            for (const int corner : {row + i, below + i, below + next, row + next})
                text += normals ? fmt::format(" {0}//{0}", corner + 1) : fmt::format(" {}", corner + 1);
            text += "\n";
        }
    return text;
}

TEST_F(MeshScan, SamplesKeepTheirDistanceAndLeaveNoHole) {
    constexpr double kSpacing = 0.04;
    read(sphere(40, false), every(kSpacing));
    const auto all = positions();
    const double expected = 4 * M_PI / (kSpacing * kSpacing);
    EXPECT_NEAR(static_cast<double>(all.size()) / expected, 1.0, 0.05);
    EXPECT_NEAR(static_cast<double>(source_->info().declared_points) / static_cast<double>(all.size()), 1.0,
                0.05);
    const Neighbours near(all, kSpacing);
    for (size_t i = 0; i < all.size(); ++i)
        ASSERT_GE(near.nearest(all[i], i), 0.75 * kSpacing) << "two samples in a clump";
    for (uint64_t k = 0; k < 4000; ++k) {
        const double z = 2 * unit_double(mix64(1, k)) - 1, around = 2 * M_PI * unit_double(mix64(2, k));
        const double r = std::sqrt(1 - z * z);
        const glm::dvec3 place(r * std::cos(around), r * std::sin(around), z);
        ASSERT_LE(near.nearest(place, all.size()), 1.2 * kSpacing) << "a hole";
    }
}

TEST_F(MeshScan, SamplesAreSpreadByAreaWhateverTheTrianglesSize) {
    // A square with a fan of slivers, large triangles and a corner of tiny ones, in 400 equal bins.
    std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    constexpr int kFan = 1000;
    for (int i = 1; i < kFan; ++i) text += fmt::format("v 1 {:.6f} 0\n", static_cast<double>(i) / kFan);
    text += "f 1 2 5\n";
    for (int i = 1; i + 1 < kFan; ++i) text += fmt::format("f 1 {} {}\n", i + 4, i + 5);
    text += fmt::format("f 1 {} 3\nf 1 3 4\n", kFan + 3);
    read(text, every(0.004));
    std::vector<double> bins(400);
    for (const auto& p : positions()) {
        const auto cell = [](double v) { return std::min(19, static_cast<int>(v * 20)); };
        ++bins[static_cast<size_t>(cell(p.x) * 20 + cell(p.y))];
    }
    const double mean = static_cast<double>(points()) / 400;
    double chi = 0;
    for (const double n : bins) chi += (n - mean) * (n - mean) / mean;
    // Random samples would give 400 +- 28; blue noise is far more even.
    EXPECT_LT(chi, 200);
}

TEST_F(MeshScan, ASliverIsSampledAlongItsLength) {
    // A hundredth of the spacing wide, slanting through blocks that contain nothing else.
    read("v 0 0 0\nv 1 1 1\nv 1 1 1.00001\nf 1 2 3\n", every(1e-3));
    std::vector<glm::dvec3> at;
    for (size_t i = 0; i < points(); ++i) at.push_back(position(i));
    // Its area is that of 7 samples. They may lie anywhere along it, at the usual distance from each other.
    EXPECT_GT(at.size(), 7u);
    EXPECT_LT(at.size(), 8 * 8u);
    for (size_t i = 0; i < at.size(); ++i) {
        EXPECT_LT(std::max(std::abs(at[i].x - at[i].y), std::abs(at[i].x - at[i].z)), 2e-5);
        for (size_t k = 0; k < i; ++k) EXPECT_GT(glm::distance(at[i], at[k]), .75e-3);
    }
}

TEST_F(MeshScan, RoundingLosesNoPartOfAThinSliver) {
    // Too thin to know its plane well; the samples still lie all along it.
    read("v 0 0 0\nv .7 .9 1\nv .7000000001 .9 1.0000000001\nf 1 2 3\n", every(2e-6));
    ASSERT_GT(points(), 50u);
    std::vector<double> at;
    for (size_t i = 0; i < points(); ++i) at.push_back(position(i).z);
    std::ranges::sort(at);
    for (size_t i = 1; i < at.size(); ++i) ASSERT_LT(at[i] - at[i - 1], 0.12) << at[i];
    EXPECT_LT(at.front(), 0.2);  // it begins at its tip, which has no area
    EXPECT_GT(at.back(), 0.95);
}

TEST_F(MeshScan, BothSidesOfAThinWallAreSampledInFull) {
    const std::string wall = kSquare + "v 0 0 0.001\nv 1 0 0.001\nv 1 1 0.001\nv 0 1 0.001\nf 8 7 6 5\n";
    read(wall, every(0.02));
    size_t up = 0;
    for (size_t i = 0; i < points(); ++i) up += value(i, "normal", 2) > 0;
    EXPECT_NEAR(static_cast<double>(up), 2500, 125);
    EXPECT_NEAR(static_cast<double>(points() - up), 2500, 125);
}

TEST_F(MeshScan, TheSamplesAreTheSameForAnyNumberOfThreadsAndAnyBatch) {
    const std::string text = sphere(20, true);
    read(text, every(0.01));
    const auto all = records_.bytes;
    for (const unsigned threads : {1u, 7u}) {
        const ThreadLimit limit(threads);
        const auto again = testing::read_all(*source_, 777);
        ASSERT_TRUE(again);
        EXPECT_TRUE(again->bytes == all) << threads;
    }
}

TEST_F(MeshScan, NormalsAreTheFacesOrInterpolated) {
    read(kSquare, every(0.05));
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "normal"), glm::dvec3(0, 0, 1));
    read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 4 3 2 1\n", every(0.05));
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "normal"), glm::dvec3(0, 0, -1));
    read(sphere(20, true), every(0.05));
    for (size_t i = 0; i < points(); ++i)
        ASSERT_LT(glm::length(triple(i, "normal") - glm::normalize(position(i))), 0.01);
}

TEST_F(MeshScan, NormalsAndCoordinatesThatNoFaceNamesAreNotThoseOfOtherVertices) {
    // One normal for four vertices: fuzz_obj once read beyond its end.
    read("vn 1 0 0\n" + kSquare, every(0.05));
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "normal"), glm::dvec3(0, 0, 1));
    // As many normals as vertices belong to the vertices.
    read("vn 1 0 0\nvn 1 0 0\nvn 1 0 0\nvn 1 0 0\n" + kSquare, every(0.05));
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "normal"), glm::dvec3(1, 0, 0));

    put_picture("p.png");
    put("m.mtl", "newmtl painted\nKd 0 0 0\nmap_Kd p.png\n");
    put("a.obj", "mtllib m.mtl\nvt 0 0\nusemtl painted\n" + kSquare);
    read_folder("a.obj", every(0.05));
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "color"), glm::dvec3(0)) << "of the material";
}

TEST_F(MeshScan, ColoursComeFromFacesVerticesAndMaterials) {
    read(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty "
        "uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 10 20 30\n1 0 0 10 20 30\n0 1 0 10 20 30\n3 0 1 2\n",
        every(0.05));
    ASSERT_GT(points(), 100u);
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(10, 20, 30));
    read(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face "
        "1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar "
        "blue\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 2 255\n",
        every(0.05));
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(1, 2, 255));
    read("v 0 0 0 0.2 0.4 1\nv 1 0 0 0.2 0.4 1\nv 0 1 0 0.2 0.4 1\nf 1 2 3\n", every(0.05));
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(51, 102, 255));
    // Rounding may take a white of 1 slightly above 1, and a black of 0 slightly below 0.
    read("v 0 0 0 0.2 0.4 1.00001\nv 1 0 0 0.2 0.4 1\nv 0 1 0 0.2 0.4 1\nf 1 2 3\n", every(0.05));
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(51, 102, 255));
    read(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty float red\nproperty float green\nproperty float blue\nelement face 1\nproperty list "
        "uchar int vertex_indices\nend_header\n0 0 0 -0.0001 .2 1\n1 0 0 -1e-9 .2 1\n0 1 0 0 .2 1\n3 0 1 2\n",
        every(0.05));
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(0, 51, 255));
    put("m.mtl", "newmtl a b\nKd 0.2 0.4 1\nnewmtl c\nKd 1 1 0\n");
    put("a.obj",
        "mtllib m.mtl\n" + kSquare + "v 0 0 1\nv 1 0 1\nv 1 1 1\nusemtl c\nf 5 6 7\nusemtl a b\nf 5 7 6\n");
    read_folder("a.obj", every(0.05));
    for (size_t i = 0; i < points(); ++i)
        ASSERT_EQ(triple(i, "color"), position(i).z < 0.5         ? glm::dvec3(188)
                                      : value(i, "normal", 2) > 0 ? glm::dvec3(255, 255, 0)
                                                                  : glm::dvec3(51, 102, 255));
}

TEST_F(MeshScan, PolygonsAreCutAlongTheirOutline) {
    // An L of area 3, in both orientations, lifted onto a slope.
    for (const bool backwards : {false, true}) {
        std::string text = "v 0 0 0\nv 2 0 2\nv 2 1 2\nv 1 1 1\nv 1 2 1\nv 0 2 0\n";
        text += backwards ? "f 6 5 4 3 2 1\n" : "f 1 2 3 4 5 6\n";
        read(text, every(0.05));
        EXPECT_NEAR(notes().samples->area_m2, 3 * std::sqrt(2.0), 1e-9);
        for (size_t i = 0; i < points(); ++i) {
            const glm::dvec3 p = position(i);
            ASSERT_FALSE(p.x > 1.001 && p.y > 1.001) << "outside";
            ASSERT_EQ(value(i, "normal", 2) < 0, backwards);
        }
    }
}

TEST_F(MeshScan, FacesWithoutAreaAreLeftOutAndCounted) {
    read(kSquare + "f 1 1 2\nf 1 2\nv 2 0 0\nf 1 2 5\nv nan 0 0\nf 1 2 6\n", every(0.05));
    EXPECT_EQ(notes().triangles, 2u);
    EXPECT_EQ(notes().without_area, 3u);
    EXPECT_EQ(notes().not_finite, 1u);
    EXPECT_NEAR(static_cast<double>(points()), 400, 40);
    read("v 0 0 0\nv 1 0 0\nf 1 1 2\n");
    EXPECT_EQ(points(), 2u) << "without a single face its vertices are what there is";
}

TEST_F(MeshScan, IndicesThatNameNothingAreRejected) {
    EXPECT_THAT(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n").line(),
                HasSubstr("line 4 names vertex 4, of 3"));
    EXPECT_THAT(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n").line(), HasSubstr("names vertex -4"));
    EXPECT_THAT(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n").line(), HasSubstr("names vertex 0"));
    EXPECT_THAT(error_of("v 0 0 0\nf 1 2 4\nv 1 0 0\nv 0 1 0\n").line(),
                HasSubstr("line 2 names vertex 4, of 3"));
    EXPECT_THAT(error_of("v 0 0 0\nf -1 -2 1\nv 1 0 0\nv 0 1 0\n").line(), HasSubstr("names vertex -2"));
    EXPECT_THAT(error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/x 2 3\n").line(),
                HasSubstr("has 'x' for the number of a texture coordinate"));
    EXPECT_THAT(error_of("v 0 0\n").line(), HasSubstr("too few numbers"));
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
        "0\n0 1 0\n";
    for (const char* face : {"3 0 1 3\n", "3 0 1 -1\n"})
        EXPECT_THAT(error_of(ply + face).line(), HasSubstr("face 1 names vertex"));
    EXPECT_THAT(error_of(ply).line(), HasSubstr("ends early: its header promises 1 face, 0 are there"));
    EXPECT_THAT(error_of(ply + "4 0 1 2\n").line(),
                HasSubstr("face 1 has no value for its property vertex_indices"));
}

TEST_F(MeshScan, FacesMayNameWhatStandsFurtherDown) {
    read("v 0 0 0\nf 1//1 2//1 3//1\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nv 5 5 5\n", every(0.05));
    EXPECT_NEAR(static_cast<double>(points()), 200, 30);
    for (size_t i = 0; i < points(); ++i) {
        EXPECT_EQ(triple(i, "normal"), glm::dvec3(1, 0, 0));
        EXPECT_LE(position(i).x + position(i).y, 1.0001);
    }
    EXPECT_EQ(notes().missing_corners, 0u);
    // Negative indices count from the place of the face, and its material is the current one there.
    put("m.mtl", "newmtl first\nKd 1 0 0\nnewmtl second\nKd 0 0 1\n");
    put("a.obj", "mtllib m.mtl\nusemtl first\nv 0 0 0\nf -1 2 3\nusemtl second\nv 1 0 0\nv 0 1 0\n");
    read_folder("a.obj", every(0.05));
    ASSERT_GT(points(), 100u);
    for (size_t i = 0; i < points(); ++i) ASSERT_EQ(triple(i, "color"), glm::dvec3(255, 0, 0));
}

TEST_F(MeshScan, ATinyMeshFarAwayStaysWhereItIs) {
    // The coordinates would take more steps than 32 bits can count: they are coarser than the mesh itself.
    read("v 4000000 0 0\nv 4000000.0000000010 0 0\nv 4000000 0.0000000005 0\nf 1 2 3\n", about(100));
    ASSERT_GT(points(), 0u);
    for (size_t i = 0; i < points(); ++i) EXPECT_NEAR(position(i).x, 4e6, 2e-9);
    read("v 2e16 0 0\nv 20000000000000004 0 0\nv 2e16 4 0\nf 1 2 3\n", about(100));
    ASSERT_GT(points(), 0u);
    for (size_t i = 0; i < points(); ++i) {
        EXPECT_GE(position(i).x, 2e16);
        EXPECT_LE(position(i).x, 2e16 + 4);
    }
}

TEST_F(MeshScan, VerticesAloneAreAPointCloud) {
    read("v 0.25 0 0\nv 1 0 0 1 0 0\nv 1e6 2 3 \\\n 0 1 0\nv nan 0 0\n", {"", true});
    ASSERT_EQ(points(), 3u);
    EXPECT_EQ(records_.dropped, 1u);
    EXPECT_EQ(position(2), glm::dvec3(1e6, 2, 3));
    EXPECT_EQ(triple(2, "color"), glm::dvec3(0, 255, 0));
    EXPECT_EQ(triple(0, "color"), glm::dvec3(188)) << "it has none";
    read(kSquare, kVertices);
    EXPECT_EQ(points(), 4u);
}

TEST_F(MeshScan, TheNumberOfSamplesCanBeAskedForUpToACap) {
    read(kSquare, about(10'000));
    EXPECT_NEAR(static_cast<double>(points()), 10'000, 500);
    EXPECT_EQ(error_of(kSquare, every(1e-5)).kind, ErrorKind::arguments);
    EXPECT_EQ(error_of(kSquare, about(2'000'000'000)).kind, ErrorKind::arguments);
    // The default is a thousandth of the diagonal, but never more than 20 million samples, however large the
    // area.
    source_ = std::move(open_scan(file_.path(), {"", true}).value());
    EXPECT_NEAR(notes().samples->spacing_m, std::sqrt(2.0) / 1000, 1e-9);
    std::string sheets;
    for (int i = 0; i < 100; ++i)
        sheets += fmt::format("v 0 0 {0}\nv 1e20 0 {0}\nv 1e20 1e20 {0}\nv 0 1e20 {0}\nf -4 -3 -2 -1\n", i);
    file_.set(sheets);
    source_ = std::move(open_scan(file_.path(), {"", true}).value());
    EXPECT_LE(source_->info().declared_points, 20'000'000u);
}

TEST_F(MeshScan, FoldedSheetsUponSheetsAskForBoundedMemory) {
    // Four hundred squares very close to each other: all samples of a place fall into the same few cells.
    std::string text;
    for (int i = 0; i < 400; ++i)
        text += fmt::format("v 0 0 {0}\nv 1 0 {0}\nv 1 1 {0}\nv 0 1 {0}\nf -4 -3 -2 -1\n", i * 1e-9);
    read(text, every(0.05));
    EXPECT_NEAR(static_cast<double>(points()), 400, 100) << "one sheet's worth: the discs are full";
    const auto all = positions();
    const Neighbours near(all, 0.05);
    for (size_t i = 0; i < all.size(); ++i) ASSERT_GE(near.nearest(all[i], i), 0.75 * 0.05);
}

TEST_F(MeshScan, BinaryPlyOfEitherEndGivesTheSameAsText) {
    std::array<std::string, 2> bodies;
    for (const bool big : {false, true}) {
        std::string& body = bodies[big];
        const auto put_value = [&](auto value) {
            std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
            if (big) std::reverse(bytes.begin(), bytes.end());
            body += bytes;
        };
        for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) put_value(v);
        body += '\4';
        for (const int32_t i : {0, 1, 2, 3}) put_value(i);
    }
    const auto head = [](const std::string& format) {
        return "ply\nformat " + format +
               " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
               "1\nproperty list uchar int vertex_indices\nend_header\n";
    };
    read(head("ascii") + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", every(0.05));
    const auto text = records_.bytes;
    EXPECT_NEAR(static_cast<double>(points()), 400, 40);
    read(head("binary_little_endian") + bodies[0], every(0.05));
    EXPECT_TRUE(records_.bytes == text);
    read(head("binary_big_endian") + bodies[1], every(0.05));
    EXPECT_TRUE(records_.bytes == text);
    for (size_t cut = 1; cut < 20; ++cut)
        EXPECT_EQ(error_of((head("binary_big_endian") + bodies[1])
                               .substr(0, head("binary_big_endian").size() + bodies[1].size() - cut))
                      .kind,
                  ErrorKind::input_rejected)
            << cut;
}

TEST_F(MeshScan, FacesOfAPlyMayStandBeforeTheirVertices) {
    const std::string vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                      face = "element face 1\nproperty list uchar char vertex_indices\n";
    const auto head = [](const std::string& format, const std::string& elements) {
        return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
    };
    const std::string xyz = "0 0 0\n1 0 0\n0 1 0\n", corners = "3 0 1 2\n";
    read(head("ascii", vertex + face) + xyz + corners, every(0.05));
    const auto usual = records_.bytes;
    EXPECT_NEAR(static_cast<double>(points()), 200, 30);
    read(head("ascii", face + vertex) + corners + xyz, every(0.05));
    EXPECT_TRUE(records_.bytes == usual);
    const std::array<float, 9> values = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::string packed(reinterpret_cast<const char*>(values.data()), sizeof values);
    read(head("binary_little_endian", face + vertex) + std::string("\3\0\1\2", 4) + packed, every(0.05));
    EXPECT_TRUE(records_.bytes == usual);
    EXPECT_THAT(error_of(head("ascii", face + vertex) + "3 0 1 3\n" + xyz).line(),
                HasSubstr("face 1 names vertex 3, of 3"));
}

TEST_F(MeshScan, ChangedBytesNeverCrash) {
    const std::string obj = "mtllib x.mtl\n" + kSquare + "vn 0 0 1\nvt 0 1\nusemtl a\nf 1/1/1 -2//1 3/1 4\n" +
                            "v 5 5 5 1 0 0\nf -1 \\\n 1 2\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
        "0\n0 1 0\n3 0 1 2\n";
    for (uint64_t round = 0; round < 3000; ++round) {
        std::string bytes = round % 2 != 0 ? obj : ply;
        for (uint64_t k = 0; k <= round % 3; ++k)
            bytes[mix64(round, k) % bytes.size()] = "0123456789-/. \nefvx"[mix64(round, k + 9) % 19];
        (void)try_read(bytes, about(500));
    }
}

class SharedMeshes : public MeshScan {};

TEST_F(SharedMeshes, TheStatueOfTheSharedDataIsSampledNearItsVertices) {
    const auto data = testing::shared_data();
    if (data.empty()) GTEST_SKIP() << "the shared data is not here";
    const auto path = data / "ply" / "ankylosaurus_ascii_rgb_normals.ply";
    const auto vertices = open_scan(path, kVertices);
    ASSERT_TRUE(vertices);
    EXPECT_EQ((*vertices)->info().declared_points, 34820u);
    const auto cloud = testing::read_all(**vertices);
    ASSERT_TRUE(cloud);
    std::vector<glm::dvec3> places;
    for (size_t i = 0; i < cloud->count; ++i)
        places.push_back(position_of((*vertices)->schema(), &cloud->bytes[i * (*vertices)->schema().stride]));
    source_ = std::move(open_scan(path, about(35'000)).value());
    records_ = testing::read_all(*source_).value();
    EXPECT_EQ(notes().triangles + notes().without_area, 69636u);
    EXPECT_NEAR(static_cast<double>(points()), 35'000, 1'750);
    const Neighbours near(places, 0.1);
    for (size_t i = 0; i < points(); i += 50) ASSERT_LT(near.nearest(position(i), places.size()), 0.1);
}

}  // namespace
}  // namespace lucarne::io
