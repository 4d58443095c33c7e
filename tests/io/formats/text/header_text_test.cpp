// Headers of text: units in brackets, tabs between names that hold blanks, and cells that say that they hold
// no number.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class HeaderText : public testing::TextScan {
 protected:
    void read_reported(const std::string& name) {
        read(testing::read_bytes(testing::shared_data() / "reports" / name));
    }
};

TEST_F(HeaderText, StatesTheUnitInBrackets) {
    const std::vector<std::pair<std::string, double>> cases = {
        {"X (mm),Y (mm),Z (mm)", 0.001},
        {"Easting [ft],Northing [ft],Elevation [ft]", 0.3048},
        {"X (US ft),Y (US ft),Z", 1200.0 / 3937},
        {"x[m],y[m],z[m]", 1},
        {"X (US survey feet),Y,Z", 1200.0 / 3937},
        {"X [Inch],Y [Inch],Z [Inch]", 0.0254},
        {"X (cm) Y (cm) Z (cm)", 0.01},
        {"X (US ft) Y (US ft) Z (US ft)", 1200.0 / 3937},
        {"X[cm]\tY[cm]\tZ[cm]", 0.01},
        {"// X (mm);Y (mm);Z (mm)", 0.001}};
    for (const auto& [header, unit] : cases) {
        const char separator = header.find(',') != header.npos    ? ','
                               : header.find(';') != header.npos  ? ';'
                               : header.find('\t') != header.npos ? '\t'
                                                                  : ' ';
        read(fmt::format("{}\n1.5{}2.5{}3.5\n", header, separator, separator));
        ASSERT_EQ(points(), 1u) << header;
        EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5)) << header;
        EXPECT_DOUBLE_EQ(source_->info().metres_per_unit, unit) << header;
        EXPECT_TRUE(source_->info().unit_stated) << header;
    }
}

TEST_F(HeaderText, WithAnUnknownUnitOrDegreesStatesNone) {
    for (const std::string header :
         {"X (deg),Y (deg),Z (m)", "X (rods),Y (rods),Z (rods)", "X (),Y,Z", "X,Y,Z"}) {
        read(header + "\n1.5,2.5,3.5\n");
        ASSERT_EQ(points(), 1u) << header;
        EXPECT_FALSE(source_->info().unit_stated) << header;
    }
    // The user knows better.
    read("X (mm),Y (mm),Z (mm)\n1.5,2.5,3.5\n", {.quiet = true, .metres_per_unit = 1.0});
    EXPECT_EQ(source_->info().metres_per_unit, 1.0);
}

TEST_F(HeaderText, TabsSeparateWhereTheHeaderHasTabs) {
    read("X\tY\tZ\tC2C absolute distances\n1.5\t2.5\t3.5\t.5\n4\t5\t6\t\n7\t8\t9\t1\n");
    ASSERT_EQ(points(), 3u);
    EXPECT_EQ(value(0, "C2C absolute distances"), 0.5);
    EXPECT_TRUE(std::isnan(value(1, "C2C absolute distances"))) << "an empty cell between tabs";
    EXPECT_EQ(position(2), glm::dvec3(7, 8, 9));
    read("//X\tY\tZ\tScalar field #2\n1.5\t2.5\t3.5\t.5\n");
    EXPECT_EQ(value(0, "Scalar field #2"), 0.5);
    read("X\tY\tZ\tKind\n1.5\t2.5\t3.5\tlow vegetation\n4\t5\t6\troof\n");
    ASSERT_EQ(points(), 2u);
    // Rows without tabs are rows of blanks, whatever the header has, and so are rows without a header.
    read("X\tY\tZ\tI\n1.5 2.5 3.5 7\n");
    EXPECT_EQ(value(0, "intensity"), 7);
    read("1.5\t2.5 3.5\t 7\n");
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5));
    read("X\tY\tZ\n1,5\t2,5\t3,5\n");
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5)) << "decimal commas";
}

TEST_F(HeaderText, CellsThatSayThereIsNoNumberAreNone) {
    for (const std::string none :
         {"NULL", "null", "N/A", "n/a", "NA", "None", "-1.#IND", "1.#QNAN", "1.#INF", "nan"}) {
        read("X,Y,Z,distance\n1.5,2.5,3.5,.5\n4,5,6," + none + "\n7,8," + none + ",1\n");
        ASSERT_EQ(points(), 2u) << none;
        EXPECT_EQ(records_.dropped, 1u) << none;
        EXPECT_EQ(value(0, "distance"), 0.5) << none;
        EXPECT_TRUE(std::isnan(value(1, "distance"))) << none;
    }
    // Types without NaN hold 0.
    read("X,Y,Z,Classification\n1,2,3,6\n1,2,3,NULL\n");
    ASSERT_EQ(points(), 2u);
    EXPECT_EQ(value(1, "classification"), 0);
    // Other words among numbers are damage.
    EXPECT_THAT(error_of("X,Y,Z,distance\n1.5,2.5,3.5,.5\n4,5,oops,1\n7,8,9,1\n").line(), HasSubstr("oops"));
}

TEST_F(HeaderText, OfAMegabyteIsRejectedInOneLine) {
    for (const char* word : {"x", "x ", "x\t", "X (mm) ", "[", "# x\n"}) {
        std::string header;
        while (header.size() < (size_t{1} << 20)) header += word;
        const Error error = error_of(header + "\n1.5 2.5 3.5\n");
        EXPECT_EQ(error.kind, ErrorKind::input_rejected) << word;
        EXPECT_LT(error.line().size(), 500u) << word;
    }
}

TEST_F(HeaderText, OfReportedFilesIsUsed) {
    if (testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    read_reported("u_mm.csv");
    EXPECT_EQ(source_->info().metres_per_unit, 0.001);
    read_reported("u_ft.csv");
    EXPECT_EQ(source_->info().metres_per_unit, 0.3048);
    read_reported("h_tab_br.txt");
    EXPECT_EQ(points(), 60u);
    EXPECT_TRUE(schema().find(names::intensity));
    read_reported("cc_tab.txt");
    EXPECT_EQ(points(), 100u);
    EXPECT_TRUE(schema().find("C2C absolute distances") && schema().find(names::normal) &&
                schema().find(names::color));
    read_reported("attr_09.csv");
    EXPECT_EQ(points(), 400u);
    EXPECT_TRUE(schema().find("C2C_distance"));
    EXPECT_TRUE(std::isnan(value(1, "C2C_distance")));
    read_reported("msvc_nan.ptx");
    EXPECT_EQ(points(), 80u);
}

}  // namespace
}  // namespace lucarne::io
