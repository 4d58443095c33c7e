// A file's content tells its format, whatever stands before it; if it does not, the name does.
#include <gmock/gmock.h>

#include "io/formats/common/format.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Registry : public testing::TextScan {
 protected:
    Result<std::unique_ptr<PointSource>> open(const std::string& name, const std::string& bytes) const {
        testing::write_bytes(folder_ / name, bytes);
        return open_scan(folder_ / name, {.columns = "", .quiet = true, .mesh = {.spacing = 0.1}});
    }
    const testing::TemporaryFolder folder_;
};

const std::string kMark = "\xef\xbb\xbf";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kPcd =
    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
    "1 2 3\n4 5 6\n";
const std::string kPtx =
    "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 .5\n4 5 6 .5\n";
const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
    "end_header\n1 2 3\n4 5 6\n";

TEST_F(Registry, AByteOrderMarkIsPassedOver) {
    for (const auto& [text, format] :
         {std::pair(kObj, "OBJ"), std::pair(kPcd, "PCD"), std::pair(kPtx, "PTX"), std::pair(kPly, "PLY"),
          std::pair(std::string("1 2 3\n4 5 6\n"), "XYZ")}) {
        read(kMark + text, {.columns = "", .quiet = true, .mesh = {.spacing = 0.1}});
        ASSERT_TRUE(source_) << format;
        EXPECT_THAT(source_->info().format, StartsWith(format));
        EXPECT_GE(points(), 2u) << format;
    }
}

TEST_F(Registry, CommentsBeforeAHeaderOfPcdDoNotMatter) {
    for (const std::string comment : {"# made by hand\n", "#\n\n# .PCD v.7\n", "# .PCD v.7\r\n"}) {
        read(comment + kPcd);
        ASSERT_TRUE(source_) << comment;
        EXPECT_THAT(source_->info().format, StartsWith("PCD"));
        EXPECT_EQ(points(), 2u);
    }
}

TEST_F(Registry, AHeaderOfRowsIsNoStatementOfObj) {
    for (const std::string rows : {"v x y z\n9 1 2 3\n", "s x y z\n9 1 2 3\n", "l x y z\n9 1 2 3\n"}) {
        const auto scan = open("a.txt", rows);
        ASSERT_TRUE(scan) << scan.error().line();
        EXPECT_THAT((*scan)->info().format, StartsWith("XYZ"));
    }
    for (const std::string first : {"s off\n", "s 1\n", "o a\n", "vn 0 0 1\n", "vt .5 .5\n", "v -1 0 0\n"}) {
        const auto scan = open("a", first + kObj);
        ASSERT_TRUE(scan) << scan.error().line();
        EXPECT_THAT((*scan)->info().format, StartsWith("OBJ"));
    }
}

