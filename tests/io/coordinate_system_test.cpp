// What a coordinate system is called, and its unit, from well-known text and GeoTIFF keys.
#include "io/formats/wkt.h"
#include "tests/io/io_testing.h"
#include "tests/io/las_builder.h"

namespace lucarne::io {
namespace {

constexpr const char* kUtm =
    R"(PROJCS["NAD83 / UTM zone 17N",GEOGCS["NAD83",DATUM["D",SPHEROID["GRS 1980",6378137,298.257,AUTHORITY["EPSG","7019"]]],UNIT["degree",0.01745,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4269"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","26917"]])";

TEST(CoordinateSystem, OfWellKnownTextIsItsOutermostNameAndCode) {
    const auto utm = wkt_system(kUtm);
    EXPECT_EQ(utm.name, "NAD83 / UTM zone 17N");
    EXPECT_EQ(utm.epsg, 26917u);
    EXPECT_EQ(wkt_metres_per_unit(kUtm), 1.0);
    const auto swiss = wkt_system(
        R"(PROJCRS["CH1903+ / LV95",BASEGEODCRS["CH1903+",ID["EPSG",4150]],CS[Cartesian,2],LENGTHUNIT["metre",1],ID["EPSG",2056]])");
    EXPECT_EQ(swiss.name, "CH1903+ / LV95");
    EXPECT_EQ(swiss.epsg, 2056u);
}

TEST(CoordinateSystem, OfACompoundWithoutACodeHasThatOfItsHorizontalPart) {
    const std::string compound = std::string("COMPD_CS[\"NAD83 / UTM zone 17N + NAVD88\",") + kUtm +
                                 R"(,VERT_CS["NAVD88 height",AUTHORITY["EPSG","5703"]]])";
    EXPECT_EQ(wkt_system(compound).name, "NAD83 / UTM zone 17N + NAVD88");
    EXPECT_EQ(wkt_system(compound).epsg, 26917u);
    // But one that only lacks its own is not its base.
    EXPECT_EQ(wkt_system(R"(PROJCS["mine",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]])").epsg, 0u);
}

TEST(CoordinateSystem, OfUtmZonesIsTextThatSaysTheirCodeAndMeridian) {
    for (const uint32_t code : {32601u, 32633u, 32660u, 32701u, 32760u, 25828u, 25838u, 26901u, 26923u}) {
        const auto wkt = utm_wkt(code);
        ASSERT_TRUE(wkt) << code;
        EXPECT_EQ(wkt_system(*wkt).epsg, code);
        EXPECT_EQ(wkt_metres_per_unit(*wkt), 1.0);
    }
    EXPECT_NE(utm_wkt(32633)->find(R"(["central_meridian",15])"), std::string::npos);
    EXPECT_NE(utm_wkt(32733)->find(R"(["false_northing",10000000])"), std::string::npos);
    EXPECT_EQ(wkt_system(*utm_wkt(25832)).name, "ETRS89 / UTM zone 32N");
    for (const uint32_t code : {0u, 2903u, 32600u, 32661u, 32700u, 32761u, 25827u, 25839u, 26900u, 26924u})
        EXPECT_FALSE(utm_wkt(code)) << code;
}

TEST(CoordinateSystem, OfAnyBytesIsNoHarm) {
    for (std::string text = kUtm; !text.empty(); text.pop_back()) {
        wkt_system(text);
        wkt_metres_per_unit(text);
    }
    EXPECT_EQ(wkt_system(std::string(100000, '[')).name, "");
    std::string brackets;  // of a size that nothing but time in proportion gets through
    for (int i = 0; i < 4'000'000; ++i) brackets += "UNIT[]";
    EXPECT_FALSE(wkt_metres_per_unit("PROJCS[" + brackets));
    EXPECT_EQ(wkt_system("PROJCS[" + brackets).name, "");
    EXPECT_EQ(wkt_system("PROJCS[\"a\n\x01\xff\"]").name, "a???");
    EXPECT_EQ(wkt_system(R"(PROJCS["a",AUTHORITY["EPSG","99999999999"]])").epsg, 0u);
}

void add_keys(testing::LasFile& las, const std::vector<std::array<uint16_t, 4>>& keys) {
    std::string directory;
    for (const uint16_t head : {uint16_t{1}, uint16_t{1}, uint16_t{0}, static_cast<uint16_t>(keys.size())})
        testing::append(directory, head);
    for (const auto& key : keys)
        for (const uint16_t number : key) testing::append(directory, number);
    las.add_vlr("LASF_Projection", 34735, directory);
}

TEST(CoordinateSystem, OfGeoTiffKeysIsTheirCodeAndCitation) {
    testing::LasFile las;
    las.records = {testing::record0(1, 2, 3)};
    add_keys(las, {{1024, 0, 1, 1}, {1026, 34737, 8, 0}, {3072, 0, 1, 2992}, {3073, 34737, 21, 8}, {3076, 0, 1, 9002}});
    las.add_vlr("LASF_Projection", 34737, "general|NAD83 / Oregon (ft)|");
    const testing::MemoryFile file;
    file.set(las.bytes());
    const auto scan = open_scan(file.path());
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_EQ((*scan)->info().coordinate_system, "NAD83 / Oregon (ft)");
    EXPECT_EQ((*scan)->info().epsg, 2992u);
    EXPECT_EQ((*scan)->info().metres_per_unit, 0.3048);
}

TEST(CoordinateSystem, OfGeoTiffKeysThatPointOutsideTheirTextsIsUnknown) {
    testing::LasFile las;
    las.records = {testing::record0(1, 2, 3)};
    add_keys(las, {{1024, 0, 1, 2}, {2048, 0, 1, 32767}, {2049, 34737, 65535, 60000}, {1026, 34737, 9, 3}});
    las.add_vlr("LASF_Projection", 34737, "abc");
    const testing::MemoryFile file;
    file.set(las.bytes());
    const auto scan = open_scan(file.path());
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_EQ((*scan)->info().coordinate_system, "");
    EXPECT_EQ((*scan)->info().epsg, 0u);
}

}  // namespace
}  // namespace lucarne::io
