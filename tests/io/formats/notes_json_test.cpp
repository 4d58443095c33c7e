// The notes of a scan as the JSON text that caches hold. The texts here are from caches that were written
// earlier.
#include "io/formats/notes_json.h"

#include <cmath>

#include <gmock/gmock.h>

#include "io/core/random.h"
#include "io/formats/las/crs.h"
#include "io/formats/las/extras.h"
#include "io/formats/las/header.h"
#include "io/points.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kLas =
    R"({"color_bits":16,"creation_day":5,"creation_year":2020,"file_source_id":3,"format":"las",)"
    R"("global_encoding":17,"guid":"AAECAwQFBgcICQoLDA0ODw==","minor_version":4,"offset":[0.0,-5.5,1e+20],)"
    R"("point_format":7,"record_length":40,"records":[{"data":"aGVsbG8=","description":"a record",)"
    R"("extended":false,"record_id":7,"user_id":"someone"}],"scale":[0.01,0.001,0.001],)"
    R"("software":"S","system_id":"T"})";

const std::array kTexts = {
    std::string("{}"),
    std::string(kLas),
    std::string(R"({"color_bits":8,"comments":["a","b c"],"format":"ply","obj_info":[],"properties":[)"
                R"({"name":"x","type":"double"},{"name":"red","type":"uchar"}]})"),
    std::string(
        R"({"color_bits":8,"format":"pcd","height":1,"viewpoint":[1.5,0.0,0.0,1.0,0.0,0.0,0.0],"width":213})"),
    std::string(
        R"({"color_bits":8,"coordinate_system":"","guid":"{F}","image_count":2000,"images":[{"bytes":1,"encoding":"jpeg",)"
        R"("height":2,"name":"front","representation":"spherical","width":3}],"intensity_limits":[0.0,1.0],"library":"L",)"
        R"("scans":[{"color_maximum":255.0,"fields":["cartesianX"],"guid":"{G}","intensity_limits":[0.0,1.0],"name":"one",)"
        R"("points":9,"position":[1.0,2.0,3.0],"rotation":[[0.0,-1.0,0.0],[1.0,0.0,0.0],[0.0,0.0,1.0]],)"
        R"("stated_max":[9.0,8.0,null],"stated_min":[0.0,0.0,0.0]},{"fields":[],"guid":"","name":"two","points":0}]})"),
    std::string(
        R"({"color_bits":8,"mesh":{"area_m2":2.5,"coordinates_and_normals_not_there":5,"faces":2,)"
        R"("left_out_lines_points_curves":1,"left_out_not_finite":3,"left_out_without_area":4,"max":[1.0,1.0,0.0],)"
        R"("min":[0.0,0.0,0.0],"samples":1000,"spacing_m":0.05,"textures":0,"triangles":4,"vertices":6}})"),
    std::string(R"({"color_bits":8,"mesh":{"textures":0,"triangles":0,"vertices":3}})"),
    std::string(R"({"color_bits":8,"intensity_limits":[-2048,2047]})"),
    std::string(
        R"({"extras":[{"data":"","description":"","extended":false,"record_id":4,"user_id":"LASF_Spec"}],)"
        R"("extras_note":"b","projection":[],"system_note":"a"})"),
};

TEST(NotesJson, TheTextsOfOlderCachesComeBackByteByByte) {
    for (const std::string& text : kTexts) {
        const FormatNotes notes = notes_of_text(text);
        EXPECT_EQ(notes_text(notes), text);
        // NaN is not equal to itself.
        if (text.find("null") == text.npos) {
            EXPECT_TRUE(notes_of_text(notes_text(notes)) == notes) << text;
        }
    }
}

TEST(NotesJson, NumbersKeepTheirValues) {
    const FormatNotes las = notes_of_text(kTexts[1]), e57 = notes_of_text(kTexts[4]);
    EXPECT_EQ(las.las->minor, 4);
    EXPECT_EQ(las.las->guid[15], 15);
    EXPECT_EQ(las.las->vlrs.at(0).text(), "hello");
    EXPECT_EQ(las.color_bits, 16u);
    ASSERT_TRUE(las::header_of("a", las));
    EXPECT_EQ(e57.e57->image_count, 2000u);
    EXPECT_EQ((*e57.e57->scans.at(0).rotation)[0], glm::dvec3(0, -1, 0));
    EXPECT_TRUE(std::isnan(e57.e57->scans.at(0).stated_max->z));
    EXPECT_EQ(notes_of_text(kTexts[5]).mesh->samples->count, 1000u);
}

