// Any meaningful PLY is read, whatever its order and types; others are rejected.
#include <algorithm>
#include <clocale>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::MemoryFile;
using testing::read_all;

class Ply : public ::testing::Test {
 protected:
    Result<std::unique_ptr<PointSource>> open(const std::string& bytes) {
        file_.set(bytes);
        return open_scan(file_.path());
    }
    /// Opens and reads. Returns the error of whichever fails.
    Result<testing::Records> read(const std::string& bytes) {
        LUCARNE_ASSIGN(source_, open(bytes));
        return read_all(*source_, 3);
    }
    void expect_rejected(const std::string& bytes, const std::string& reason) {
        const auto records = read(bytes);
        ASSERT_FALSE(records) << bytes;
        EXPECT_EQ(records.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(records.error().line(), HasSubstr(reason));
    }
    glm::dvec3 position(const testing::Records& r, size_t i) const {
        return position_of(source_->schema(), &r.bytes[i * source_->schema().stride]);
    }
    double value(const testing::Records& r, size_t i, std::string_view name, size_t component = 0) const {
        const Attribute* a = source_->schema().find(name);
        if (!a) {
            ADD_FAILURE() << "no " << name;
            return std::nan("");
        }
        return scalar_at(
            a->type, &r.bytes[i * source_->schema().stride + a->offset + component * scalar_bytes(a->type)]);
    }
    const MemoryFile file_;
    std::unique_ptr<PointSource> source_;
};

std::string header(const std::string& format, const std::string& rest) {
    return "ply\nformat " + format + " 1.0\n" + rest + "end_header\n";
}
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

/// Builds binary bodies in either byte order.
class Body {
 public:
    explicit Body(bool big) : big_(big) {}
    template <class T>
    Body& put(T value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        if (big_) std::reverse(bytes, bytes + sizeof value);
        text.append(bytes, sizeof value);
        return *this;
    }
    std::string text;

