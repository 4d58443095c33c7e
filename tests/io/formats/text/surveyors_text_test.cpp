// Text as surveyors' programs write it: names and codes beside the numbers, quotes, headers in other
// languages and decimal commas.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SurveyorsText : public testing::TextScan {
 protected:
    std::string columns_of(const std::string& rows) {
        read(rows);
        const std::string format = source_ ? source_->info().format : "";
        return format.substr(std::min(format.find("columns ") + 8, format.size()));
    }
};

TEST_F(SurveyorsText, WordsStandWhereTheyLike) {
    read("Name,X,Y,Z,Code\nP1,1.5,2.5,3.5,TREE\nP2,4,5,6,\"WALL, old\"\n");
    ASSERT_EQ(points(), 2u);
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5));
    EXPECT_EQ(position(1), glm::dvec3(4, 5, 6));
    EXPECT_TRUE(schema().attributes.empty());
    ASSERT_EQ(source_->info().losses.size(), 1u);
    EXPECT_EQ(source_->info().losses[0].count, 2u) << "columns";
    // The same without a header, and with columns stated by the user.
    EXPECT_EQ(columns_of("P1,1.5,2.5,3.5,TREE\nP2,4,5,6,WALL\n"), "- x y z -");
    EXPECT_EQ(columns_of("P1 1.5 2.5 3.5\nP2 4 5 6\n"), "- x y z");
    EXPECT_EQ(columns_of("\"Tree 1\" 1.5 2.5 3.5\n\"Tree \"\"2\"\"\" 4 5 6\n"), "- x y z");
    read("Name,X,Y,Z,Code\nP1,1.5,2.5,3.5,TREE\n", {"-,x,y,z,-", true});
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5));
    read("point 1 1 2 3\n", {"-,-,x,y,z", true});
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
}

TEST_F(SurveyorsText, NumbersOfPointsAreNoCoordinates) {
    EXPECT_EQ(columns_of("1000 4.5 5.25 6.75 9\n1001 4.6 5.35 6.85 8\n1002 4.7 5.45 6.95 9\n"),
              "id x y z intensity");
    EXPECT_EQ(value(2, "id"), 1002);
    EXPECT_EQ(position(2), glm::dvec3(4.7, 5.45, 6.95));
    EXPECT_EQ(columns_of("1 4.5 5.25 6.75\n2 4.6 5.35 6.85\n2a 4.7 5.45 6.95\n"), "- x y z")
        << "with a letter";
    EXPECT_EQ(position(2), glm::dvec3(4.7, 5.45, 6.95));
    // Except for those of a grid, whose other coordinates may be whole as well.
    EXPECT_EQ(columns_of("1 4 5.5 0.5\n2 4 5.25 0.75\n"), "x y z intensity");
    EXPECT_EQ(columns_of("1 4.5 5.5 0.5\n1 4.5 5.25 0.75\n"), "x y z intensity");
    read("ID X Y Z\n7 1.5 2.5 3.5\n");
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5));
    EXPECT_EQ(value(0, "ID"), 7);
}

TEST_F(SurveyorsText, TextsMayHoldWhatPartsOtherLines) {
    for (const char* rows :
         {"x,y,z,note\n1.5,2.5,3.5,\"oak; old\"\n2,3,4,elm\n",
          "x,y,z,note\n1.5,2.5,3.5,oak; old\n2,3,4,elm\n", "x y z note\n1.5 2.5 3.5 oak;old\n2 3 4 elm\n",
          "x y z note\n1.5 2.5 3.5 \"oak, old\"\n2 3 4 elm\n",
          "x;y;z;note\n1,5;2,5;3,5;oak, old\n2;3;4;elm\n"}) {
        read(rows);
        ASSERT_EQ(points(), 2u) << rows;
        EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5)) << rows;
    }
}

TEST_F(SurveyorsText, WhatHoldsNothingIsNoCoordinate) {
    EXPECT_EQ(columns_of(";1,5;2,5;3,5\n;4,5;5,5;6,5\n"), "- x y z");
    ASSERT_EQ(points(), 2u);
    EXPECT_EQ(position(1), glm::dvec3(4.5, 5.5, 6.5));
    EXPECT_EQ(columns_of("1.5,,2.5,3.5,9\n4.5,,5.5,6.5,8\n"), "x - y z intensity");
}

