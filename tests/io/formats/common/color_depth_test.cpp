#include "io/formats/common/color_depth.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "tests/io/formats/e57/e57_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the builder's small functions

class ColourDepth : public ::testing::Test {
 protected:
    std::unique_ptr<PointSource> opened(const std::filesystem::path& path) {
        auto source = open_scan(path);
        if (!source) ADD_FAILURE() << source.error().line();
        return source ? std::move(*source) : nullptr;
    }
    std::unique_ptr<PointSource> opened(const std::string& name, std::string_view bytes) {
        write_bytes(folder_ / name, bytes);
        return opened(folder_ / name);
    }
    /// Returns the largest colour component of a LAS file with these points.
    double largest_in_las(const PointSource& source) {
        const auto path = folder_ / "exported.las";
        WriteOptions options;
        options.overwrite = true;
        const auto writer = create_scan(path, source.schema(), source.info(), options);
        const auto all = read_all(source);
        if (!writer || !all || !(*writer)->write(all->bytes) || !(*writer)->finish()) {
            ADD_FAILURE() << "not written";
            return 0;
        }
        const auto las = opened(path);
        const Attribute* color = las->schema().find(names::color);
        const auto records = read_all(*las);
        double largest = 0;
        for (size_t i = 0; i < records->count; ++i)
            for (size_t c = 0; c < 3; ++c)
                largest = std::max<double>(
                    largest,
                    load<uint16_t>(&records->bytes[i * las->schema().stride + color->offset + 2 * c]));
        return largest;
    }
    static std::string ply(const std::string& type, const std::vector<std::array<double, 3>>& colors) {
        std::string text = fmt::format(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
            "z\n",
            colors.size());
        for (const char* name : {"red", "green", "blue"}) text += fmt::format("property {} {}\n", type, name);
        text += "end_header\n";
        for (size_t i = 0; i < colors.size(); ++i)
            text += fmt::format("{} 0 1 {} {} {}\n", i, colors[i][0], colors[i][1], colors[i][2]);
        return text;
    }
    const TemporaryFolder folder_;
};

TEST_F(ColourDepth, FollowsTheValuesWhateverTheTypeOfTheField) {
    for (const char* type : {"ushort", "short", "int", "uint"}) {
        const auto narrow = opened("n.ply", ply(type, {{255, 7, 0}, {1, 2, 3}}));
        EXPECT_EQ(narrow->info().color_bits, 8u) << type;
        ASSERT_TRUE(narrow->schema().find(names::color)) << type;
        EXPECT_EQ(largest_in_las(*narrow), 65535) << type;
        const auto wide = opened("w.ply", ply(type, {{256, 7, 0}, {32000, 2, 3}}));
        EXPECT_EQ(wide->info().color_bits, 16u) << type;
        EXPECT_EQ(largest_in_las(*wide), 32000) << type;
    }
    for (const char* type : {"float", "double"}) {
        EXPECT_EQ(opened("u.ply", ply(type, {{.5, 1, 0}}))->info().color_bits, 0u) << type;
        EXPECT_EQ(opened("b.ply", ply(type, {{.5, 255, 0}}))->info().color_bits, 8u) << type;
        EXPECT_EQ(opened("s.ply", ply(type, {{.5, 4000, 0}}))->info().color_bits, 16u) << type;
    }
    // Mixed widths are one colour; values out of range are clamped.
    const auto mixed = opened("m.ply", ply("int", {{-1, 70000, 12}}));
    const auto all = read_all(*mixed);
    const auto offset = mixed->schema().find(names::color)->offset;
    EXPECT_EQ(load<uint16_t>(&all->bytes[offset]), 0);
    EXPECT_EQ(load<uint16_t>(&all->bytes[offset + 2]), 65535);
    EXPECT_EQ(load<uint16_t>(&all->bytes[offset + 4]), 12);
}