TEST_F(Registry, WhereTheContentSaysNothingTheExtensionDoes) {
    std::string comments;
    while (comments.size() < 10'000) comments += "# a long licence in front of everything\n";
    const auto obj = open("a.OBJ", comments + kObj);
    ASSERT_TRUE(obj) << obj.error().line();
    EXPECT_THAT((*obj)->info().format, StartsWith("OBJ"));
    const auto pcd = open("a.pcd", comments + kPcd);
    ASSERT_TRUE(pcd) << pcd.error().line();
    EXPECT_THAT((*pcd)->info().format, StartsWith("PCD"));
    const auto csv = open("a.csv", std::string("# \0\n", 4) + "x,y,z\n1,2,3\n");
    ASSERT_TRUE(csv) << csv.error().line();
}

TEST_F(Registry, TheErrorIsThatOfTheFormatThatTheExtensionNames) {
    const std::string zeros(5000, '\0');
    for (const std::string extension : {".las", ".laz", ".e57", ".ply"})
        for (const std::string& bytes : {zeros, std::string("What is this?")})
            EXPECT_THAT(open("a" + extension, bytes).error().line(),
                        HasSubstr("is named " + extension + " and has no such header"));
    EXPECT_THAT(open("a.pcd", zeros).error().line(), HasSubstr("PCD"));
    EXPECT_THAT(open("a.pcd", "# nothing\n").error().line(), HasSubstr("its PCD header ends without"));
    EXPECT_THAT(open("a.dat", zeros).error().line(), HasSubstr("has an unrecognised format"));
    EXPECT_THAT(open("a.las", "\x89PNG" + zeros).error().line(), HasSubstr("is an image, not a scan"));
    EXPECT_THAT(open("a.obj", zeros).error().line(), HasSubstr("is no OBJ"));
    EXPECT_THAT(open("a.obj", "hello, this is no mesh\n").error().line(), HasSubstr("is no OBJ"));
    EXPECT_THAT(open("a.obj", "1 2 3\n4 5 6\n").error().line(),
                HasSubstr("if it holds rows of numbers, say what they are with --columns"));
}

TEST_F(Registry, OfAFileNamedJsonTheMistakeIsTold) {
    EXPECT_THAT(open("a.json", "{\"version\": 1, \"scans\": [\"a").error().line(),
                HasSubstr("a.json: line 1, column "));
    EXPECT_THAT(open("a.json", "{\"version\": \xff\xfe}").error().line(),
                HasSubstr("a.json: line 1, column "));
    EXPECT_THAT(open("a.json", std::string(5000, '[')).error().line(), HasSubstr("a.json: "));
    EXPECT_THAT(open("a.json", "{}").error().line(), HasSubstr("a.json: is no scan"));
    for (const std::string& text : {std::string("{\"a"), std::string(5000, '['), std::string(200, '\0')})
        EXPECT_THAT(open("a.json", text).error().line(), ::testing::Not(HasSubstr("unrecognised"))) << text;
    EXPECT_TRUE(open("a.json", "1 2 3\n4 5 6\n")) << "rows of numbers are a scan, whatever their name";
}

TEST(UniqueName, HasTheFirstNumberThatIsFree) {
    Schema schema;
    EXPECT_EQ(unique_name(schema, "a"), "a");
    for (const char* name : {"a", "a_2", "a_4", "a_03", "a_+3", "a_3x", "a_", "ab"})
        schema.add(name, ScalarType::u8);
    EXPECT_EQ(unique_name(schema, "a"), "a_3");
    EXPECT_EQ(unique_name(schema, "b"), "b");
    EXPECT_EQ(unique_name(schema, "a_2"), "a_2_2");
    // Thousands of equal names.
    Schema many;
    for (int i = 0; i < 3000; ++i) many.add(unique_name(many, std::string(64, 'n')), ScalarType::u8);
    EXPECT_EQ(many.attributes.back().name, std::string(64, 'n') + "_3000");
}

TEST_F(Registry, FormatsOfOthersAreNamed) {
    std::string stl(84 + 50, '\0');
    stl.replace(0, 5, "solid");
    stl[80] = 1;
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"solid x\n facet normal 0 0 1\n  outer loop\n", "STL"},
        {stl, "STL"},
        {"ncols 8\nnrows 6\nxllcorner 412000.0\nyllcorner 5318000.0\ncellsize 1.0\n104.4 103.5 101.6\n",
         "raster"},
        {"\x1f\x8b\x08 and more", "gunzip"},
        {"PK\x03\x04 and more", "zip"}};
    for (const auto& [bytes, word] : cases)
        for (const char* name : {"a.txt", "a.stl", "a.asc", "a.ply.gz", "a"}) {
            const auto scan = open(name, bytes);
            ASSERT_FALSE(scan) << name << word;
            EXPECT_EQ(scan.error().kind, ErrorKind::input_rejected);
            EXPECT_THAT(scan.error().line(), HasSubstr(word)) << name;
        }
}

}  // namespace
}  // namespace lucarne::io