 private:
    bool big_;
};

TEST_F(Ply, TheCaseOfWordsAndPropertiesDoesNotMatter) {
    const auto records = read(
        "PLY\nFormat ASCII 1.0\nElement Vertex 2\nProperty Float X\nproperty FLOAT Y\nproperty float Z\n"
        "property uchar Red\nproperty uchar Green\nproperty uchar BLUE\n"
        "property float NX\nproperty float NY\nproperty float NZ\nproperty float Intensity\n"
        "property float Own\nEnd_Header\n1 2 3 4 5 6 0 0 1 .5 7\n4 5 6 7 8 9 1 0 0 .25 8\n");
    ASSERT_TRUE(records) << records.error().line();
    ASSERT_EQ(records->count, 2u);
    EXPECT_EQ(position(*records, 1), glm::dvec3(4, 5, 6));
    EXPECT_EQ(value(*records, 0, names::color, 2), 6);
    EXPECT_EQ(value(*records, 1, names::normal, 0), 1);
    EXPECT_EQ(value(*records, 1, names::intensity), .25);
    EXPECT_EQ(value(*records, 1, "Own"), 8) << "names that mean nothing here stay as they are";
}

TEST_F(Ply, OfPropertiesThatDifferInCaseTheUsualOneCounts) {
    const auto records = read(header("ascii", "element vertex 1\nproperty float X\n" + kXyz +
                                                  "property float Intensity\nproperty float intensity\n") +
                              "9 1 2 3 4 5\n");
    ASSERT_TRUE(records) << records.error().line();
    EXPECT_EQ(position(*records, 0), glm::dvec3(1, 2, 3));
    EXPECT_EQ(value(*records, 0, "X"), 9);
    EXPECT_EQ(value(*records, 0, names::intensity), 5);
    EXPECT_EQ(value(*records, 0, "Intensity"), 4);
}

TEST_F(Ply, FacesAreFoundWhateverTheCaseOfTheirNames) {
    const auto scan = open(header("ascii", "element Vertex 3\n" + kXyz +
                                               "element FACE 1\nproperty list uchar int Vertex_Indices\n") +
                           "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_THAT((*scan)->info().format, HasSubstr("mesh"));
}

TEST_F(Ply, AllEncodingsGiveTheSamePoints) {
    const std::string properties =
        "property uchar red\nproperty double z\nproperty list uchar short ignored\nproperty double "
        "x\nproperty uint8 green\n"
        "property ushort scalar_Gain\nproperty float64 y\nproperty uchar blue\nproperty int32 "
        "label\nproperty float q\n";
    const auto records_of = [&](const std::string& format, const std::string& body) {
        auto records = read(header(format, "element vertex 2\n" + properties) + body);
        if (!records) ADD_FAILURE() << records.error().line();
        return records ? *records : testing::Records{};
    };
    const auto text =
        records_of("ascii", "255 3.5 2 7 8 1.5 128 65535 2.5 0 -7 1e-3\n1 -3 0 -1 2 4 -2 3 5 6.25\n");
    EXPECT_EQ(source_->schema().position, PositionType::f64);
    ASSERT_EQ(text.count, 2u);
    EXPECT_EQ(position(text, 0), glm::dvec3(1.5, 2.5, 3.5));
    EXPECT_EQ(value(text, 0, names::color, 1), 128);
    EXPECT_EQ(value(text, 0, "scalar_Gain"), 65535);
    EXPECT_EQ(value(text, 0, "label"), -7);
    EXPECT_EQ(value(text, 0, "q"), double{1e-3f});
    for (const bool big : {false, true}) {
        Body body(big);
        body.put<uint8_t>(255).put(3.5).put<uint8_t>(2).put<int16_t>(7).put<int16_t>(8).put(1.5).put<uint8_t>(
            128);
        body.put<uint16_t>(65535).put(2.5).put<uint8_t>(0).put(-7).put(1e-3f);
        body.put<uint8_t>(1)
            .put(-3.0)
            .put<uint8_t>(0)
            .put(-1.0)
            .put<uint8_t>(2)
            .put<uint16_t>(4)
            .put(-2.0)
            .put<uint8_t>(3);
        body.put(5).put(6.25f);
        const auto binary = records_of(big ? "binary_big_endian" : "binary_little_endian", body.text);
        EXPECT_TRUE(binary.bytes == text.bytes) << big;
    }
}

TEST_F(Ply, FixedBinaryRecordsOfEveryTypeAreDecoded) {
    const std::string properties =
        "property char a\nproperty uchar b\nproperty short x\nproperty ushort y\nproperty int z\nproperty "
        "uint c\n"
        "property float d\nproperty double e\nproperty float nx\nproperty float ny\nproperty float nz\n";
    for (const bool big : {false, true}) {
        Body body(big);
        for (int i = 0; i < 5; ++i)
            body.put<int8_t>(-1)
                .put<uint8_t>(2)
                .put<int16_t>(-300)
                .put<uint16_t>(60000)
                .put(-70000 - i)
                .put(4000000000u)
                .put(0.5f)
                .put(0.25)
                .put(0.f)
                .put(0.f)
                .put(1.f);
        const auto r = read(
            header(big ? "binary_big_endian" : "binary_little_endian", "element vertex 5\n" + properties) +
            body.text);
        ASSERT_TRUE(r) << r.error().line();
        ASSERT_EQ(r->count, 5u);
        EXPECT_EQ(position(*r, 4), glm::dvec3(-300, 60000, -70004));
        const std::map<std::string_view, double> expected = {
            {"a", -1}, {"b", 2}, {"c", 4e9}, {"d", 0.5}, {"e", 0.25}};
        for (const auto& [name, number] : expected) EXPECT_EQ(value(*r, 4, name), number) << name;
        EXPECT_EQ(value(*r, 4, names::normal, 2), 1);
    }
}

TEST_F(Ply, FloatCoordinatesStayFloats) {
    const auto r = read(header("ascii", "element vertex 1\n" + kXyz) + "0.1 -0.2 3e20\n");
    ASSERT_TRUE(r);
    EXPECT_EQ(source_->schema().position, PositionType::f32);
    EXPECT_EQ(position(*r, 0), glm::dvec3(0.1f, -0.2f, 3e20f));
}

TEST_F(Ply, ColoursOfEveryKindBecomeColor) {
    struct Case {
        std::string type, prefix, values;
        ScalarType expected;
        uint32_t bits;
    };
    const std::vector<Case> cases = {
        {"uchar", "", "255 0 1", ScalarType::u8, 8},    {"char", "diffuse_", "-1 0 200", ScalarType::u8, 8},
        {"ushort", "", "255 0 1", ScalarType::u16, 8},  {"ushort", "", "65535 0 1", ScalarType::u16, 16},
        {"float", "", "1.0 0 0.5", ScalarType::f32, 0}, {"double", "", "255 0 0.5", ScalarType::f64, 8}};
    for (const Case& c : cases) {
        std::string properties = kXyz;
        for (const char* name : {"red", "green", "blue"})
            properties += "property " + c.type + " " + c.prefix + name + "\n";
        const auto r = read(header("ascii", "element vertex 1\n" + properties) + "1 2 3 " + c.values + "\n");
        ASSERT_TRUE(r) << r.error().line();
        EXPECT_EQ(source_->schema().find(names::color)->type, c.expected) << c.values;
        EXPECT_EQ(source_->info().color_bits, c.bits) << c.values;
    }
}

/// Returns points as text, all dark except the last ones.
std::string dark_points(int count, const std::string& more, const std::string& bright) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += "1 2 3 " + (i < count / 2 ? "1 2 3" : bright) + more + (i % 3 ? "\n" : "\n\n");
    return text;
}

TEST_F(Ply, ColoursOfTextAreLookedAtAllOverTheFile) {
    constexpr int kPoints = 50'000;
    std::string properties = fmt::format("element vertex {}\n", kPoints) + kXyz;
    for (const char* name : {"red", "green", "blue"})
        properties += std::string("property ushort ") + name + "\n";
    const auto source = open(header("ascii", properties) + dark_points(kPoints, "", "60000 1 2"));
    ASSERT_TRUE(source) << source.error().line();
    EXPECT_EQ((*source)->info().color_bits, 16u);
    properties += "property list uchar int l\n";
    const auto lists = open(header("ascii", properties) + dark_points(kPoints, " 2 7 8", "60000 1 2"));
    ASSERT_TRUE(lists) << lists.error().line();
    EXPECT_EQ((*lists)->info().color_bits, 16u);
}

TEST_F(Ply, NumbersOfOtherElementsAreNoColours) {
    constexpr int kPoints = 20'000;
    std::string properties = fmt::format("element vertex {}\n", kPoints) + kXyz;
    for (const char* name : {"red", "green", "blue"})
        properties += std::string("property ushort ") + name + "\n";
    const auto source =
        open(header("ascii",
                    properties + fmt::format("element edge {}\nproperty list uchar int l\n", 2 * kPoints)) +
             dark_points(kPoints, "", "255 0 1") + [] {
                 std::string edges;
                 for (int i = 0; i < 2 * kPoints; ++i) edges += "5 1 2 30000 30001 30002\n";
                 return edges;
             }());
    ASSERT_TRUE(source) << source.error().line();
    EXPECT_EQ((*source)->info().color_bits, 8u);
}

TEST_F(Ply, AnIncompleteOrMixedColourStaysSingleProperties) {
    const auto r =
        read(header("ascii",
                    "element vertex 1\n" + kXyz +
                        "property uchar red\nproperty float green\nproperty int blue\nproperty int color\n") +
             "1 2 3 4 5.5 6 7\n");
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_FALSE(source_->schema().find(names::color));
    EXPECT_EQ(value(*r, 0, "green"), 5.5);
    EXPECT_EQ(value(*r, 0, "ply_color"), 7);
}

TEST_F(Ply, OtherElementsAreSkippedWhereverTheyStand) {
    const std::string before =
        "element camera 2\nproperty list uint8 int parts\nproperty float f\nelement empty 0\nproperty int "
        "i\n";
    const std::string after = "element strip 1\nproperty list uchar int vertex_indices\n";
    const auto text = read(header("ascii", before + "element vertex 1\n" + kXyz + after) +
                           "2 1 2 0.5\n\n0 0.5\n1 2 3\n3 0 1 2\n");
    ASSERT_TRUE(text) << text.error().line();
    EXPECT_EQ(position(*text, 0), glm::dvec3(1, 2, 3));
    Body body(true);
    body.put<uint8_t>(2)
        .put(1)
        .put(2)
        .put(0.5f)
        .put<uint8_t>(0)
        .put(0.5f)
        .put(1.f)
        .put(2.f)
        .put(3.f)
        .put<uint8_t>(1)
        .put(0);
    const auto binary =
        read(header("binary_big_endian", before + "element vertex 1\n" + kXyz + after) + body.text);
    ASSERT_TRUE(binary) << binary.error().line();
    EXPECT_TRUE(binary->bytes == text->bytes);
}

TEST_F(Ply, LineEndsOfAllThreeSystemsAreUnderstood) {
    const std::string unix_text = header("ascii", "comment c\nelement vertex 2\n" + kXyz) + "1 2 3\n4 5 6\n";
    std::string dos, mac = unix_text;
    for (const char c : unix_text) dos += c == '\n' ? "\r\n" : std::string(1, c);
    std::replace(mac.begin(), mac.end(), '\n', '\r');
    const auto expected = read(unix_text);
    ASSERT_TRUE(expected);
    for (const auto& text : {dos, mac, unix_text.substr(0, unix_text.size() - 1)}) {
        const auto r = read(text);
        ASSERT_TRUE(r) << r.error().line();
        EXPECT_TRUE(r->bytes == expected->bytes);
    }
}

TEST_F(Ply, PointsThatAreNotFiniteAreDroppedAndCounted) {
    const auto r = read(header("ascii", "element vertex 6\n" + kXyz + "property float q\n") +
                        "1 2 3 nan\nnan 2 3 0\n1 inf 3 0\n1 2 -Infinity 0\n1 2 1e300 0\n4 5 6 inf\n");
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(r->count, 2u);
    EXPECT_EQ(r->dropped, 4u);
    EXPECT_EQ(position(*r, 1), glm::dvec3(4, 5, 6));
    EXPECT_TRUE(std::isnan(value(*r, 0, "q")));  // not a coordinate, so it is kept
}

TEST_F(Ply, NumbersDoNotDependOnTheLocale) {
    const std::string text = header("ascii", "element vertex 1\n" + kXyz) + "+1.5 2,5 3\n";
    expect_rejected(text, "'2,5' for its property y");
    std::setlocale(LC_ALL, "de_DE.UTF-8");  // has no effect if it is not installed
    const auto r = read(header("ascii", "element vertex 1\n" + kXyz) + "+1.5 2.5 1e-400\n");
    std::setlocale(LC_ALL, "C");
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(position(*r, 0), glm::dvec3(1.5, 2.5, 0));
}

TEST_F(Ply, WholeNumbersMustFitTheirType) {
    const auto line = [&](const std::string& type, const std::string& word) {
        return header("ascii", "element vertex 1\n" + kXyz + "property " + type + " v\n") + "1 2 3 " + word +
               "\n";
    };
    const std::vector<std::pair<std::string, std::string>> good = {
        {"uchar", "255"},    {"uchar", "17.0"},      {"char", "-128"},      {"short", "-32768"},
        {"ushort", "65535"}, {"int", "-2147483648"}, {"uint", "4294967295"}};
    const std::vector<std::pair<std::string, std::string>> bad = {
        {"uchar", "256"},   {"uchar", "-1"},     {"uchar", "1.5"},      {"char", "-129"},
        {"short", "32768"}, {"ushort", "65536"}, {"int", "2147483648"}, {"uint", "4294967296"},
        {"int", "1e99"},    {"int", "nan"},      {"int", "12x"},        {"float", "x"},
        {"float", "--1"},   {"float", "1e"}};
    for (const auto& [type, word] : good) EXPECT_TRUE(read(line(type, word))) << type << ' ' << word;
    for (const auto& [type, word] : bad) expect_rejected(line(type, word), "vertex 1 has '" + word + "'");
}

TEST_F(Ply, StationsAndOurOtherRemarksAreRead) {
    const auto r =
        read(header("ascii",
                    "comment lucarne station 4 1.5 -2 3\ncomment lucarne station 5 0 0 1\n"
                    "comment lucarne metres_per_unit 0.3048\ncomment anything\nelement vertex 0\n" +
                        kXyz));
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(r->count, 0u);
    ASSERT_EQ(source_->info().stations.size(), 2u);
    EXPECT_EQ(source_->info().stations[0].id, 4u);
    EXPECT_EQ(source_->info().stations[0].position, glm::dvec3(1.5, -2, 3));
    EXPECT_EQ(source_->info().metres_per_unit, 0.3048);
    for (const char* remark :
         {"station 4 1.5 -2", "station x 1 2 3", "station 4 1 2 nan", "color_bits 12", "metres_per_unit 0"})
        expect_rejected(
            header("ascii", std::string("comment lucarne ") + remark + "\nelement vertex 0\n" + kXyz),
            "cannot be understood");
}

TEST_F(Ply, MissingZIsZero) {
    const auto r =
        read(header("ascii", "element vertex 2\nproperty float y\nproperty float x\n") + "1 2\n3 4\n");
    ASSERT_TRUE(r);
    EXPECT_EQ(position(*r, 1), glm::dvec3(4, 3, 0));
}

TEST_F(Ply, HeadersWithoutSenseAreRejectedWithTheLine) {
    const std::string vertex = "element vertex 1\n" + kXyz;
    expect_rejected("ply\n", "ends inside its PLY header");
    expect_rejected("ply\n" + vertex + "end_header\n1 2 3\n", "without a format line");
    expect_rejected(header("ascii", ""), "no vertex element");
    expect_rejected(header("ascii", vertex + vertex), "several vertex elements");
    expect_rejected(header("ascii", "element vertex 1\nproperty float y\nproperty float z\n"),
                    "without a property x");
    expect_rejected(header("ascii", "element vertex 1\nproperty list uchar float x\nproperty float y\n"),
                    "without a property x");
    expect_rejected(header("ascii", "element vertex 1\n" + kXyz + "property int x\n"),
                    "line 7 of its PLY header: the property 'x' is named twice");
    expect_rejected(header("ascii", "property float x\n" + vertex), "before the first element");
    expect_rejected(header("ascii", "element vertex\n"), "a name and a count");
    expect_rejected(header("ascii", "element vertex -1\n"), "a name and a count");
    expect_rejected(header("ascii", "element vertex 99999999999999999999\n"), "a name and a count");
    expect_rejected(header("ascii", "element vertex 1\nproperty quux x\n"), "the type 'quux' is not known");
    expect_rejected(header("ascii", "element vertex 1\nproperty list float int x\n"),
                    "integer type for its length");
    expect_rejected(header("ascii", "elephant vertex 1\n"), "the word 'elephant' is not known");
    expect_rejected(header("binary_middle_endian", vertex), "the format 'binary_middle_endian' is not known");
    expect_rejected("ply\nformat ascii 2.0\n" + vertex + "end_header\n", "version '2.0'");
    expect_rejected("ply\ncomment " + std::string(3 << 20, 'x') + "\n", "1 MiB");
}

TEST_F(Ply, CountsThatLieAreRejected) {
    const std::string line = "1 2 3\n";
    expect_rejected(header("ascii", "element vertex 1000000000000\n" + kXyz) + line,
                    "1000000000000 entries of 'vertex'");
    expect_rejected(header("ascii", "element vertex 100\n" + kXyz) + line, "promises 100 points");
    expect_rejected(header("ascii", "element vertex 3\n" + kXyz) + "1.00 2.00 3.00\n1.00 2.00 3.00\n",
                    "ends early: its header promises 3 points, 2 are there");
    expect_rejected(header("ascii", "element vertex 1\n" + kXyz) + "1 2 3 4\n",
                    "more values than the header names");
    expect_rejected(header("ascii", "element vertex 1\n" + kXyz) + "1 2        \n",
                    "vertex 1 has no value for its property z");
    expect_rejected(header("binary_little_endian", "element vertex 2\n" + kXyz) + std::string(23, 'a'),
                    "promises 2 points, at most 1");
    expect_rejected(
        header("binary_little_endian", "element camera 200\nproperty double d\nelement vertex 0\n" + kXyz) +
            std::string(99, 'a'),
        "ends early");
    expect_rejected(
        header("binary_little_endian", "element vertex 1\n" + kXyz + "property list uint double l\n") +
            std::string(12, 'a') + "\xff\xff\xff\xff",
        "ends early");
    expect_rejected(
        header("binary_little_endian", "element vertex 1\n" + kXyz + "property list int double l\n") +
            std::string(12, 'a') + "\xff\xff\xff\xff",
        "negative length");
}

/// Returns a small file of each encoding, with lists and other elements.
std::vector<std::string> seeds() {
    const std::string parts =
        "comment lucarne station 1 2 3 4\nelement part 2\nproperty list uchar short l\nelement vertex 3\n" +
        kXyz + "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    std::vector<std::string> files = {header("ascii", parts) +
                                      "1 7\n0\n1 2 3 4 5 6\n-1 -2 -3 0 0 0\n1e5 0.5 .25 255 255 255\n"};
    for (const bool big : {false, true})
        for (const bool list : {false, true}) {
            Body body(big);
            body.put<uint8_t>(1).put<int16_t>(7).put<uint8_t>(0);
            for (int i = 0; i < 3; ++i) {
                body.put(1.f * static_cast<float>(i))
                    .put(2.f)
                    .put(3.f)
                    .put<uint8_t>(1)
                    .put<uint8_t>(2)
                    .put<uint8_t>(3);
                if (list) body.put<uint16_t>(1).put(0.5);
            }
            files.push_back(header(big ? "binary_big_endian" : "binary_little_endian",
                                   parts + (list ? "property list ushort double m\n" : "")) +
                            body.text);
        }
    return files;
}

