// Rows of numbers are read exactly, whatever separates and names them; malformed ones are rejected.
#include <charconv>
#include <clocale>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/core/parallel.h"
#include "io/core/random.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class Text : public testing::TextScan {};

TEST_F(Text, SeparatorsGiveTheSamePoints) {
    for (const char* separator : {" ", "\t", ",", ";", ", ", "  ", " ;\t", ","}) {
        std::string text;
        for (const auto& row : {std::array{"1.5", "-2", "+3e2"}, std::array{"4", ".5", "6."}})
            text += std::string(row[0]) + separator + row[1] + separator + row[2] + "\n";
        read(text);
        ASSERT_EQ(points(), 2u) << separator;
        EXPECT_EQ(position(0), glm::dvec3(1.5, -2, 300)) << separator;
        EXPECT_EQ(position(1), glm::dvec3(4, .5, 6)) << separator;
    }
}

TEST_F(Text, LineEndsOfEverySystemAndBlankLinesAndCommentsAreUnderstood) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        read("# comment" + end + end + "  // another" + end + "1 2 3" + end + "   " + end + "% 9 9 9" + end +
             " 4 5 6 ");
        ASSERT_EQ(points(), 2u);
        EXPECT_EQ(position(1), glm::dvec3(4, 5, 6));
    }
    read(
        "\xef\xbb\xbf"
        "1 2 3\n");
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
}

TEST_F(Text, EveryDigitOfACoordinateCounts) {
    // Numbers at the borders of the fast path, beyond it, and random ones must be read like from_chars does.
    std::vector<std::string> numbers = {"9007199254740992",
                                        "9007199254740993",
                                        "0.1",
                                        "1e22",
                                        "1e-22",
                                        "123456789012345678",
                                        "0.000000000000000000000001",
                                        "2600123.4567",
                                        "-0",
                                        "1.7976931348623157e29",
                                        "5e-324",
                                        "0.30000000000000004",
                                        "00000000000000000000001.5",
                                        "1E+05"};
    Random random(7);
    for (int i = 0; i < 3000; ++i) {
        std::array<char, 40> text{};
        const double value = (random.uniform() - .5) * std::pow(10.0, random.uniform() * 16 - 4);
        const auto end =
            i % 2 ? std::to_chars(text.begin(), text.end(), value).ptr
                  : std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed, i % 15).ptr;
        numbers.emplace_back(text.begin(), end);
    }
    std::string rows;
    for (const auto& number : numbers) rows += number + " 0 " + number + "\n";
    read(rows);
    ASSERT_EQ(points(), numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) {
        double expected = 0;
        std::from_chars(numbers[i].data(), numbers[i].data() + numbers[i].size(), expected);
        EXPECT_EQ(position(i).x, expected) << numbers[i];
        EXPECT_EQ(position(i).z, expected) << numbers[i];
    }
}

TEST_F(Text, ColumnsAreNamedByAHeader) {
    const std::vector<std::string> headers = {"z,Intensity,y,x,Red,Green,Blue,Classification,GpsTime",
                                              "\"Z\",i,\"Northing\",Easting,r,g,b,class,gps_time",
                                              "//Z,I,Y,X,R,G,B,Scalar_Classification,gpstime",
                                              "# z i y x R G B class GpsTime"};
    for (const auto& header : headers) {
        read(header + "\n3,700,2,1,10,20,255,6,1.25\n");
        ASSERT_EQ(points(), 1u) << header;
        EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
        EXPECT_EQ(value(0, names::color, 2), 255);
        EXPECT_EQ(schema().find(names::color)->type, ScalarType::u8);
        EXPECT_EQ(value(0, names::intensity), 700);
        EXPECT_EQ(value(0, names::classification), 6);
        EXPECT_EQ(schema().find(names::classification)->type, ScalarType::u8);
        EXPECT_EQ(value(0, names::gps_time), 1.25);
    }
}

