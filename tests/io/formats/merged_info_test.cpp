// The coordinate system, types and stations of a file with the points of several scans.
#include "io/formats/merged_info.h"

#include <gmock/gmock.h>

#include "io/formats/las/extras.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

std::string system(int epsg) {
    return "PROJCS[\"system " + std::to_string(epsg) + "\",UNIT[\"foot\",0.3048],AUTHORITY[\"EPSG\",\"" +
           std::to_string(epsg) + "\"]]";
}

class MergedInfo : public ::testing::Test {
 protected:
    /// Returns a LAS file of one point, with or without a coordinate system.
    ScanInfo las(const std::string& name, int epsg) const {
        testing::LasFile file;
        file.minor = 4;
        file.encoding = 16;
        file.format = 6;
        file.records = {testing::record6(1, 2, 3, 0, 0x11, 0, 0, 0, 0, 0, 0)};
        if (epsg) file.add_vlr("LASF_Projection", 2112, system(epsg));
        return read(name, file.bytes());
    }
    /// Returns a LAS file with a scaled extra. A scale of 0 means not scaled; a negative one means no extra.
    ScanInfo scaled(const std::string& name, double scale, uint8_t type = 4) const {
        testing::LasFile file;
        file.records = {testing::record0(1, 2, 3)};
        if (scale < 0) return read(name, file.bytes());
        std::string entry = testing::extra_descriptor(type, "Amplitude", scale > 0 ? 8 : 0);
        testing::put(entry, 112, scale);
        file.add_vlr("LASF_Spec", 4, entry);
        file.records[0] += std::string(type <= 2 ? 1 : 2, '\1');
        return read(name, file.bytes());
    }
    static Schema amplitude() {
        Schema schema;
        schema.position = PositionType::i32_scaled;
        schema.stride = 12;
        schema.add("Amplitude", ScalarType::i16);
        return schema;
    }
    /// Returns the scale in a file that is written with the merged information; 0 if there is none.
    double scale_of(std::span<const ScanInfo> scans) const {
        const Schema schema = amplitude();
        const auto writer = create_scan(folder_ / "s.las", schema, merged_info(scans), {.overwrite = true});
        EXPECT_TRUE(writer && (*writer)->write(std::vector<std::byte>(14)) && (*writer)->finish());
        const auto file = InputFile::open(folder_ / "s.las");
        const auto header = las::read_header(*file);
        const auto& entry = header->find(las::kSpecUser, las::kExtraBytesRecord)->data;
        return (load<uint8_t>(&entry[3]) & 8) ? load<double>(&entry[112]) : 0.0;
    }
    ScanInfo text(const std::string& name) const { return read(name, "1 2 3\n4 5 6\n"); }
    /// Writes a file with the merged information and returns what it says.
    ScanInfo written(std::span<const ScanInfo> scans, const std::string& name) const {
        Schema schema;
        schema.position = PositionType::i32_scaled;
        schema.stride = 12;
        ScanInfo info = merged_info(scans);
        const auto writer = create_scan(folder_ / name, schema, info, {.overwrite = true});
        EXPECT_TRUE(writer) << writer.error().line();
        EXPECT_TRUE((*writer)->write(std::vector<std::byte>(12)) && (*writer)->finish());
        const auto scan = open_scan(folder_ / name);
        return scan ? (*scan)->info() : ScanInfo{};
    }

 private:
    ScanInfo read(const std::string& name, const std::string& bytes) const {
        testing::write_bytes(folder_ / name, bytes);
        const auto scan = open_scan(folder_ / name);
        if (!scan) ADD_FAILURE() << scan.error().line();
        return scan ? (*scan)->info() : ScanInfo{};
    }
    const testing::TemporaryFolder folder_;
};

TEST_F(MergedInfo, ASystemThatAllScansHaveIsKept) {
    const std::array scans = {las("a.las", 2903), las("b.las", 2903)};
    EXPECT_EQ(different_systems(scans), "");
    EXPECT_EQ(merged_info(scans).notes.system_note, "");
    for (const char* name : {"m.las", "m.laz"}) EXPECT_EQ(written(scans, name).epsg, 2903u);
}

TEST_F(MergedInfo, SystemsThatDifferLeaveNoneAndAreNamedWithTheirFiles) {
    const std::array scans = {las("a.las", 2903), las("b.las", 2904)};
    const std::string differ = different_systems(scans);
    for (const char* part : {"a.las", "b.las", "EPSG:2903", "EPSG:2904"})
        EXPECT_THAT(differ, HasSubstr(part));
    EXPECT_NE(merged_info(scans).notes.system_note, "");
    const ScanInfo merged = written(scans, "m.las");
    EXPECT_EQ(merged.epsg, 0u);
    EXPECT_DOUBLE_EQ(merged.metres_per_unit, 0.3048);  // the unit on which they agree
}

