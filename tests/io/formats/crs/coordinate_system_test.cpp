// The name and unit of a coordinate system, from well-known text and GeoTIFF keys.
#include "io/files/file.h"
#include "io/formats/crs/registry.h"
#include "io/formats/las/crs.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

constexpr const char* kUtm =
    R"(PROJCS["NAD83 / UTM zone 17N",GEOGCS["NAD83",DATUM["D",SPHEROID["GRS 1980",6378137,298.257,AUTHORITY["EPSG","7019"]]],UNIT["degree",0.01745,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4269"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","26917"]])";

TEST(CoordinateSystem, OfWellKnownTextIsItsOutermostNameAndCode) {
    const auto utm = wkt_system(kUtm);
    EXPECT_EQ(utm.name, "NAD83 / UTM zone 17N");
    EXPECT_EQ(utm.epsg, 26917u);
    EXPECT_EQ(wkt_units(kUtm).horizontal, 1.0);
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
    // But a system that only lacks its own code does not take that of its base.
    EXPECT_EQ(wkt_system(R"(PROJCS["mine",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]])").epsg, 0u);
}

TEST(CoordinateSystem, OfUtmZonesIsTextThatSaysTheirCodeAndMeridian) {
    for (const uint32_t code : {32601u, 32633u, 32660u, 32701u, 32760u, 25828u, 25838u, 26901u, 26923u}) {
        const auto wkt = utm_wkt(code);
        ASSERT_TRUE(wkt) << code;
        EXPECT_EQ(wkt_system(*wkt).epsg, code);
        EXPECT_EQ(wkt_units(*wkt).horizontal, 1.0);
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
        wkt_units(text);
    }
    EXPECT_EQ(wkt_system(std::string(100000, '[')).name, "");
    std::string brackets;  // so many that only an algorithm of linear time can read them
    for (int i = 0; i < 4'000'000; ++i) brackets += "UNIT[]";
    EXPECT_FALSE(wkt_units("PROJCS[" + brackets).horizontal);
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
    add_keys(
        las,
        {{1024, 0, 1, 1}, {1026, 34737, 8, 0}, {3072, 0, 1, 2992}, {3073, 34737, 21, 8}, {3076, 0, 1, 9002}});
    las.add_vlr("LASF_Projection", 34737, "general|NAD83 / Oregon (ft)|");
    const testing::MemoryFile file;
    file.set(las.bytes());
    const auto scan = open_scan(file.path());
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_EQ((*scan)->info().coordinate_system, "NAD83 / Oregon (ft)");
    EXPECT_EQ((*scan)->info().epsg, 2992u);
    EXPECT_EQ((*scan)->info().metres_per_unit, 0.3048);
}

/// Returns the units of a header with these keys.
las::Units units_of_keys(const std::vector<std::array<uint16_t, 4>>& keys) {
    testing::LasFile las;
    las.records = {testing::record0(1, 2, 3)};
    add_keys(las, keys);
    const testing::MemoryFile file;
    file.set(las.bytes());
    return las::units_of(*las::read_header(*InputFile::open(file.path())));
}

TEST(CoordinateSystem, OfKeysWithoutAUnitCountsInThatOfItsCode) {
    const std::pair<uint16_t, double> systems[] = {
        {2230, 1200.0 / 3937}, {2992, 0.3048}, {32633, 1.0}, {27700, 1.0}, {2222, 0.3048}};
    for (const auto& [code, metres] : systems) {
        const auto units = units_of_keys({{1024, 0, 1, 1}, {3072, 0, 1, code}});
        EXPECT_DOUBLE_EQ(units.metres(), metres) << code;
        EXPECT_EQ(units.unknown, "") << code;
    }
    // The key takes precedence over the registry, which knows more units than the usual ones: yards, links.
    EXPECT_EQ(units_of_keys({{3072, 0, 1, 32633}, {3076, 0, 1, 9002}}).metres(), 0.3048);
    EXPECT_EQ(units_of_keys({{3072, 0, 1, 32767}, {3076, 0, 1, 9002}}).metres(), 0.3048);
    EXPECT_DOUBLE_EQ(units_of_keys({{3072, 0, 1, 32767}, {3076, 0, 1, 9096}}).metres(), 0.9144);
}