TEST(NotesJson, WhatIsNoObjectHoldsNothing) {
    for (const char* text : {"", "[", "[]", "7", "null", "\"las\"", "{", "{\"format\":\"las\""})
        EXPECT_TRUE(notes_of_text(text) == FormatNotes{}) << text;
    // Deep nesting must not use up the stack.
    const std::string deep = "{\"scans\":" + std::string(1'000'000, '[');
    EXPECT_TRUE(notes_of_text(deep) == FormatNotes{});
    const std::string closed = deep + std::string(1'000'000, ']') + "}";
    EXPECT_EQ(notes_of_text(closed).e57->scans.size(), 1u);
}

TEST(NotesJson, ADamagedLasHeaderStaysDamaged) {
    for (const auto& [from, to] :
         std::vector<std::pair<std::string, std::string>>{{"\"minor_version\":4", "\"minor_version\":5"},
                                                          {"\"point_format\":7", "\"point_format\":-1"},
                                                          {"\"point_format\":7", "\"point_format\":5"},
                                                          {"\"point_format\":7", "\"point_format\":7e300"},
                                                          {"\"record_length\":40", "\"record_length\":35"},
                                                          {"\"software\":\"S\"", "\"software\":3"},
                                                          {"\"guid\":\"AA", "\"guid\":\"A"},
                                                          {"\"data\":\"a", "\"data\":\"!"},
                                                          {"\"record_id\":7", "\"record_id\":70000"},
                                                          {"\"records\":[", "\"recards\":["}}) {
        std::string text(kLas);
        ASSERT_NE(text.find(from), text.npos) << from;
        text.replace(text.find(from), from.size(), to);
        FormatNotes notes = notes_of_text(text);
        for (const char* when : {"read", "written again"}) {
            const auto header = las::header_of("a.luc", notes);
            ASSERT_FALSE(header) << to << when;
            EXPECT_THAT(header.error().line(), HasSubstr("is damaged"));
            notes = notes_of_text(notes_text(notes));
        }
    }
}

TEST(NotesJson, TheLatticeAndTheRecordsOfADamagedLasHeaderStillCount) {
    std::string text(kLas);
    text.replace(text.find("\"software\""), 10, "\"saftware\"");
    ScanInfo info;
    info.notes = notes_of_text(text);
    ASSERT_TRUE(las::lattice_of(info));
    EXPECT_EQ(las::lattice_of(info)->scale.x, .01);
    EXPECT_EQ(info.notes.las->vlrs.size(), 1u);
    for (const auto& [from, to] :
         {std::pair("\"scale\":[0.01", "\"scale\":[0"), std::pair("\"scale\":[0.01", "\"scale\":[null"),
          std::pair("\"scale\"", "\"skale\""), std::pair("1e+20", "1e+40")}) {
        text = kLas;
        text.replace(text.find(from), std::string_view(from).size(), to);
        info.notes = notes_of_text(text);
        EXPECT_FALSE(las::lattice_of(info)) << to;
    }
}

TEST(NotesJson, ChangedBytesNeverCrashAndComeToRest) {
    Random random(11);
    for (int round = 0; round < 20000; ++round) {
        std::string text = kTexts[random.next() % kTexts.size()];
        for (uint64_t changes = 1 + random.next() % 4; changes > 0; --changes) {
            constexpr std::string_view kBytes = "0123456789-+e.{}[]\",:lntruefas";
            text[random.next() % text.size()] = kBytes[random.next() % kBytes.size()];
        }
        const std::string once = notes_text(notes_of_text(text));
        EXPECT_EQ(notes_text(notes_of_text(once)), once) << text;
    }
}

}  // namespace
}  // namespace lucarne::io