TEST_F(Text, ColumnsWithoutAHeaderAreGuessedByTheirNumbers) {
    const auto columns = [&](const std::string& rows) {
        read(rows);
        const std::string format = source_ ? source_->info().format : "";
        return format.substr(std::min(format.find("columns ") + 8, format.size()));
    };
    EXPECT_EQ(columns("1 2 3\n"), "x y z");
    EXPECT_EQ(columns("1 2 3 -900\n"), "x y z intensity");
    EXPECT_EQ(columns("1 2 3 0 128 255\n"), "x y z red green blue");
    EXPECT_EQ(columns("1 2 3 0.6 0 0.8\n1 2 3 0 0 0\n"), "x y z nx ny nz");
    EXPECT_EQ(columns("1 2 3 -900 0 128 255\n"), "x y z intensity red green blue");
    EXPECT_EQ(columns("1 2 3 0 128 255 -3.5\n"), "x y z red green blue intensity");
    EXPECT_EQ(columns("1 2 3 0 128 255 1200\n4 5 6 7 8 9 0\n"), "x y z red green blue intensity");
    EXPECT_EQ(columns("1 2 3 1200 0 128 255\n4 5 6 0 7 8 9\n"), "x y z intensity red green blue");
    EXPECT_EQ(columns("1 2 3 4 5 6 7\n"), "x y z red green blue intensity") << "as most programs write it";
    EXPECT_EQ(columns("1\n1 2 3 4 5 6 7\n"), "x y z intensity red green blue") << "as PTS has it";
    EXPECT_EQ(columns("1 2 3 0 128 255 0.6 0 0.8\n"), "x y z red green blue nx ny nz");
    EXPECT_EQ(columns("1 2 3 12.5 0 128 255 0.6 0 0.8\n"), "x y z intensity red green blue nx ny nz");
    EXPECT_EQ(columns("1 2 3 ground -7 -8\n"), "x y z - intensity column_6");
    EXPECT_EQ(schema().attributes.size(), 2u);
}

TEST_F(Text, TheUserKnowsColumnsBetter) {
    read("9 1 2 3 300 0 1 0.5\n", {"-,x,y,z,r:u16,g,b,weight:f32", true});
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
    EXPECT_EQ(schema().find(names::color)->type, ScalarType::u16);
    EXPECT_EQ(value(0, names::color, 0), 300);
    EXPECT_EQ(schema().find("weight")->type, ScalarType::f32);
    // With stated columns the file may have any name, and headers are skipped.
    read("A nonsensical header\n1 2 3\n", {"x,y,z", true});
    EXPECT_EQ(points(), 1u);
    for (const auto& [columns, reason] :
         std::vector<std::pair<std::string, std::string>>{{"x,y", "x, y and z"},
                                                          {"x,y,z,x", "x, y and z"},
                                                          {"x,y,z,i:f16", "no type"},
                                                          {"x,,y,z", "name is missing"},
                                                          {"x,y,z,i", "4 columns, the rows of"}}) {
        const auto error = error_of("1 2 3\n", {columns, true});
        EXPECT_EQ(error.kind, ErrorKind::arguments) << columns;
        EXPECT_THAT(error.line(), HasSubstr(reason));
    }
}

TEST_F(Text, ColoursHaveTheTypeAndTheWhiteOfTheirNumbers) {
    struct Case {
        const char* rows;
        ScalarType type;
        uint32_t bits;
    };
    for (const Case& c :
         {Case{"1 2 3 0 0 255\n", ScalarType::u8, 8}, Case{"1 2 3 0 0 256\n", ScalarType::u16, 16},
          Case{"1 2 3 0.25 0 1\n", ScalarType::f32, 0}}) {
        read(c.rows);
        ASSERT_TRUE(schema().find(names::color)) << c.rows;
        EXPECT_EQ(schema().find(names::color)->type, c.type) << c.rows;
        EXPECT_EQ(source_->info().color_bits, c.bits) << c.rows;
    }
}