TEST_F(Ply, AnyTruncationIsRejected) {
    for (const std::string& bytes : seeds()) {
        ASSERT_TRUE(read(bytes));
        // A cut within the last number of a text may go unnoticed.
        for (size_t length = 0; length + 6 < bytes.size(); ++length)
            EXPECT_FALSE(read(bytes.substr(0, length))) << length;
    }
}

TEST_F(Ply, ChangedBytesNeverCrashAndReadTheSameTwice) {
    Random random(5);
    size_t opened = 0;
    for (const std::string& good : seeds())
        for (int round = 0; round < 1500; ++round) {
            std::string bytes = good;
            for (uint64_t change = random.next() % 3 + 1; change-- > 0;) {
                const char special[] = {'\0', '\xff', '9', '-', ' ', '\n', static_cast<char>(random.next())};
                bytes[random.next() % bytes.size()] = special[random.next() % sizeof special];
            }
            const auto source = open(bytes);
            if (!source) continue;
            ++opened;
            const auto first = read_all(**source), second = read_all(**source, 1);
            ASSERT_EQ(first.has_value(), second.has_value()) << bytes;
            if (!first) continue;
            ASSERT_TRUE(first->bytes == second->bytes) << bytes;
        }
    EXPECT_GT(opened, 100u);
}

}  // namespace
}  // namespace lucarne::io
