#include "gi/surfels/colouring.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/attributes.h"

namespace lucarne::gi {
namespace {

/// One node of 16 m with points of every attribute that can be shown.
class Points : public octree::NodeSource {
 public:
    Points() {
        header_.root = {{0, 0, 0}, 16};
        header_.max = glm::dvec3(16);
        header_.schema.add("color", io::ScalarType::u8, 3);
        header_.schema.add("intensity", io::ScalarType::u16);
        header_.schema.add("classification", io::ScalarType::u8);
        header_.schema.add("return_number", io::ScalarType::u8);
        header_.schema.add("scan", io::ScalarType::u16);
        header_.schema.add("normal", io::ScalarType::f32, 3);
        header_.schema.add("warmth", io::ScalarType::f64, 2);
        header_.scans.resize(1);
        nodes_.resize(1);
    }
    void add(double z, int intensity, int cls, int return_number, int scan, const glm::vec3& normal,
             double second_warmth) {
        const size_t start = data_.records.size();
        data_.records.resize(start + header_.schema.stride);
        std::byte* record = data_.records.data() + start;
        const auto put = [&](const char* name, size_t component, double value) {
            const io::Attribute& a = *header_.schema.find(name);
            io::store_scalar(a.type, record + a.offset + component * io::scalar_bytes(a.type), value);
        };
        io::store(record, 1.0);
        io::store(record + 8, 1.0);
        io::store(record + 16, z);
        put("color", 0, 255);
        put("intensity", 0, intensity);
        put("classification", 0, cls);
        put("return_number", 0, return_number);
        put("scan", 0, scan);
        for (size_t i = 0; i < 3; ++i) put("normal", i, normal[static_cast<int>(i)]);
        put("warmth", 1, second_warmth);
        nodes_[0].count = ++data_.count;
        ++header_.points;
    }
    const octree::SourceHeader& header() const override { return header_; }
    octree::NodeTable nodes() const override { return nodes_; }
    Result<octree::NodeData> load(uint32_t) const override { return data_; }

    PackedSurfel packed(const Look& look, size_t point = 0, uint32_t first_scan = 0) const {
        Scene scene;
        scene.materials.resize(1);
        scene.look = look;
        return pack_surfels(header_, nodes_[0], data_, scene, first_scan)[point];
    }
    /// sRGB, 0 to 1.
    glm::vec3 colour(const Look& look, size_t point = 0, uint32_t first_scan = 0) const {
        const uint32_t d = packed(look, point, first_scan).d;
        return glm::vec3(static_cast<float>(d & 1023u), static_cast<float>(d >> 10 & 1023u),
                         static_cast<float>(d >> 20 & 1023u)) /
               1023.0f;
    }