TEST(CoordinateSystem, WhoseUnitNobodyKnowsSaysSo) {
    EXPECT_NE(units_of_keys({{1024, 0, 1, 1}, {3072, 0, 1, 60000}}).unknown, "");
    EXPECT_NE(units_of_keys({{3072, 0, 1, 32633}, {3076, 0, 1, 1}}).unknown, "");
    EXPECT_NE(units_of_keys({{3072, 0, 1, 32767}}).unknown, "");
    EXPECT_NE(units_of_keys({{3072, 0, 1, 32633}, {3076, 0, 1, 9102}}).unknown, "")
        << "a degree is no length";
    EXPECT_EQ(units_of_keys({{3072, 0, 1, 60000}}).metres(), 1.0);
}

TEST(CoordinateSystem, OfDegreesIsKnownWhateverSaysIt) {
    EXPECT_TRUE(units_of_keys({{1024, 0, 1, 2}, {2048, 0, 1, 4326}}).degrees);
    EXPECT_TRUE(units_of_keys({{2048, 0, 1, 4326}}).degrees);
    EXPECT_FALSE(units_of_keys({{2048, 0, 1, 4326}, {3072, 0, 1, 32633}}).degrees)
        << "the base of a projection";
    EXPECT_TRUE(wkt_units(R"(GEOGCRS["a",CS[ellipsoidal,2]])").degrees);
    EXPECT_TRUE(wkt_units(R"(COMPD_CS["c",GEOGCS["b",UNIT["degree",0.01745]],VERT_CS["v",UNIT["metre",1]]])")
                    .degrees);
    EXPECT_FALSE(wkt_units(kUtm).degrees);
    EXPECT_TRUE(registered_units(4326)->degrees);
}

TEST(CoordinateSystem, HeightsHaveAUnitOfTheirOwn) {
    EXPECT_EQ(units_of_keys({{3072, 0, 1, 32633}, {4099, 0, 1, 9002}}).vertical, 0.3048);
    EXPECT_DOUBLE_EQ(*units_of_keys({{3072, 0, 1, 32633}, {4096, 0, 1, 6360}}).vertical, 1200.0 / 3937);
    EXPECT_FALSE(units_of_keys({{3072, 0, 1, 32633}, {4096, 0, 1, 32767}}).vertical);
    const auto compound = wkt_units(
        R"(COMPD_CS["c",PROJCS["p",GEOGCS["g",UNIT["degree",0.01745]],UNIT["metre",1]],VERT_CS["v",UNIT["foot",0.3048]]])");
    EXPECT_EQ(compound.horizontal, 1.0);
    EXPECT_EQ(compound.vertical, 0.3048);
    const auto registered = registered_units(6349);  // NAD83(2011) + NAVD88 height
    ASSERT_TRUE(registered);
    EXPECT_TRUE(registered->degrees);
    EXPECT_EQ(registered->vertical, 1.0);
}

TEST(CoordinateSystem, OfWellKnownTextIsReadWhateverTheCaseOfItsKeywords) {
    const auto units = wkt_units(R"(projcs["a",geogcs["b",unit["degree",0.01745]],Unit["foot",0.3048]])");
    EXPECT_EQ(units.horizontal, 0.3048);
    EXPECT_EQ(wkt_system(R"(Projcs["a",Authority["EPSG","2230"]])").epsg, 2230u);
}

TEST(CoordinateSystem, OfTextThatLeavesTheUnitToTheReaderIsUnderstood) {
    EXPECT_FALSE(understood_units("nonsense[1,2"));
    EXPECT_FALSE(understood_units(kUtm)) << "it has no method of projection";
    const std::string geographic =
        R"(BOUNDCRS[SOURCECRS[GEOGCRS["g",DATUM["d",ELLIPSOID["e",6378137,298.257]],CS[ellipsoidal,2],)"
        R"(AXIS["latitude",north,ORDER[1]],AXIS["longitude",east,ORDER[2]],ANGLEUNIT["degree",0.0174532925199433]]],)"
        R"(TARGETCRS[GEOGCRS["g",DATUM["d",ELLIPSOID["e",6378137,298.257]],CS[ellipsoidal,2],)"
        R"(AXIS["latitude",north,ORDER[1]],AXIS["longitude",east,ORDER[2]],ANGLEUNIT["degree",0.0174532925199433]]],)"
        R"wkt(ABRIDGEDTRANSFORMATION["t",METHOD["Geocentric translations (geog2D domain)"],PARAMETER["X-axis translation",0],)wkt"
        R"(PARAMETER["Y-axis translation",0],PARAMETER["Z-axis translation",0]]])";
    EXPECT_FALSE(wkt_units(geographic).known());
    const auto understood = understood_units(geographic);
    ASSERT_TRUE(understood);
    EXPECT_TRUE(understood->degrees);
    EXPECT_EQ(understood_units(*utm_wkt(32633))->horizontal, 1.0);
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