TEST_F(SurveyorsText, AStrayWordTakesNoColumnWithIt) {
    std::string rows;
    for (int i = 0; i < 300; ++i) rows += fmt::format("{}.5 2.5 3.5 {}\n", i, i == 200 ? "4#" : "4");
    for (const char* header : {"", "x y z intensity\n"}) {
        EXPECT_THAT(error_of(header + rows).line(), HasSubstr("'4#' is no value for intensity"));
        read(header + rows, {.columns = "", .quiet = true, .salvage = true});
        ASSERT_EQ(points(), 299u);
        EXPECT_EQ(value(298, names::intensity), 4);
    }
    // It does not change the guess for the other columns either.
    rows.clear();
    for (int i = 0; i < 300; ++i) rows += fmt::format("{}.5 2.5 3.5 1 {} 3\n", i, i == 200 ? "2#" : "2");
    EXPECT_THAT(error_of(rows).line(), HasSubstr("'2# 3' is no value for green (u8)"));
    read(rows, {.columns = "", .quiet = true, .salvage = true});
    ASSERT_EQ(points(), 299u);
    EXPECT_EQ(value(298, names::color, 1), 2);
}

TEST_F(SurveyorsText, QuotedNumbersAreNumbers) {
    for (const char* separator : {",", ";", " ", "\t"}) {
        const std::string s(separator);
        read("\"X\"" + s + "\"Y\"" + s + "\"Z\"" + s + "\"n\"\n\"1.5\"" + s + "\"-2\"" + s + "\"3e2\"" + s +
             "\"7\"\n");
        ASSERT_EQ(points(), 1u) << separator;
        EXPECT_EQ(position(0), glm::dvec3(1.5, -2, 300)) << separator;
        EXPECT_EQ(value(0, "n"), 7);
    }
    EXPECT_THAT(error_of("x,y,z\n\"1.5,2,3\n4,5,6\n").line(), HasSubstr("x")) << "a quote that does not end";
}

TEST_F(SurveyorsText, HeadersOfOtherLanguagesNameTheAxes) {
    for (const char* header :
         {"E,N,H,I", "Easting,Northing,Elevation,I", "East [m],North [m],Height (ellipsoidal) [m],I",
          "Rechtswert,Hochwert,Höhe,I", "Rechtswert,Hochwert,H\xf6he,Intensit\xe4t", "X,Y,H,Intensität",
          "e;n;z;i", "Ostwert Nordwert Hoehe i"}) {
        const std::string text = header;
        const char separator = text.find(',') != text.npos ? ',' : text.find(';') != text.npos ? ';' : ' ';
        std::string row = "1,2,3,40\n";
        std::ranges::replace(row, ',', separator);
        read(text + "\n" + row);
        ASSERT_EQ(points(), 1u) << text;
        EXPECT_EQ(position(0), glm::dvec3(1, 2, 3)) << text;
        EXPECT_EQ(value(0, names::intensity), 40) << text;
    }
    // A column named x, y or z takes precedence.
    read("x,y,z,h,n,e\n1,2,3,4,5,6\n");
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
    EXPECT_EQ(value(0, "h"), 4);
    // Numbers may be names: here those of bands.
    read("x,y,z,405,532,1064\n1,2,3,4,5,6\n");
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(value(0, "532"), 5);
}

TEST_F(SurveyorsText, NamesAreShownAsTheyAreButForWhatCannotBeSeen) {
    read("x y z Größe\n1 2 3 4\n");
    EXPECT_EQ(value(0, "Größe"), 4);
    const auto shown = [&](const std::string& header) { return error_of(header + "\n1 2 3\n").line(); };
    EXPECT_THAT(shown("Höhe"), HasSubstr("'Höhe'"));
    EXPECT_THAT(shown("H\xf6he"), HasSubstr("'H?he'")) << "no UTF-8";
    EXPECT_THAT(shown("a\xc2\x9b"
                      "31m"),
                HasSubstr("'a??31m'"))
        << "a control character of two bytes";
    EXPECT_THAT(shown("a\xe2\x80\xae"
                      "b"),
                HasSubstr("'a???b'"))
        << "right to left";
    EXPECT_THAT(shown("a\xed\xa0\x80"
                      "b"),
                HasSubstr("'a???b'"))
        << "half a character";
    EXPECT_THAT(shown(std::string(63, 'a') + "ö"), HasSubstr(std::string(63, 'a') + "'"))
        << "cut between characters";
}

