// Compares Lucarne's LAS reader with laspy: see tests/oracles/las_oracle.py, which wrote las_expected.json.
#include "tests/io/formats/digest.h"

namespace lucarne::io {
namespace {

TEST(LasOracle, EveryValueOfEveryAttributeIsWhatLaspyReads) {
    const auto folder = testing::shared_data();
    if (folder.empty()) GTEST_SKIP() << "the shared data is not here";
    std::ifstream in(std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests/oracles/las_expected.json");
    const auto expected = nlohmann::json::parse(in);
    ASSERT_GE(expected.size(), 7u);
    for (const auto& [file, truth] : expected.items()) {
        const auto opened = open_scan(folder / "las" / file);
        ASSERT_TRUE(opened) << opened.error().line();
        const PointSource& source = **opened;
        const Schema& schema = source.schema();
        const auto records = testing::read_all(source);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count, truth["points"].get<size_t>()) << file;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(schema.scale[axis], truth["scale"][static_cast<size_t>(axis)].get<double>()) << file;
            EXPECT_EQ(schema.offset[axis], truth["offset"][static_cast<size_t>(axis)].get<double>()) << file;
        }
        EXPECT_EQ(schema.attributes.size() + 1, truth["attributes"].size()) << file;
        for (const auto& [name, digests] : truth["attributes"].items()) {
            const Attribute position{"position", ScalarType::i32, 3, 0};
            const Attribute* a = name == "position" ? &position : schema.find(name);
            ASSERT_TRUE(a) << file << " lacks " << name;
            ASSERT_EQ(a->components, digests.size()) << file << ' ' << name;
            for (size_t c = 0; c < a->components; ++c)
                EXPECT_EQ(
                    testing::digest(*records, schema.stride, a->offset + c * scalar_bytes(a->type), a->type),
                    digests[c])
                    << file << ' ' << name << ' ' << c;
        }
    }
}

}  // namespace
}  // namespace lucarne::io
