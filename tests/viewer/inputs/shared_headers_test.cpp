// Headers of scans that ranks tell each other.
#include "viewer/inputs/shared_headers.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "octree/cluster/only_rank.h"
#include "octree/convert/chunks/record_bytes.h"
#include "tests/temporary_folder.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

ScanHeader header_of_a_scan() {
    ScanHeader header;
    header.schema.add("intensity", io::ScalarType::u16);
    header.info.path = "a\xff.las";  // not UTF-8
    header.info.format = "LAS 1.2";
    header.info.declared_points = 5'000'000'000;
    header.info.metres_per_unit = 1200.0 / 3937;
    header.info.unit_stated = true;
    header.info.stated_box = {glm::dvec3(.1, -2, 3), glm::dvec3(1.0 / 3, 5, 6)};
    header.info.stations = {{2, glm::dvec3(1.0 / 7)}};
    header.info.losses = {{"points without a state", 3}};
    return header;
}

TEST(SharedHeaders, SurviveBeingTold) {
    const ScanHeader before = header_of_a_scan();
    const auto after = decode_header(encode_header(before));
    ASSERT_TRUE(after) << after.error().line();
    EXPECT_EQ(after->schema, before.schema);
    EXPECT_EQ(after->info.path, before.info.path);
    EXPECT_EQ(after->info.declared_points, before.info.declared_points);
    EXPECT_EQ(after->info.metres_per_unit, before.info.metres_per_unit);
    EXPECT_TRUE(after->info.unit_stated);
    EXPECT_EQ(after->info.stated_box, before.info.stated_box);
    EXPECT_EQ(after->info.stations[0].position, before.info.stations[0].position);
    EXPECT_EQ(after->info.losses, before.info.losses);
}

TEST(SharedHeaders, AreNotToldIfTheyWouldChange) {
    ScanHeader header = header_of_a_scan();
    header.info.stations[0].position.x = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(encode_header(header).empty());
}

TEST(SharedHeaders, ThatAreDamagedAreErrors) {
    const auto bytes = encode_header(header_of_a_scan());
    for (size_t length = 0; length < bytes.size(); length += 7)
        EXPECT_FALSE(decode_header(std::span(bytes).first(length))) << length;
}

TEST(SharedHeaders, AreThoseOfOneProcess) {
    const test::TemporaryFolder folder;
    std::vector<std::string> paths;
    for (const char* name : {"a.las", "b.laz", "c.ply"}) {
        paths.push_back(folder / name);
        ASSERT_EQ(test::lucarne("generate cornell --points 1k -o " + paths.back()).code, 0);
    }
    paths.push_back(folder / "missing.las");
    octree::OnlyRank alone;
    const auto told = read_headers_together(paths, {}, alone).value();
    const auto read = read_headers(paths, {});
    ASSERT_EQ(told.size(), paths.size());
    for (size_t i = 0; i + 1 < paths.size(); ++i) {
        ASSERT_TRUE(told[i] && read[i]);
        EXPECT_FALSE(encode_header(*read[i]).empty()) << paths[i];
        EXPECT_EQ(encode_header(*told[i]), encode_header(*read[i])) << paths[i];
    }
    EXPECT_EQ(told.back().error().line(), read.back().error().line());
}

}  // namespace
}  // namespace lucarne::viewer