TEST_F(ColourDepth, OfPcdFieldsFollowsTheValuesToo) {
    const auto pcd = [](const std::string& type, const std::string& rows) {
        return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z r g b\nSIZE 4 4 4 4 4 4\nTYPE F F F " + type + " " +
               type + " " + type + "\nCOUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n" + rows;
    };
    EXPECT_EQ(opened("i.pcd", pcd("I", "0 0 0 1 2 255\n1 0 0 3 4 5\n"))->info().color_bits, 8u);
    EXPECT_EQ(opened("u.pcd", pcd("U", "0 0 0 1 2 256\n1 0 0 3 4 5\n"))->info().color_bits, 16u);
    EXPECT_EQ(opened("f.pcd", pcd("F", "0 0 0 1 0 .5\n1 0 0 0 1 1\n"))->info().color_bits, 0u);
    EXPECT_EQ(opened("g.pcd", pcd("F", "0 0 0 1 0 .5\n1 0 0 0 200 1\n"))->info().color_bits, 8u);
}

TEST_F(ColourDepth, OfE57IsThatOfTheLimitsElseOfTheValues) {
    const auto e57 = [](int64_t declared, uint64_t largest, const std::string& limits) {
        std::vector<std::string> streams;
        std::string fields = kXyzFields;
        const unsigned bits = declared > 255 ? 16 : 8;
        for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
            BitStream stream{bits};
            stream.add(uint64_t{3});
            stream.add(largest);
            streams.push_back(stream.bytes);
            fields += integer_field(name, 0, declared);
        }
        BuiltFile file;
        file.scans.push_back({fields, 2, xyz_packet({{1, 2, 3}, {4, 5, 6}}, streams), limits});
        return file.bytes();
    };
    const std::string limits_of_16 =
        "<colorLimits type=\"Structure\"><colorRedMinimum type=\"Integer\">0</colorRedMinimum>"
        "<colorRedMaximum type=\"Integer\">65535</colorRedMaximum></colorLimits>";
    const auto narrow = opened("n.e57", e57(65535, 255, ""));
    EXPECT_EQ(narrow->info().color_bits, 8u);
    EXPECT_EQ(largest_in_las(*narrow), 65535);
    EXPECT_EQ(opened("w.e57", e57(65535, 256, ""))->info().color_bits, 16u);
    EXPECT_EQ(opened("s.e57", e57(65535, 255, limits_of_16))->info().color_bits, 16u);
    EXPECT_EQ(opened("b.e57", e57(255, 12, ""))->info().color_bits, 8u);
}

TEST_F(ColourDepth, OfASampleIsCorrectedByAPassOverAllPoints) {
    // One bright point that no sample meets.
    constexpr int kPoints = 400'000;
    std::string text = "x,y,z,r,g,b\n";
    for (int i = 0; i < kPoints; ++i)
        text += i == 6400 ? "1.5,2,3,9,40000,9\n" : fmt::format("{}.5,2,3,9,7,{}\n", i, i % 200);
    ASSERT_GT(text.size(), size_t{4} << 20) << "such a file is sampled";
    const auto source = opened("late.csv", text);
    EXPECT_EQ(source->info().color_bits, 8u) << "the sample has met the bright point, move it";
    const auto contents = survey(*source);
    ASSERT_TRUE(contents);
    EXPECT_EQ(contents->color_bits, 16u);
}

TEST_F(ColourDepth, OfALargeTextFileIsThatOfASmallOne) {
    std::string text = "x,y,z,r,g,b\n";
    for (int i = 0; text.size() <= (size_t{4} << 20); ++i)
        text += fmt::format("{}.25,2.5,3,{},7,{}\n", i, i % 256, i % 200);
    const auto source = opened("big.csv", text);
    EXPECT_EQ(source->info().color_bits, 8u);
    EXPECT_EQ(largest_in_las(*source), 65535);
}

TEST_F(ColourDepth, OfReportedFilesIsRight) {
    if (shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    for (const char* name : {"ushort8.ply", "col8_in16_nolimits.e57", "int_colours.ply"}) {
        const auto source = opened(shared_data() / "reports" / name);
        ASSERT_TRUE(source) << name;
        EXPECT_EQ(source->info().color_bits, 8u) << name;
        ASSERT_TRUE(source->schema().find(names::color)) << name;
        EXPECT_EQ(static_cast<int>(largest_in_las(*source)) % 257, 0) << name;
        EXPECT_GT(largest_in_las(*source), 255) << name;
    }
}

}  // namespace
}  // namespace lucarne::io