TEST_F(Text, RowsThatNoSampleHasSeenFitAsWell) {
    // The sample covers 64 KiB at each of 64 places of these 6.4 MB; row 5000 lies after the first of them.
    constexpr size_t kRows = 400'000, kUnseen = 5000;
    std::string text;
    for (size_t i = 0; i < kRows; ++i) text += i == kUnseen ? "1 2 3 7.5 0 0 256\n" : "1 2 3 7 0 0 255\n";
    read(text, {"x,y,z,weight,r,g,b", true});
    ASSERT_EQ(points(), kRows);
    EXPECT_EQ(value(kUnseen, "weight"), 7.5);
    EXPECT_EQ(value(kUnseen, names::color, 2), 256);
    EXPECT_EQ(source_->info().color_bits, 8u);
}

TEST_F(Text, NoWholeNumberIsRounded) {
    // Nanoseconds since 1970, where doubles are 256 apart.
    const auto times = [&](std::initializer_list<const char*> words, const std::string& more = "") {
        std::string text = "x,y,z,time\n";
        for (const char* word : words) text += fmt::format("1,2,3,{}\n", word);
        read(text + more);
        const Attribute* time = source_ ? schema().find("time") : nullptr;
        std::vector<int64_t> got;
        for (size_t i = 0; time && time->type == ScalarType::i64 && i < words.size(); ++i)
            got.push_back(load<int64_t>(&records_.bytes[i * schema().stride + time->offset]));
        return got;
    };
    const std::vector<int64_t> exact = {1700000000123456789, 1700000000123456790};
    EXPECT_EQ(times({"1700000000123456789", "1700000000123456790"}), exact);
    EXPECT_EQ(times({"1700000000123456789", "\"1700000000123456790\""}), exact);
    EXPECT_EQ(times({"1.7e18", "1700000000000000001"}),
              (std::vector<int64_t>{1700000000000000000, 1700000000000000001}));
    std::string more;  // more than a sample looks at
    while (more.size() < (size_t{5} << 20)) more += "1,2,3,1700000000123456791\n";
    EXPECT_EQ(times({"1700000000123456789", "1700000000123456790"}, more), exact);
    // Values that doubles hold exactly, and values that do not fit 64 bits, stay doubles.
    for (const char* word : {"9007199254740991", "9300000000000000000", "1e300", "17000000001234567.5e9"}) {
        EXPECT_TRUE(times({word}).empty()) << word;
        EXPECT_EQ(value(0, "time"), std::stod(word));
    }
    EXPECT_TRUE(times({"1700000000123456789", ""}).empty()) << "a number is missing";
}

TEST_F(Text, PointsWithoutACoordinateAreDroppedAndCounted) {
    read("x,y,z,w\n1,2,3,0.5\n,2,3,0.5\nnan,2,3,4\n1,inf,3,4\n1,2,1e300,4\n1,2,3,\n");
    EXPECT_EQ(points(), 2u);
    EXPECT_EQ(records_.dropped, 4u);
    EXPECT_TRUE(std::isnan(value(1, "w")));
    read("x,y,z,w\n1,2,3,7\n1,2,3,\n");
    EXPECT_TRUE(std::isnan(value(1, "w"))) << "not 0, though the others are whole";
}

TEST_F(Text, EmptyCellsTakeNoRoomButOfTheirSeparator) {
    // More rows than there would be if every cell held a digit.
    std::string text = "x,y,z,a,b,c,d,e,f,g\n1,2,3,4,5,6,7,8,9,10\n";
    for (int i = 0; i < 5000; ++i) text += "1,2,3,,,,,,,\n";
    read(text);
    ASSERT_EQ(points(), 5001u);
    EXPECT_EQ(position(5000), glm::dvec3(1, 2, 3));
}