 private:
    octree::SourceHeader header_;
    std::vector<octree::NodeInfo> nodes_;
    octree::NodeData data_;
};

constexpr float kStep = 1.0f / 1023;  // of a channel as devices hold it
#define EXPECT_COLOUR(found, wanted) EXPECT_LE(glm::distance(found, wanted), 2 * kStep)

Look by(ColourBy colour, std::optional<ValueRange> range = {}) {
    Look look;
    look.colour = colour;
    look.range = range;
    return look;
}

TEST(Colouring, EveryAttributeGivesItsPointsTheColoursOfItsKey) {
    Points points;
    points.add(4, 250, 6, 2, 3, {0, 0, 1}, 0.75);
    EXPECT_COLOUR(points.colour(by(ColourBy::colour)), glm::vec3(1, 0, 0));
    EXPECT_COLOUR(points.colour(by(ColourBy::intensity, ValueRange{0, 1000})),
                  mapped_colour(ColourMap::viridis, 0.25));
    EXPECT_COLOUR(points.colour(by(ColourBy::elevation, ValueRange{2, 6})),
                  mapped_colour(ColourMap::viridis, 0.5));
    EXPECT_COLOUR(points.colour(by(ColourBy::classification)), class_colour(6));
    EXPECT_COLOUR(points.colour(by(ColourBy::return_number)), ordinal_colour(2));
    EXPECT_COLOUR(points.colour(by(ColourBy::scan)), ordinal_colour(3));
    EXPECT_COLOUR(points.colour(by(ColourBy::scan), 0, 5), ordinal_colour(8)) << "of several inputs";
    EXPECT_COLOUR(points.colour(by(ColourBy::normal)), glm::vec3(0.5f, 0.5f, 1.0f));
    EXPECT_COLOUR(points.colour(by(ColourBy::clay)), glm::vec3(0.8f, 0.78f, 0.75f));
    Look warmth = by(ColourBy::attribute, ValueRange{0, 1});
    warmth.attribute = "warmth.1";
    warmth.map = ColourMap::grey;
    EXPECT_COLOUR(points.colour(warmth), glm::vec3(0.75f));
    warmth.reversed = true;
    EXPECT_COLOUR(points.colour(warmth), glm::vec3(0.25f));
}

TEST(Colouring, ValuesBeyondTheRangeHaveItsEndsColours) {
    Points points;
    points.add(4, 10, 0, 0, 0, {0, 0, 1}, std::nan(""));
    EXPECT_COLOUR(points.colour(by(ColourBy::intensity, ValueRange{20, 30})),
                  mapped_colour(ColourMap::viridis, 0));
    EXPECT_COLOUR(points.colour(by(ColourBy::intensity, ValueRange{1, 5})),
                  mapped_colour(ColourMap::viridis, 1));
    EXPECT_COLOUR(points.colour(by(ColourBy::intensity, ValueRange{10, 10})),
                  mapped_colour(ColourMap::viridis, 1));
    Look warmth = by(ColourBy::attribute, ValueRange{0, 1});
    warmth.attribute = "warmth.1";
    EXPECT_COLOUR(points.colour(warmth), mapped_colour(ColourMap::viridis, 0)) << "no number";
}

TEST(Colouring, PointsWithoutTheAttributeAreGrey) {
    Points points;
    points.add(4, 10, 0, 0, 0, {0, 0, 0}, 0);
    Look absent = by(ColourBy::attribute);
    for (const char* name : {"absent", "warmth.2", "warmth.x", "intensity.0.0", ""}) {
        absent.attribute = name;
        EXPECT_COLOUR(points.colour(absent), glm::vec3(0.5f)) << name;
        EXPECT_EQ(points.colour(by(ColourBy::normal)), points.colour(absent));
    }
    absent.attribute = "absent";
    const auto checked = check_attribute(points, absent);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().kind, ErrorKind::arguments);
    EXPECT_NE(checked.error().line().find("warmth"), std::string::npos) << "says what there is";
    EXPECT_TRUE(check_attribute(points, by(ColourBy::intensity)));
}

TEST(Colouring, MeasuredRangesLeaveOutTheOutermostPercent) {
    Points points;
    for (int i = 0; i < 1000; ++i) points.add(i * 0.001, i, 0, 0, 0, {0, 0, 1}, i == 500 ? INFINITY : i);
    for (int i = 0; i < 5; ++i) points.add(15, 60000, 0, 0, 0, {0, 0, 1}, 1e300);
    const auto range = [](const Points& of, ColourBy colour) {
        return measured_values(of, by(colour)).range;
    };
    const auto intensity = range(points, ColourBy::intensity), elevation = range(points, ColourBy::elevation);
    ASSERT_TRUE(intensity && elevation);
    EXPECT_NEAR(intensity->low, 10, 1);
    EXPECT_NEAR(intensity->high, 995, 2);
    EXPECT_NEAR(elevation->high, 0.995, 0.002);
    EXPECT_FALSE(range(points, ColourBy::classification)) << "classes have no range";
    EXPECT_FALSE(range(Points(), ColourBy::intensity)) << "no point, no range";
}

TEST(Colouring, MeasuredNumbersAreThoseThatPointsHave) {
    Points points;
    points.add(1, 0, 2, 1, 4, {0, 0, 1}, 0);
    points.add(1, 0, 6, 3, 4, {0, 0, 1}, 0);
    const auto returns = measured_values(points, by(ColourBy::return_number));
    EXPECT_TRUE(returns.classes.count() == 2 && returns.classes[2] && returns.classes[6]);
    EXPECT_TRUE(returns.numbers.count() == 2 && returns.numbers[1] && returns.numbers[3]);
    const auto scans = measured_values(points, by(ColourBy::scan));
    EXPECT_TRUE(scans.numbers.count() == 1 && scans.numbers[4]);
}

TEST(Colouring, HiddenClassesHaveNoDiscAndNoShareOfTheSurface) {
    Points points;
    points.add(1, 0, 7, 0, 0, {0, 0, 1}, 0);
    points.add(1, 0, 2, 0, 0, {0, 0, 1}, 0);
    Look look;
    look.hidden_classes.set(7);
    const PackedSurfel noise = points.packed(look, 0), ground = points.packed(look, 1);
    EXPECT_TRUE(surfel_is_stray(noise.b, noise.d));
    EXPECT_FALSE(surfel_is_stray(ground.b, ground.d));
}

TEST(ColourMaps, RunFromEndToEndWithoutAJump) {
    for (size_t map = 0; map < colour_map_names().size(); ++map) {
        glm::vec3 last = mapped_colour(static_cast<ColourMap>(map), 0);
        for (int i = 1; i <= 1000; ++i) {
            const glm::vec3 next = mapped_colour(static_cast<ColourMap>(map), i / 1000.0);
            EXPECT_LT(glm::distance(last, next), 0.01f) << colour_map_names()[map] << " at " << i;
            last = next;
        }
    }
}

TEST(ColourMaps, ThoseForOrderedValuesGrowLighterAllAlong) {
    for (const ColourMap map : {ColourMap::viridis, ColourMap::cividis, ColourMap::magma, ColourMap::grey}) {
        const auto luminance = [&](int i) {
            const glm::vec3 c = mapped_colour(map, i / 64.0);
            return 0.2126f * srgb_to_linear(c.x) + 0.7152f * srgb_to_linear(c.y) +
                   0.0722f * srgb_to_linear(c.z);
        };
        for (int i = 0; i < 64; ++i) EXPECT_LT(luminance(i), luminance(i + 1)) << i;
    }
}

TEST(Classes, NamesAreThoseOfTheSpecification) {
    EXPECT_EQ(class_name(2), "Ground");
    EXPECT_EQ(class_name(6), "Building");
    EXPECT_EQ(class_name(9), "Water");
    EXPECT_EQ(class_name(40), "Reserved");
    EXPECT_EQ(class_name(200), "User class");
    for (const ClassLook& named : named_classes()) EXPECT_EQ(class_name(named.number), named.name);
}

TEST(BakedLight, CoordinatesThatAreNoNumbersReadAndWriteNothingOutsideTheCells) {
    const double nan = std::nan("");
    Points points;
    for (const double z : {1.0, nan, 9.0}) points.add(z, 0, 0, 0, 0, glm::vec3(0), 0);
    const auto baked = BakedLight::measured(points);
    ASSERT_TRUE(baked);
    const double factor = baked->factor(glm::dvec3(nan), 1);
    EXPECT_GE(factor, 1.0 / 8);
    EXPECT_LE(factor, 8);
}

}  // namespace
}  // namespace lucarne::gi
