// Truncated and damaged meshes. Without `salvage` they are rejected, and the error says what could be saved.
// With it the complete faces are sampled, or if there are none the vertices are the points, and the rest is
// counted.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "io/formats/mesh/source.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const ReadOptions kUsual{"", true, {0, 500, false}};
const ReadOptions kSalvage{"", true, {0, 500, false}, true};

/// A strip of 6 by 1 squares: 12 triangles on 14 vertices, with the place where each entry ends.
struct Strip {
    std::string bytes;
    std::vector<size_t> vertex_ends, face_ends;
};
constexpr size_t kVertexCount = 14, kFaceCount = 12;

Strip strip(const std::string& encoding, bool faces_first = false) {
    const bool text = encoding == "ascii", big = encoding == "binary_big_endian";
    Strip made;
    const auto put = [&](auto value) {
        if (text) {
            made.bytes += fmt::format("{} ", value);
            return;
        }
        std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
        if (big) std::reverse(bytes.begin(), bytes.end());
        made.bytes += bytes;
    };
    const auto end = [&](std::vector<size_t>& ends) {
        if (text) made.bytes.back() = '\n';
        ends.push_back(made.bytes.size());
    };
    const std::string vertex = fmt::format(
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", kVertexCount);
    const std::string face =
        fmt::format("element face {}\nproperty list uchar int vertex_indices\n", kFaceCount);
    made.bytes =
        "ply\nformat " + encoding + " 1.0\n" + (faces_first ? face + vertex : vertex + face) + "end_header\n";
    const auto put_vertices = [&] {
        for (int i = 0; i < int{kVertexCount}; ++i) {
            put(static_cast<float>(i / 2)), put(static_cast<float>(i % 2)), put(0.25f);
            end(made.vertex_ends);
        }
    };
    if (!faces_first) put_vertices();
    for (int i = 0; i < int{kFaceCount}; ++i) {
        put(uint8_t{3});
        for (int corner = 0; corner < 3; ++corner) put(int32_t{i + corner});
        end(made.face_ends);
    }
    if (faces_first) put_vertices();
    return made;
}

class MeshSalvage : public testing::TextScan {
 protected:
    uint64_t lost(std::string_view what) const {
        const auto contents = survey(*source_);
        for (const Loss& loss : contents->losses)
            if (loss.what == what) return loss.count;
        return 0;
    }
    bool is_mesh() const { return source_->info().format.ends_with("mesh"); }
    uint64_t triangles() const { return source_->info().notes.mesh->triangles; }
    /// Returns the error line of a file that is rejected without `salvage`.
    std::string refusal(std::string_view bytes) {
        return with_salvage_advice(error_of(bytes, kUsual), file_.path(), kUsual).line();
    }
};

TEST_F(MeshSalvage, OfATruncatedPlyEveryWholeFaceOrElseEveryWholeVertex) {
    for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const Strip whole = strip(encoding);
        const size_t body = whole.bytes.find("end_header\n") + 11;
        // Text that lacks only the end of its last number looks complete.
        const size_t last = whole.bytes.size() - (encoding == "ascii" ? 2 : 0);
        for (size_t cut = body; cut < last; ++cut) {
            const auto bytes = whole.bytes.substr(0, cut);
            const auto count = [&](const auto& ends) {
                return static_cast<size_t>(
                    std::ranges::count_if(ends, [&](size_t end) { return end <= cut; }));
            };
            const size_t vertices = count(whole.vertex_ends), faces = count(whole.face_ends);
            const std::string line = refusal(bytes);
            ASSERT_THAT(line, ::testing::AnyOf(HasSubstr("ends early"), HasSubstr("truncated")))
                << encoding << cut;
            read(bytes, kSalvage);
            if (faces > 0) {
                ASSERT_TRUE(is_mesh()) << encoding << cut;
                ASSERT_EQ(triangles(), faces);
                ASSERT_EQ(lost(mesh::kCutFaces), kFaceCount - faces);
                ASSERT_THAT(line, HasSubstr(fmt::format("; {} whole triangle", faces)));
            } else {
                ASSERT_FALSE(is_mesh());
                ASSERT_EQ(points(), vertices) << encoding << cut;
                ASSERT_EQ(lost(lost::cut_off), kVertexCount - vertices);
                ASSERT_EQ(lost(mesh::kCutFaces), kFaceCount) << encoding << cut;
                if (vertices > 1) {
                    ASSERT_THAT(line, HasSubstr(fmt::format("; {} points can be saved", vertices)));
                }
            }
        }
    }
}

TEST_F(MeshSalvage, OfATruncatedPlyWithItsFacesFirstThoseWhoseVerticesAreThere) {
    for (const std::string encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const Strip whole = strip(encoding, true);
        read(whole.bytes.substr(0, whole.vertex_ends[7]), kSalvage);  // 8 vertices
        EXPECT_EQ(triangles(), 6u) << encoding;
        EXPECT_EQ(lost(mesh::kDamagedFaces), kFaceCount - 6);
        EXPECT_EQ(lost(lost::cut_off), kVertexCount - 8);
        EXPECT_THAT(refusal(whole.bytes.substr(0, whole.vertex_ends[7])), HasSubstr("6 whole triangles"));
    }
}

