#include "io/formats/load_mesh.h"

#include <string>

#include <gtest/gtest.h>

#include "io/files/file.h"
#include "tests/temporary_folder.h"

namespace lucarne::io {
namespace {

class LoadMesh : public testing::Test {
 protected:
    Result<mesh::Mesh> load(const std::string& name, const std::string& text,
                            const ReadOptions& options = {}) {
        const std::string path = folder_ / name;
        EXPECT_TRUE(write_file(path, text, true));
        return load_mesh(path, options);
    }
    test::Folder folder_;
};

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0 255 0 0\n2 0 0 255 0 0\n2 1 0 0 0 255\n0 1 0 0 0 255\n4 0 1 2 3\n";

TEST_F(LoadMesh, TrianglesOfObjAndPlyAreThoseOfTheFile) {
    const auto obj = load("a.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    const auto ply = load("a.ply", kPly);
    for (const auto* mesh : {&obj, &ply}) {
        ASSERT_TRUE(*mesh) << mesh->error().line();
        EXPECT_EQ((*mesh)->triangles.size(), 2u);
        EXPECT_DOUBLE_EQ((*mesh)->area(), 2);
        EXPECT_EQ((*mesh)->high, glm::dvec3(2, 1, 0));
    }
    EXPECT_EQ(ply->colors.at(3), (mesh::Color8{0, 0, 255}));
}

TEST_F(LoadMesh, TheContentTellsTheFormat) {
    const auto mesh = load("mesh.xyz", kPly);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles.size(), 2u);
}

TEST_F(LoadMesh, FilesWithoutTrianglesHaveNone) {
    for (const auto& [name, text] :
         {std::pair{"rows.xyz", "1 2 3\n4 5 6\n"}, std::pair{"vertices.obj", "v 0 0 0\nv 1 0 0\n"},
          std::pair{"unknown.bin", "\x01\x02\x03"}}) {
        const auto mesh = load(name, text);
        ASSERT_TRUE(mesh) << mesh.error().line();
        EXPECT_TRUE(mesh->triangles.empty()) << name;
    }
}

TEST_F(LoadMesh, TrianglesWithoutAreaOrWithANumberThatIsNoneAreLeftOut) {
    const auto mesh = load("a.obj",
                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\nv 1e300 0 0\n"
                           "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 2\nf 1 2 6\n");
    ASSERT_TRUE(mesh) << mesh.error().line();
    EXPECT_EQ(mesh->triangles.size(), 1u);
}

TEST_F(LoadMesh, BrokenFilesAreRejected) {
    for (const std::string text : {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "v 0 0 0\nv 1 x 0\n", ""}) {
        const auto mesh = load("a.obj", text);
        ASSERT_FALSE(mesh) << text;
        EXPECT_EQ(mesh.error().kind, ErrorKind::input_rejected);
    }
    const std::string ply = kPly;
    EXPECT_FALSE(load("a.ply", ply.substr(0, ply.size() - 4)));
    EXPECT_FALSE(load_mesh(folder_ / "missing.ply"));
}

}  // namespace
}  // namespace lucarne::io