TEST_F(MergedInfo, AScanThatSaysNothingTakesTheSystemOfTheOthersWithANote) {
    for (const bool first : {false, true}) {
        std::array scans = {las("a.las", 2903), text("b.xyz")};
        scans[1].metres_per_unit = 0.3048;  // as with --unit ft
        if (first) std::swap(scans[0], scans[1]);
        EXPECT_EQ(different_systems(scans), "");
        EXPECT_THAT(merged_info(scans).notes.system_note, HasSubstr("b.xyz has no coordinate system"));
        for (const char* name : {"m.las", "m.laz"}) EXPECT_EQ(written(scans, name).epsg, 2903u) << first;
    }
}

TEST_F(MergedInfo, AScanThatWasWrittenWithItsUnitAloneTakesTheSystemOfTheOthers) {
    auto feet = text("f.xyz");
    feet.metres_per_unit = 0.3048;
    const auto unit_only = written(std::array{feet}, "f.las");
    EXPECT_EQ(unit_only.metres_per_unit, 0.3048);
    const std::array scans = {unit_only, las("a.las", 2903)};
    EXPECT_EQ(different_systems(scans), "");
    for (const char* name : {"m.las", "m.laz"}) EXPECT_EQ(written(scans, name).epsg, 2903u);
    EXPECT_EQ(written(std::array{unit_only, feet}, "m.las").metres_per_unit, 0.3048);
}

TEST_F(MergedInfo, TheSystemOfAnE57IsWellKnownTextInLas) {
    ScanInfo e57;
    e57.format = "E57 1.0, 1 scan";
    e57.notes.e57 = {.coordinate_system = system(25832)};
    e57.metres_per_unit = 0.3048;
    const std::array one = {e57};
    for (const char* name : {"m.las", "m.laz"}) EXPECT_EQ(written(one, name).epsg, 25832u) << name;
    e57.notes.e57->coordinate_system = "nothing that is well known";
    const std::array none = {e57};
    EXPECT_EQ(written(none, "m.las").epsg, 0u);
}

TEST_F(MergedInfo, ExtraBytesKeepTheirScaleWhicheverScanHasThem) {
    const auto none = scaled("none.las", -1), a = scaled("a.las", .01), b = scaled("b.las", .01),
               c = text("c.xyz");
    for (const auto& scans : {std::vector{a, b}, {none, a}, {a, none}, {c, a}, {a, c}, {none, none, b}}) {
        EXPECT_EQ(different_extras(scans), "");
        EXPECT_EQ(scale_of(scans), .01) << scans[0].path << " " << scans[1].path;
        EXPECT_EQ(las::scaled_extras(merged_info(scans), amplitude()), "'Amplitude' * 0.01 + 0");
    }
}

TEST_F(MergedInfo, ExtraBytesThatAreScaledInTwoWaysAreNamedAndLeftAsTheyStand) {
    const auto a = scaled("a.las", .01), b = scaled("b.las", .001), plain = scaled("p.las", 0);
    for (const auto& scans :
         {std::vector{a, b}, {a, plain}, {plain, a}, {a, b, a}, {a, scaled("n.las", .01, 2)}}) {
        EXPECT_THAT(different_extras(scans), HasSubstr("'Amplitude' has another scale"));
        EXPECT_THAT(different_extras(scans), HasSubstr(scans[1].path));
        EXPECT_NE(merged_info(scans).notes.extras_note, "");
        EXPECT_EQ(scale_of(scans), 0) << scans[1].path;
        EXPECT_EQ(las::scaled_extras(merged_info(scans), amplitude()), "");
    }
}

TEST_F(MergedInfo, LimitsOfIntensitiesHoldForAllScansOrForNone) {
    std::array<ScanInfo, 2> scans;
    scans[0].notes.intensity_limits = {0, 1, true};
    scans[1].notes.intensity_limits = {-5, 0.5};
    EXPECT_EQ(merged_info(scans).notes.intensity_limits, (IntensityLimits{-5, 1}));
    scans[1].notes.intensity_limits.reset();
    EXPECT_FALSE(merged_info(scans).notes.intensity_limits);
}

TEST_F(MergedInfo, StationsOfAllScansAreKept) {
    std::array scans = {text("a.xyz"), text("b.xyz")};
    for (ScanInfo& scan : scans) scan.stations = {{1, {1, 2, 3}}};
    EXPECT_EQ(merged_info(scans).stations.size(), 2u);
    EXPECT_TRUE(merged_info({}).stations.empty());
}

}  // namespace
}  // namespace lucarne::io
