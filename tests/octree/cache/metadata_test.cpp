#include "octree/cache/metadata.h"

#include <string>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

TEST(Metadata, KeepsWhatWhiteIsInEachScansColours) {
    SourceHeader header;
    for (const uint32_t bits : {0u, 8u, 16u}) {
        io::ScanInfo scan;
        scan.color_bits = bits;
        header.scans.push_back(scan);
    }
    const auto read = parse_metadata("cache.luc", metadata_text(header));
    ASSERT_TRUE(read) << read.error().line();
    ASSERT_EQ(read->scans.size(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(read->scans[i].color_bits, header.scans[i].color_bits);
}

TEST(Metadata, RejectsColoursOfAnUnknownWidth) {
    SourceHeader header;
    header.scans.resize(1);
    std::string text = metadata_text(header);
    const size_t at = text.find("\"color_bits\": 8");
    ASSERT_NE(at, std::string::npos) << text;
    text.replace(at, 15, "\"color_bits\": 7");
    EXPECT_FALSE(parse_metadata("cache.luc", text));
}

}  // namespace
}  // namespace lucarne::octree