TEST_F(Text, RowsThatDoNotFitAreRejectedWithLineAndReason) {
    EXPECT_THAT(error_of("1 2 3\n1 2\n").line(), HasSubstr("line 2 on: it has 2 values instead of 3"));
    EXPECT_THAT(error_of("1 2 3\n\n1 2 3 4\n").line(), HasSubstr("line 3 on: it has more than the 3"));
    EXPECT_THAT(error_of("1 2 3\n1 a 3\n").line(), HasSubstr("'a 3' is no value for y"));
    EXPECT_THAT(error_of("x,y,z\n1,2,3\n1;2;3\n").line(), HasSubstr("line 3"));
    EXPECT_THAT(error_of("x y z a\n1 2 3 4\n1 2 3 4.5\n", {"x,y,z,a:i32", true}).line(),
                HasSubstr("a (i32)"));
    for (const std::string text : {"one two three\n", "1 2\n3 4\n", "5\n", "\n\n", "# only\n", "1,5;2,5\n"})
        EXPECT_THAT(error_of(text).line(), HasSubstr("unrecognised format")) << text;
    EXPECT_THAT(error_of("x y\n1 2 3\n").line(), HasSubstr("does not name the 3 columns"));
    EXPECT_THAT(error_of("1 2 3\n" + std::string(5 << 20, '7')).line(), HasSubstr("line of more than 1 MiB"));
    EXPECT_EQ(error_of("1 2 3\n1 2 x\n").kind, ErrorKind::input_rejected);
}

TEST_F(Text, GoodRowsBeforeABadOneAreHandedOut) {
    file_.set("1 2 3\n4 5 6\nbad 1 2\n");
    const auto source = open_scan(file_.path(), {"", true});
    ASSERT_TRUE(source);
    const auto reader = (*source)->open();
    PointBatch batch;
    EXPECT_EQ(*(*reader)->read(batch, 100), 2u);
    EXPECT_FALSE((*reader)->read(batch, 100));
    EXPECT_FALSE((*reader)->read(batch, 100));
}

TEST_F(Text, CountsOfPtsAreTakenAtTheirWord) {
    read("2\n1 2 3 -500 1 2 3\n4 5 6 7 8 9 10\n");
    EXPECT_EQ(points(), 2u);
    EXPECT_THAT(source_->info().format, HasSubstr("PTS"));
    EXPECT_EQ(source_->info().declared_points, 2u);
    EXPECT_EQ(value(0, names::intensity), -500);
    EXPECT_EQ(value(1, names::color, 2), 10);
    read("1\n1 2 3\n2\n4 5 6\n7 8 9\n");  // scans one after the other
    EXPECT_EQ(points(), 3u);
    read("1\n1 2 3\n4 5 6\n");  // more rows than the count states do no harm
    EXPECT_EQ(points(), 2u);
    EXPECT_THAT(error_of("3\n1 2 3\n4 5 6\n# and comments enough\n").line(),
                HasSubstr("1 of 3 points are missing"));
    EXPECT_THAT(error_of("300\n1 2 3\n4 5 6\n").line(), HasSubstr("promises 300 points, at most"));
    EXPECT_THAT(error_of("18446744073709551615\n1 2 3\n").line(), HasSubstr("at most"));
    EXPECT_THAT(error_of("1\n1 2 3\n18446744073709551615\n").line(), HasSubstr("too large"));
}

TEST_F(Text, ExtensionsDecideOnlyWhatContentLeavesOpen) {
    const testing::TemporaryFolder folder;
    for (const auto& [name, format] : std::vector<std::pair<std::string, std::string>>{
             {"a.pts", "PTS"}, {"b.xyz", "XYZ"}, {"c.CSV", "XYZ"}, {"d", "XYZ"}}) {
        testing::write_bytes(folder / name, "1 2 3 4 5 6 7\n");
        const auto source = open_scan(folder / name, {"", true});
        ASSERT_TRUE(source) << source.error().line();
        EXPECT_THAT((*source)->info().format, ::testing::StartsWith(format)) << name;
    }
    for (const std::string name : {"e.pcd", "f.ply", "g.LAS"}) {
        testing::write_bytes(folder / name, "1 2 3 4 5 6 7\n");
        EXPECT_FALSE(open_scan(folder / name)) << name;
        EXPECT_TRUE(open_scan(folder / name, {"x,y,z,-,-,-,-", true})) << name;
    }
}

