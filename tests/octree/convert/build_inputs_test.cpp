// The common unit of several inputs.
#include "octree/convert/build_inputs.h"

#include <deque>

#include <gtest/gtest.h>

#include "octree/convert/scans/unify.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

constexpr double kFoot = 0.3048;

class Units : public ::testing::Test {
 protected:
    io::ScanInfo& add(const std::string& path, double metres_per_unit, const std::string& system = "",
                      uint64_t points = 10) {
        auto& source = sources_.emplace_back(io::Schema{}, points, [](uint64_t, std::byte*) {});
        source.info().path = path;
        source.info().metres_per_unit = metres_per_unit;
        source.info().coordinate_system = system;
        source.info().unit_stated = !system.empty();
        return source.info();
    }
    Unifier unified() const {
        std::vector<const io::PointSource*> all;
        for (const auto& source : sources_) all.push_back(&source);
        return Unifier::create(all).value();
    }

    std::deque<test::ComputedSource> sources_;
};

TEST_F(Units, FilesWithoutPointsDecideNothingAndStopNothing) {
    add("empty.las", kFoot, "feet", 0);
    add("a.las", 1, "UTM");
    add("b.e57", 1).unit_stated = true;
    const Unifier inputs = unified();
    EXPECT_EQ(common_unit(inputs), 1.0);
    EXPECT_TRUE(check_units(inputs));
}

TEST_F(Units, TheMostFilesThatStateOneDecideWhereverTheyStand) {
    add("feet.las", kFoot, "feet");
    add("a.las", 1, "UTM");
    add("b.ptx", 1).unit_stated = true;
    const auto checked = check_units(unified());
    EXPECT_EQ(common_unit(unified()), 1.0);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().what, "feet.las");
    EXPECT_NE(checked.error().line().find("a unit of 0.3048 m, the other inputs have one of 1 m"),
              std::string::npos);
    EXPECT_NE(checked.error().todo.find("--unit"), std::string::npos);
}

TEST_F(Units, DigitsOfAFootThatAProgramLeftOutMakeNoOtherUnit) {
    add("gdal.las", 0.3048006096012192, "a system");
    add("short.las", 0.3048006096, "a system");
    EXPECT_TRUE(check_units(unified()));
    add("feet.las", kFoot, "feet");  // 2e-6 shorter
    EXPECT_EQ(check_units(unified()).error().what, "feet.las");
    add("metre.las", 1, "UTM");
    EXPECT_EQ(common_unit(unified()), 0.3048006096012192) << "both count";
}

TEST_F(Units, OfTwoUnitsAsOftenStatedTheFirstDecides) {
    add("feet.las", kFoot, "feet");
    add("a.las", 1, "UTM");
    EXPECT_EQ(common_unit(unified()), kFoot);
    EXPECT_EQ(check_units(unified()).error().what, "a.las");
}

TEST_F(Units, FilesThatStateNoneAreInThatOfTheOthers) {
    add("rows.xyz", 1);
    add("feet.las", kFoot, "feet");
    add("mesh.obj", 1);
    const Unifier inputs = unified();
    EXPECT_EQ(common_unit(inputs), kFoot);
    EXPECT_TRUE(check_units(inputs));
    for (const auto& scan : header_of(inputs, {}, inputs.schema()).scans)
        EXPECT_EQ(scan.metres_per_unit, kFoot);
}

TEST_F(Units, ColoursOf8BitsAmongOthersOf16HaveTheirWhite) {
    for (const auto type : {io::ScalarType::u8, io::ScalarType::u16, io::ScalarType::u16}) {
        io::Schema schema;
        schema.add(std::string(io::names::color), type, 3);
        auto& source = sources_.emplace_back(schema, 10, [](uint64_t, std::byte*) {});
        source.info().color_bits = sources_.size() == 2 ? 16 : 8;
    }
    const Unifier inputs = unified();
    const auto header = header_of(inputs, {}, inputs.schema());
    EXPECT_EQ(header.scans[0].color_bits, 16u) << "8-bit colours became 16-bit ones";
    EXPECT_EQ(header.scans[1].color_bits, 16u);
    EXPECT_EQ(header.scans[2].color_bits, 8u) << "stay as they are in their 16 bits";
}

TEST_F(Units, ColoursThatNoSampleMetCorrectTheWhite) {
    io::Schema schema;
    schema.add(std::string(io::names::color), io::ScalarType::u16, 3);
    sources_.emplace_back(schema, 10, [](uint64_t, std::byte*) {}).info().color_bits = 8;
    const Unifier inputs = unified();
    ScanFacts facts;
    facts.inputs.push_back({.points = 10, .color_bits = 16});
    EXPECT_EQ(header_of(inputs, facts, inputs.schema()).scans[0].color_bits, 16u);
    facts.inputs[0].color_bits = 8;
    EXPECT_EQ(header_of(inputs, facts, inputs.schema()).scans[0].color_bits, 8u);
}

TEST_F(Units, WhereNoneStatesOneItIsTheMetre) {
    add("rows.xyz", 1);
    add("mesh.obj", 1);
    EXPECT_EQ(common_unit(unified()), 1.0);
    EXPECT_TRUE(check_units(unified()));
}

}  // namespace
}  // namespace lucarne::octree