TEST_F(MeshSalvage, OfADamagedPlyTheFacesWhoseNumbersAndVerticesMakeSense) {
    const Strip whole = strip("ascii");
    std::string bytes = whole.bytes;
    bytes[whole.face_ends[2]] = 'x';     // the fourth face
    bytes[whole.vertex_ends[12]] = 'y';  // the last vertex, which only the last face needs
    EXPECT_THAT(refusal(bytes), AllOf(HasSubstr("vertex 14 has 'y"), HasSubstr("10 whole triangles")));
    read(bytes, kSalvage);
    EXPECT_EQ(triangles(), kFaceCount - 2);
    EXPECT_EQ(lost(mesh::kDamagedFaces), 1u);
    EXPECT_EQ(lost(lost::damaged), 1u);

    Strip binary = strip("binary_little_endian");
    binary.bytes[binary.face_ends[4] + 4] = '\x7f';  // the high byte of an index
    EXPECT_THAT(refusal(binary.bytes),
                AllOf(HasSubstr("face 6 names vertex"), HasSubstr("11 whole triangles")));
    read(binary.bytes, kSalvage);
    EXPECT_EQ(triangles(), kFaceCount - 1);
}

TEST_F(MeshSalvage, OfASoundMeshIsTheMesh) {
    for (const std::string& bytes :
         {strip("ascii").bytes, std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")}) {
        read(bytes, kUsual);
        const auto usual = records_.bytes;
        read(bytes, kSalvage);
        EXPECT_TRUE(records_.bytes == usual);
        EXPECT_TRUE(survey(*source_)->losses.empty());
    }
}

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 3\n";

TEST_F(MeshSalvage, AnObjWhoseLastLineIsHalfAStatementIsCutOff) {
    for (const char* half : {"f", "f 2", "f 2 4", "f 2/1 4/1 3/", "f 2//1 4//1 3", "f 2/1/1 4/1/1 3/1",
                             "f 2 4 3/", "f 2 4 -", "v 0 1", "v 0 1 -", "vn 0", "vt", "f 2 \\\n 4"}) {
        const std::string bytes = kObj + half;
        if (std::string_view(half) == "f 2 4 3/") {  // a slash without a number after it means nothing
            read(bytes, kUsual);
            EXPECT_EQ(triangles(), 2u);
            continue;
        }
        EXPECT_THAT(refusal(bytes),
                    AllOf(HasSubstr("ends early"), HasSubstr("no line end; 1 whole triangle, about")))
            << half;
        read(bytes, kSalvage);
        EXPECT_EQ(triangles(), 1u) << half;
        EXPECT_EQ(lost(mesh::kCutLine), 1u) << half;
    }
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1";
    EXPECT_THAT(refusal(vertices), HasSubstr("2 points can be saved with --salvage"));
    read(vertices, kSalvage);
    EXPECT_EQ(points(), 2u);
}

TEST_F(MeshSalvage, AnObjWhoseLastLineIsWholeNeedsNoLineEnd) {
    for (const char* last :
         {"f 2 4 3", "f 2/1 4/1 3/1", "f 2//1 4//1 3//1", "v 0 1 2", "vn 0 0 1", "vt 0.5", "#", "o a"}) {
        read(kObj + last, kUsual);
        EXPECT_TRUE(is_mesh()) << last;
        EXPECT_TRUE(survey(*source_)->losses.empty()) << last;
    }
}

TEST_F(MeshSalvage, LinesOfAnObjThatMakeNoSenseKeepTheirNumber) {
    const std::string bytes =
        "v 0 0 0\nv 1 x 0\nv 0 1 0\nvn 0 x 1\nvn 0 1 0\nvt z\nf 1 2 3\nv 1 0 0\nf 1 4 9\nf 1//2 4//2 3//2\n";
    EXPECT_THAT(refusal(bytes), AllOf(HasSubstr("line 2 has 'x' for a number"), Not(HasSubstr("ends early")),
                                      HasSubstr("1 whole triangle, about")));
    read(bytes, kSalvage);
    EXPECT_EQ(triangles(), 1u);
    EXPECT_EQ(lost(mesh::kDamagedLines), 4u);
    ASSERT_GT(points(), 0u);
    EXPECT_EQ(value(0, "normal", 1), 1) << "the second of its normals";
}

TEST_F(MeshSalvage, OfAPolygonThatLostACornerNothingIsLeft) {
    // The rest of its outline would be a different polygon: here a triangle over what was outside.
    const std::string before = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv ", after = " 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    for (const char* lost : {"nan", "1e40"}) {
        read(before + lost + after, kUsual);
        EXPECT_FALSE(is_mesh()) << lost;
    }
    EXPECT_THAT(refusal(before + "x" + after), HasSubstr("4 points can be saved with --salvage"));
    read(before + "3" + after, kUsual);
    EXPECT_EQ(triangles(), 3u);
}

TEST_F(MeshSalvage, ChangedBytesNeverCrash) {
    const std::array<std::string, 3> seeds = {strip("ascii").bytes, strip("binary_big_endian", true).bytes,
                                              kObj + "f 1/1/1 -2//1 3/1 4\nf -1 \\\n 1 2\n"};
    size_t saved = 0;
    for (uint64_t round = 0; round < 3000; ++round) {
        std::string bytes = seeds[round % seeds.size()];
        bytes.resize(bytes.size() - mix64(round, 3) % (bytes.size() / 2));
        for (uint64_t k = 0; k < round % 3; ++k)
            bytes[mix64(round, k) % bytes.size()] = "0123456789-/. \nefvx"[mix64(round, k + 9) % 19];
        saved += try_read(bytes, kSalvage).has_value();
    }
    EXPECT_GT(saved, 1000u);
}

}  // namespace
}  // namespace lucarne::io