/// Returns rows of all lengths, more than several windows of the reader hold.
std::string many_rows(int rows) {
    std::string text;
    Random random(3);
    for (int i = 0; i < rows; ++i)
        text += std::to_string(i) + std::string(1 + random.next() % 30, ' ') +
                std::to_string(random.uniform()) + (i % 7 ? " 1" : " nan") + (i % 5 ? "\n" : "\r\n\n");
    return text;
}

TEST_F(Text, LargeFilesAreReadInOrderWhateverTheThreadsAndTheBatch) {
    file_.set(many_rows(400000));
    const auto source = open_scan(file_.path(), {"", true});
    ASSERT_TRUE(source);
    // More than 4 MiB, so the count is an estimate.
    EXPECT_NEAR(static_cast<double>((*source)->info().declared_points), 400000, 8000);
    std::optional<testing::Records> first;
    for (const auto& [threads, batch] : {std::pair(1u, size_t{1} << 16), std::pair(4u, size_t{777})}) {
        const ThreadLimit limit(threads);
        auto records = testing::read_all(**source, batch);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count + records->dropped, 400000u);
        EXPECT_EQ(records->dropped, 57143u);
        if (!first) {
            for (size_t i = 1; i < records->count; ++i)
                ASSERT_GT(load<double>(&records->bytes[i * 24]), load<double>(&records->bytes[(i - 1) * 24]));
            first = std::move(*records);
        } else {
            EXPECT_TRUE(first->bytes == records->bytes);
        }
    }
}

TEST_F(Text, TheLineOfAnErrorFarInsideIsRight) {
    std::string text = many_rows(300000);
    const auto lines = std::count(text.begin(), text.end(), '\n');
    EXPECT_THAT(error_of(text + "1 two 3\n").line(), HasSubstr("line " + std::to_string(lines + 1) + " on"));
}

TEST_F(Text, TruncationAnywhereIsHarmless) {
    const std::string text = "4\n1.25 2 3 -5 1 2 3\n4.5 5 6 7 8 9 10\n1 2 3 4 5 6 7\n9 8 7 6 5 4 33\n";
    for (size_t length = 1; length + 2 < text.size(); ++length)
        EXPECT_NE(error_of(text.substr(0, length)).line(), ": ") << length;
}

TEST_F(Text, ChangedBytesNeverCrash) {
    const std::vector<std::string> seeds = {
        "2\n1.25 2 3 -5 1 2 3\n4.5 5 6 7 8 9 10\n", "x,y,z,r,g,b\n1,2,3,255,0,1\n4,5,6,7,8,9\n",
        "//X Y Z Nx Ny Nz\n1 2 3 0 0 1\n4 5 6 1 0 0\n", "1;2;3\r\n4;5;6\r\n"};
    Random random(11);
    for (int i = 0; i < 8000; ++i) {
        std::string text = seeds[static_cast<size_t>(i) % seeds.size()];
        for (uint64_t k = 0; k <= random.next() % 4; ++k)
            text[random.next() % text.size()] = random.next() % 2
                                                    ? "0123456789.,;- \n\r\teExyz#/"[random.next() % 25]
                                                    : static_cast<char>(random.next());
        const auto error = error_of(text);  // or none
        EXPECT_TRUE(error.why.empty() || error.kind == ErrorKind::input_rejected) << text;
    }
}

TEST_F(Text, LocalesDoNotChangeNumbers) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    read("1.5 2.25 3e-1\n");
    std::setlocale(LC_ALL, before.c_str());
    EXPECT_EQ(position(0), glm::dvec3(1.5, 2.25, 0.3));
}

}  // namespace
}  // namespace lucarne::io
