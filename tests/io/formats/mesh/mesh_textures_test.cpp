// Textures of meshes, and the other files that a mesh names.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/io/formats/mesh/mesh_scan.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the fixture and its options

TEST_F(MeshScan, TexturesStandUpright) {
    put_picture("a b.png");
    put("m.mtl", "newmtl painted\nKd 0 0 0\nmap_Kd -blendu on a b.png\n");
    put("a.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl painted\nf 1/1 2/2 3/3 4/4\n");
    read_folder("a.obj", every(0.02));
    expect_picture_upright();
}

TEST_F(MeshScan, TexturesRepeatAndAreScaledAsTheMaterialSays) {
    put_picture("p.png");
    put("m.mtl", "newmtl painted\nmap_Kd -s 0.5 0.5 1 -o 0.25 3.5 0 p.png\n");
    // 0.5 * vt + (0.25, 3.5) spans the picture from (2, -4): the texture repeats everywhere.
    put("a.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 3.5 -15\nvt 5.5 -15\nvt 5.5 -13\nvt 3.5 -13\n"
        "usemtl painted\nf -4/-4 -3/-3 -2/-2 -1/-1\n");
    read_folder("a.obj", every(0.02));
    expect_picture_upright();
}

TEST_F(MeshScan, PlyHasTexturesByFaceOrByVertexAsMeshLabWritesThem) {
    put_picture("p.png");
    const std::string head =
        "ply\nformat ascii 1.0\ncomment TextureFile p.png\nelement vertex 4\nproperty float "
        "x\nproperty float y\nproperty float z\n";
    put("face.ply", head +
                        "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float "
                        "texcoord\nproperty int texnumber\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                        "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 1 1 0 1 0\n");
    read_folder("face.ply", every(0.02));
    expect_picture_upright();
    put("vertex.ply",
        head +
            "property float s\nproperty float t\nelement face 1\nproperty list uchar int "
            "vertex_index\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    read_folder("vertex.ply", every(0.02));
    expect_picture_upright();
}

TEST_F(MeshScan, NamesOfFilesMayBeQuotedOrDifferInCase) {
    std::filesystem::create_directories(folder_ / "tex dir");
    put_picture("tex dir/my p.png");
    const std::string square =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "usemtl painted\nf 1/1 2/2 3/3 4/4\n";
    for (const std::string picture : {"\"tex dir/my p.png\"", "'tex dir/my p.png'", "\"Tex Dir\\My P.PNG\"",
                                      "TEX DIR/MY P.PNG", "-blendu on \"tex dir/my p.png\""})
        for (const std::string library :
             {"\"my m.mtl\"", "my m.mtl", "My M.MTL", "\"other.mtl\" \"my m.mtl\""}) {
            put("my m.mtl", "newmtl painted\nKd 0 0 0\nmap_Kd " + picture + "\n");
            put("a.obj", "mtllib " + library + "\n" + square);
            SCOPED_TRACE(picture + " of " + library);
            read_folder("a.obj", every(0.02));
            expect_picture_upright();
        }
    put("Face.ply",
        "ply\nformat ascii 1.0\ncomment TextureFile \"tex dir/my p.png\"\nelement vertex 4\nproperty float "
        "x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\nproperty "
        "list "
        "uchar int vertex_index\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    read_folder("Face.ply", every(0.02));
    expect_picture_upright();
}

TEST_F(MeshScan, TextureCoordinatesAndNormalsThatAreNotThereAreNone) {
    read("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1/1/2 2/2/1 3/-3/0\n", every(0.05));
    EXPECT_NEAR(static_cast<double>(points()), 200, 30);
    for (size_t i = 0; i < points(); ++i) EXPECT_EQ(triple(i, "normal"), glm::dvec3(0, 0, 1));
    EXPECT_EQ(notes().missing_corners, 5u);
}

TEST_F(MeshScan, NothingOutsideTheMeshsFolderIsOpened) {
    std::filesystem::create_directory(folder_ / "inner");
    put_picture("secret.png");
    put("secret.mtl", "newmtl m\nKd 1 0 0\n");
    put("inner/m.mtl", "newmtl m\nmap_Kd ../secret.png\n");
    put("inner/a.obj", "mtllib ../secret.mtl\nmtllib m.mtl m.mtl " + (folder_ / "secret.mtl").string() +
                           "\n" + "vt 0 0\nusemtl m\n" + kSquare);
    read_folder("inner/a.obj", every(0.1));
    EXPECT_EQ(notes().textures, 0u);
    EXPECT_EQ(schema().find("color"), nullptr);
    // A path on the machine where the file was written; the picture is beside the mesh now.
    put_picture("inner/p.png");
    put("inner/m.mtl", "newmtl m\nmap_Kd C:\\work\\textures\\p.png\n");
    read_folder("inner/a.obj", every(0.1));
    EXPECT_EQ(notes().textures, 1u);
}

TEST_F(MeshScan, ATextureThatIsNoneIsDoneWithout) {
    put("p.png", "no picture at all");
    put("m.mtl", "newmtl m\nKd 0.2 0.4 1\nmap_Kd p.png\n");
    put("a.obj", "mtllib m.mtl\nusemtl m\n" + kSquare);
    read_folder("a.obj", every(0.1));
    EXPECT_EQ(triple(0, "color"), glm::dvec3(51, 102, 255));
}

TEST_F(MeshScan, AChangedTextureOrSpacingIsAnotherStateOfTheFile) {
    put_picture("p.png");
    put("m.mtl", "newmtl m\nmap_Kd p.png\n");
    put("a.obj", "mtllib m.mtl\nusemtl m\n" + kSquare);
    read_folder("a.obj", every(0.1));
    const auto before = source_->info().modified;
    read_folder("a.obj", every(0.1));
    EXPECT_EQ(source_->info().modified, before);
    read_folder("a.obj", every(0.2));
    EXPECT_NE(source_->info().modified, before);
    put("m.mtl", "newmtl m\nmap_Kd p.png\n\n");
    read_folder("a.obj", every(0.1));
    EXPECT_NE(source_->info().modified, before);
}

}  // namespace
}  // namespace lucarne::io
