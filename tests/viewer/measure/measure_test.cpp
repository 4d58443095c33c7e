#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "tests/viewer/measure/measured_scan.h"
#include "tests/viewer/program.h"
#include "viewer/measure/file.h"
#include "viewer/measure/model.h"
#include "viewer/measure/section/profile_raster.h"
#include "viewer/measure/section/section.h"
#include "viewer/overlay/axis_marks.h"
#include "viewer/picking/nearest.h"

namespace lucarne::viewer {
namespace {

using glm::dvec3;
using test::MeasuredScan;
using testing::HasSubstr;

constexpr dvec3 kFarAway{499'875.25, 5'412'336.5, 437.125};  // UTM; a double steps by 1e-9 there

Measurement make(MeasureKind kind, const std::vector<dvec3>& at, double thickness = 0) {
    Measurement m{kind, "", {}, thickness};
    for (const dvec3& p : at) {
        ExactPoint& point = m.points.emplace_back();
        point.position = p;
        point.coordinates = {fmt::format("{}", p.x), fmt::format("{}", p.y), fmt::format("{}", p.z)};
    }
    return m;
}

double value(const Measurement& m, std::string_view name) {
    for (const Quantity& q : quantities(m))
        if (q.name == name) return q.value;
    return NAN;
}

TEST(Measure, DistancesAndHeightsAreThoseOfGeometry) {
    const Measurement d = make(MeasureKind::distance, {kFarAway, kFarAway + dvec3(3, -4, 12)});
    EXPECT_NEAR(value(d, "length"), 13, 1e-9);
    EXPECT_NEAR(value(d, "horizontal"), 5, 1e-9);
    EXPECT_NEAR(value(d, "dy"), -4, 1e-9);
    const Measurement h = make(MeasureKind::height, {kFarAway, kFarAway + dvec3(1, 1, -2.5)});
    EXPECT_NEAR(value(h, "height"), -2.5, 1e-9);
    EXPECT_NEAR(value(h, "horizontal"), std::numbers::sqrt2, 1e-9);
    const Measurement p = make(MeasureKind::path, {kFarAway, kFarAway + dvec3(1, 0, 0),
                                                   kFarAway + dvec3(1, 2, 0), kFarAway + dvec3(1, 2, -3)});
    EXPECT_NEAR(value(p, "length"), 6, 1e-9);
    EXPECT_NEAR(value(p, "horizontal"), 3, 1e-9);
    EXPECT_NEAR(value(p, "segment 2"), 2, 1e-9);
}

TEST(MeasureModel, TheToolsMessageEndsWithTheTool) {
    MeasureModel measure;
    measure.start(MeasureKind::distance);
    EXPECT_EQ(measure.message, "Distance: click two points");
    EXPECT_EQ(measure.prompt, measure.message);
    measure.stop();
    EXPECT_EQ(measure.message, "") << "not shown yet, and not to be shown";
    measure.start(MeasureKind::distance);
    measure.take(ExactPoint{});
    EXPECT_EQ(measure.prompt, measure.message) << "the first point's coordinates";
    measure.take(ExactPoint{});
    EXPECT_EQ(measure.message, "Distance 1");
    measure.stop();
    EXPECT_EQ(measure.message, "Distance 1") << "a result stays";
}

TEST(Measure, AnglesAreExactDownToNoneAndUpToAStraightLine) {
    for (const double degrees : {0.0, 1e-3, 30.0, 90.0, 135.0, 179.999, 180.0}) {
        const double a = degrees / 180 * std::numbers::pi;
        const dvec3 corner = kFarAway, axis = glm::normalize(dvec3(1, 2, 3));
        const dvec3 side = glm::normalize(glm::cross(axis, dvec3(0, 0, 1)));
        const dvec3 other = side * std::cos(a) + glm::cross(axis, side) * std::sin(a);
        const Measurement m = make(MeasureKind::angle, {corner + side * 7.0, corner, corner + other * 2.0});
        EXPECT_NEAR(value(m, "angle"), a, 1e-9) << degrees;
    }
}

TEST(Measure, AreasDoNotCancelAtProjectedCoordinatesHoweverThePolygonLies) {
    // An L of 3 m^2, turned by 50 degrees about a horizontal axis.
    const std::vector<dvec3> corners = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
    const double tilt = 50.0 / 180 * std::numbers::pi;
    const glm::dquat turn = glm::angleAxis(tilt, glm::normalize(dvec3(1, 0.4, 0)));
    std::vector<dvec3> at;
    for (const dvec3& c : corners) at.push_back(kFarAway + turn * c);
    const Measurement m = make(MeasureKind::area, at);
    EXPECT_NEAR(value(m, "area"), 3, 1e-8) << "the corners themselves are off by 1e-9";
    EXPECT_NEAR(value(m, "horizontal area"), 3 * std::cos(tilt), 1e-8);
    EXPECT_NEAR(value(m, "perimeter"), 8, 1e-8);
    EXPECT_NEAR(value(m, "off plane"), 0, 1e-8);
    EXPECT_EQ(value(make(MeasureKind::area, {kFarAway, kFarAway, kFarAway}), "area"), 0);
}

TEST(Measure, ResultsAreShownInMetresOrInTheFilesOwnUnit) {
    const UnitChoice metres{true, 1200.0 / 3937}, own{false, 1200.0 / 3937};
    EXPECT_EQ(metres.text(3937, Dimension::length), "1200.0000 m");
    EXPECT_EQ(own.text(3937, Dimension::length), "3937.0000 US ft");
    EXPECT_NEAR(metres.convert(10, Dimension::area), 10 * std::pow(1200.0 / 3937, 2), 1e-12);
    EXPECT_EQ(own.text(std::numbers::pi / 2, Dimension::angle), "90.000 degrees");
    EXPECT_EQ(unit_name(0.3048), "ft");
    EXPECT_EQ(unit_name(2.5), "units of 2.5 m");
}

TEST(Measure, JsonGivesEveryBitBackAndCsvTheDigitsOfTheFile) {
    Measurement m = make(MeasureKind::distance, {{0.1, 1e-17, 1.0 / 3}, {5e5 + 1e-9, -2, 3}});
    m.name = "wall, \"east\"";
    m.points[0].coordinates = {"0.100", "0.000", "0.333"};
    m.points[0].fields = {{"classification", "2 ground"}};
    const Measurement s = make(MeasureKind::section, {{0, 0, 0}, {1, 0, 0}}, 0.25);
    const auto read = parse_measurements(measurements_json(std::vector{m, s}, 0.3048), "test", 0.3048);
    ASSERT_TRUE(read) << read.error().line();
    ASSERT_EQ(read->size(), 2u);
    EXPECT_EQ((*read)[0].name, m.name);
    for (size_t i = 0; i < 2; ++i) EXPECT_EQ((*read)[0].points[i].position, m.points[i].position);
    EXPECT_EQ((*read)[0].points[0].coordinates, m.points[0].coordinates);
    EXPECT_EQ((*read)[0].points[0].fields, m.points[0].fields);
    EXPECT_EQ((*read)[1].thickness, 0.25);
    const std::string csv = measurements_csv(std::vector{m}, {false, 0.3048});
    EXPECT_THAT(
        csv,
        HasSubstr("\"wall, \"\"east\"\"\",distance,point 1,,,0.100,0.000,0.333,classification=2 ground\n"));
    EXPECT_THAT(csv, HasSubstr(",length,"));
}

TEST(Measure, AWrongFileIsRefusedWithThePlace) {
    const auto refused = [](const std::string& text) {
        const auto read = parse_measurements(text, "m.json", 1);
        return read ? "accepted" : read.error().line();
    };
    EXPECT_THAT(refused("{"), HasSubstr("line 1"));
    EXPECT_THAT(refused(R"({"metres_per_unit": 0.3048, "measurements": []})"), HasSubstr("measured in ft"));
    EXPECT_THAT(refused(R"({"measurements": [{"kind": "volume", "points": []}]})"),
                HasSubstr("/measurements/0/kind"));
    EXPECT_THAT(refused(R"({"measurements": [{"kind": "angle", "points": [{"position": [0, 0, 0]}]}]})"),
                HasSubstr("1 points"));
    EXPECT_THAT(refused(R"({"measurements": [{"kind": "point", "points": [{"position": [0, 1e999, 0]}]}]})"),
                HasSubstr("m.json"));
    EXPECT_THAT(
        refused(R"({"measurements": [{"kind": "point", "points": [{"position": [0, 0, 0]}], "x": 1}]})"),
        HasSubstr("/x"));
}

TEST(Measure, ToolsTakeTheirPointsAndEveryChangeCanBeRestored) {
    MeasureModel model;
    const auto click = [&](double x) { model.take(make(MeasureKind::point, {{x, 0, 0}}).points[0]); };
    click(1);
    EXPECT_TRUE(model.list.all().empty()) << "no tool";
    model.start(MeasureKind::distance);
    click(1);
    EXPECT_FALSE(model.finish());
    click(4);
    ASSERT_EQ(model.list.all().size(), 1u);
    EXPECT_EQ(model.list.all()[0].name, "Distance 1");
    EXPECT_EQ(value(*model.selected_one(), "length"), 3);
    EXPECT_TRUE(model.tool) << "ready for the next";
    model.start(MeasureKind::path);
    for (const double x : {0.0, 1.0, 9.0}) click(x);
    model.drop_last();
    EXPECT_TRUE(model.finish());
    EXPECT_EQ(value(model.list.all()[1], "length"), 1);
    const MeasureList::State unnamed = model.list.state();
    model.list.rename(0, "wall");
    const MeasureList::State named = model.list.state();
    model.selected = 0;
    model.remove_selected();
    EXPECT_EQ(model.list.all().size(), 1u);
    model.list.become(named);
    EXPECT_EQ(model.list.all()[0].name, "wall");
    model.list.become(unnamed);
    EXPECT_EQ(model.list.all()[0].name, "Distance 1");
    model.list.remove(0);
    model.copy_selected();
    const auto commands = model.commands.take();
    ASSERT_EQ(commands.size(), 1u);
    EXPECT_THAT(std::get<CopyText>(commands[0]).text, HasSubstr("Path 1"));
}

TEST(Measure, AxesHaveRoundMarksAndEndWhereverTheyLie) {
    EXPECT_NEAR(axis_step(10, 10), 1, 1e-12);
    EXPECT_NEAR(axis_step(37, 8), 5, 1e-12);
    EXPECT_EQ(axis_marks(-0.4, 1.1, 0.5), (std::vector<double>{0, 0.5, 1}));
    EXPECT_EQ(axis_text(-1e-17, 0.5), "0.0");
    EXPECT_EQ(axis_text(812.25, 0.05), "812.25");
    EXPECT_LE(axis_marks(1e20, 1e20 + 1e6, 1).size(), 100u) << "steps that a double does not make";
}

class MeasuredCloud : public testing::Test {
 protected:
    static void SetUpTestSuite() { scan_ = new MeasuredScan; }
    static void TearDownTestSuite() { delete std::exchange(scan_, nullptr); }
    static MeasuredScan* scan_;
    NodeCache cache_{scan_->source};
};
MeasuredScan* MeasuredCloud::scan_ = nullptr;

TEST_F(MeasuredCloud, TheNearestPointIsThatOfAllPoints) {
    lucarne::Random random(5);
    for (int i = 0; i < 30; ++i) {
        const dvec3 place = MeasuredScan::kCorner + dvec3(random.uniform() * 6 - 1, random.uniform() * 4 - 1,
                                                          random.uniform() * 5 - 1);
        double best = INFINITY;
        for (uint64_t n = 0; n < 2 * MeasuredScan::kWall; ++n)
            best = std::min(best, glm::distance(MeasuredScan::position(n), place));
        const auto found = nearest_point(cache_, place, INFINITY);
        ASSERT_TRUE(found && *found);
        EXPECT_NEAR(glm::distance((*found)->position, place), best, 1e-8);
        EXPECT_FALSE(*nearest_point(cache_, place, best * 0.99));
    }
}

TEST_F(MeasuredCloud, ASectionHoldsExactlyThePointsOfItsSlice) {
    const Slice slice{MeasuredScan::kCorner + dvec3(0.3, -1, 7), MeasuredScan::kCorner + dvec3(3.1, 2.5, -9),
                      0.4};
    const dvec3 u = glm::normalize(dvec3(2.8, 3.5, 0));
    size_t expected = 0;
    for (uint64_t n = 0; n < 2 * MeasuredScan::kWall; ++n) {
        const dvec3 d = MeasuredScan::position(n) - slice.from;
        const double along = glm::dot(d, u), across = d.y * u.x - d.x * u.y;
        expected += along >= 0 && along <= std::hypot(2.8, 3.5) && std::abs(across) <= 0.2;
    }
    const auto always = [](const Section&, bool) { return true; };
    const auto section = read_section(*scan_->source, slice, kMostSectionPoints, always);
    ASSERT_TRUE(section);
    EXPECT_GT(expected, 200u);
    EXPECT_EQ(section->points.size(), expected);
    EXPECT_TRUE(section->complete);
    EXPECT_NEAR(section->lowest, MeasuredScan::kCorner.z, 1e-9);
    EXPECT_NEAR(section->highest, MeasuredScan::kCorner.z + 3, 1e-9);
    const auto bounded = read_section(*scan_->source, slice, 100, always);
    ASSERT_TRUE(bounded);
    EXPECT_LE(bounded->points.size(), 100u);
    EXPECT_FALSE(bounded->complete);
    EXPECT_FALSE(read_section(*scan_->source, {slice.from, slice.from, 1}, 100, always)) << "no length";
    const ProfileRaster raster = rasterize(*section, 200, 100);
    EXPECT_GT(raster.dots.size(), 100u);
    for (const auto& dot : raster.dots) EXPECT_TRUE(dot.x < 200 && dot.y < 100);
}

/// Two points of the same medium grey: one of a scan with 8-bit colours in 16 bits, one of a scan with full
/// 16-bit colours.
class TwoWhites final : public octree::NodeSource {
 public:
    TwoWhites() : nodes_(1) {
        io::Schema& schema = header_.schema;
        schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
        schema.add(std::string(io::names::color), io::ScalarType::u16, 3);
        schema.add(std::string(io::names::scan), io::ScalarType::u16);
        header_.root = {dvec3(0.0), 1.0};
        header_.max = dvec3(1.0);
        header_.scans.resize(2);
        header_.scans[0].color_bits = 8;
        header_.scans[1].color_bits = 16;
        nodes_[0].count = 2;
    }
    const octree::SourceHeader& header() const override { return header_; }
    octree::NodeTable nodes() const override { return nodes_; }
    Result<octree::NodeData> load(uint32_t) const override {
        const io::Schema& schema = header_.schema;
        octree::NodeData data{2, std::vector<std::byte>(size_t{2} * schema.stride)};
        for (uint16_t i = 0; i < 2; ++i) {
            std::byte* record = &data.records[size_t{i} * schema.stride];
            for (size_t axis = 0; axis < 3; ++axis) io::store(record + 8 * axis, 0.5);
            for (size_t c = 0; c < 3; ++c)
                io::store(record + schema.find(io::names::color)->offset + 2 * c,
                          static_cast<uint16_t>(i == 0 ? 128 : 128 * 257));
            io::store(record + schema.find(io::names::scan)->offset, i);
        }
        return data;
    }

 private:
    octree::SourceHeader header_;
    std::vector<octree::NodeInfo> nodes_;
};

TEST(Section, ColoursHaveTheWhiteOfTheirScan) {
    const auto section = read_section(TwoWhites(), {{0, 0.5, 0}, {1, 0.5, 0}, 1}, 100,
                                      [](const Section&, bool) { return true; });
    ASSERT_TRUE(section) << section.error().line();
    ASSERT_EQ(section->points.size(), 2u);
    for (const SectionPoint& point : section->points) EXPECT_EQ(point.color[0], 128);
}

TEST_F(MeasuredCloud, TheCommandMeasuresWhatTheWindowSaved) {
    const std::string cache = scan_->file(), json = scan_->folder / "m.json";
    const std::vector<Measurement> all = {
        make(MeasureKind::distance, {MeasuredScan::position(0), MeasuredScan::position(80)}),
        make(MeasureKind::section,
             {MeasuredScan::kCorner + dvec3(1, -1, 0), MeasuredScan::kCorner + dvec3(1, 3, 0)}, 0.12)};
    ASSERT_TRUE(save_measurements(json, all, {true, MeasuredScan::kFoot}, false));
    const auto out = test::lucarne("measure " + cache + " --measurements " + json +
                                   " --snap --results file --sections " + scan_->folder.path().string());
    EXPECT_EQ(out.code, 0) << out.output;
    EXPECT_THAT(out.output, HasSubstr("length: 4.0000 US ft"));
    EXPECT_THAT(out.output, HasSubstr("1567890.123 245678.457 812.006"));
    EXPECT_THAT(out.output, HasSubstr("classification=6 Building"));
    const std::string csv = test::bytes_of(scan_->folder / "section-1.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 61 * 2)
        << "three columns of each wall, and a head";
    EXPECT_THAT(csv, HasSubstr("along,across,height,x,y,z,intensity,classification,gps_time,number\n"));
    EXPECT_THAT(test::bytes_of(scan_->folder / "section-1.svg"), HasSubstr("<circle"));
    const auto at = test::lucarne("measure " + cache + " --at 1567890.1,245678.4,812");
    EXPECT_THAT(at.output, HasSubstr("number=0;"));
    EXPECT_EQ(test::lucarne("measure " + cache).code, 2) << "nothing to measure";
    EXPECT_EQ(test::lucarne("measure " + cache + " --measurements " + json + " -o x.txt").code, 2);
}

TEST(MeasureList, ThatBeginsAgainHasNothingToSave) {
    MeasureList list;
    list.replace({{MeasureKind::point, "a", {ExactPoint{}}, 0}});
    list.restart({{MeasureKind::point, "b", {ExactPoint{}}, 0}});
    ASSERT_EQ(list.all().size(), 1u);
    EXPECT_EQ(list.all()[0].name, "b");
    EXPECT_FALSE(list.unsaved());
}

}  // namespace
}  // namespace lucarne::viewer