TEST_F(SurveyorsText, DecimalCommasAreReadWhereTheyCanBeNothingElse) {
    for (const char* rows : {"12,5;13,25;4,75;7\n-1,5;2;,5;8\n", "12,5\t13,25\t4,75\t7\n-1,5\t2\t,5\t8\n",
                             "12,5 13,25 4,75 7\n-1,5 2 ,5 8\n", "X;Y;Z;I\n12,5;13,25;4,75;7\n-1,5;2;0,5;8\n",
                             "12;13;4;7\n-1,5;2;0,5;8\n"}) {
        read(rows);
        ASSERT_EQ(points(), 2u) << rows;
        EXPECT_EQ(position(1), glm::dvec3(-1.5, 2, .5)) << rows;
        EXPECT_EQ(value(1, names::intensity), 8) << rows;
    }
    EXPECT_EQ(position(0), glm::dvec3(12, 13, 4));
    read("Baum;12,5;13,25;4,75\n", {"-,x,y,z", true});
    EXPECT_EQ(position(0), glm::dvec3(12.5, 13.25, 4.75));
}

TEST_F(SurveyorsText, CommasThatMayBeEitherAreRefused) {
    const auto error = error_of("1,5, 2,5, 3,5\n4,5, 5,5, 6,5\n");
    EXPECT_EQ(error.kind, ErrorKind::input_rejected);
    EXPECT_THAT(error.line(),
                HasSubstr("its line 1, '1,5, 2,5, 3,5', can be read with decimal commas or without"));
    EXPECT_THAT(error.line(), HasSubstr("--columns"));
    read("1,5, 2,5, 3,5\n", {"x,y,z,a,b,c", true});
    EXPECT_EQ(position(0), glm::dvec3(1, 5, 2));
    read("1,5,2\n3,4,5\n");  // whole numbers between commas are not decimal
    EXPECT_EQ(position(0), glm::dvec3(1, 5, 2));
    EXPECT_THAT(error_of("x;y;z\n451.234,567;5.412.345,678;123,4\n").line(), HasSubstr("without rows"))
        << "points that part thousands";
}

TEST_F(SurveyorsText, TruncationAnywhereAndStrayQuotesAreHarmless) {
    const std::string text =
        "\"Nr\";\"E\";\"N\";\"H\";\"\"\"Code\"\"\"\n\"P;1\";\"1,5\";2,5;3,5;\"a\"\"b\"\n\"P2\";4;5;6;\n";
    for (size_t length = 0; length <= text.size(); ++length)
        (void)try_read(std::string_view(text).substr(0, length), {"", true});
    for (size_t i = 0; i < text.size(); ++i) {
        std::string stray = text;
        stray[i] = '"';
        (void)try_read(stray, {"", true});
    }
    read(text);
    ASSERT_EQ(points(), 2u);
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.5, 3.5));
    EXPECT_EQ(position(1), glm::dvec3(4, 5, 6));
}

TEST_F(SurveyorsText, Utf16IsTold) {
    using namespace std::string_literals;
    for (const auto& text : {"\xff\xfe"
                             "1\0 \0"
                             "2\0 \0"
                             "3\0\n\0"s,
                             "\xfe\xff\0"
                             "1\0 \0"
                             "2\0 \0"
                             "3\0\n"s})
        EXPECT_THAT(error_of(text).line(), HasSubstr("is UTF-16 text; save it as UTF-8"));
}

TEST_F(SurveyorsText, RowsOfEndlessColumnsAreRefusedInALine) {
    std::string row = "1 2 3";
    for (int i = 0; i < 100'000; ++i) row += " 4";
    const std::string line = error_of(row + "\n").line();
    EXPECT_THAT(line, HasSubstr("or more values in a row, 1000 can be read"));
    EXPECT_LT(line.size(), 300u);
    EXPECT_LT(columns_of("1 2 3" + row.substr(5, 500) + "\n").size(), 1000u);
}

}  // namespace
}  // namespace lucarne::io
