// Compares Lucarne's PTX, PTS and PCD readers with numpy and pypcd4: see tests/oracles/text_oracle.py, which
// wrote text_expected.json.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

/// The sum of the bits of the values as doubles, and the sum weighted by position, modulo 2^64.
class Digest {
 public:
    void add(double value) {
        uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        sum_ += bits;
        placed_ += ++count_ * bits;
    }
    nlohmann::json json() const { return {fmt::format("{:016x}", sum_), fmt::format("{:016x}", placed_)}; }

 private:
    uint64_t sum_ = 0, placed_ = 0, count_ = 0;
};

TEST(TextOracle, EveryValueIsWhatOthersRead) {
    const auto folder = testing::shared_data();
    if (folder.empty()) GTEST_SKIP() << "the shared data is not here";
    std::ifstream in(std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests/oracles/text_expected.json");
    const auto expected = nlohmann::json::parse(in);
    ASSERT_EQ(expected.size(), 10u);
    for (const auto& [file, truth] : expected.items()) {
        const auto source = open_scan(folder / file, {"", true});
        ASSERT_TRUE(source) << source.error().line();
        const auto records = testing::read_all(**source);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count, truth["points"].get<size_t>()) << file;
        EXPECT_EQ(records->dropped, truth["dropped"].get<size_t>()) << file;
        const Schema& schema = (*source)->schema();
        EXPECT_EQ(schema.attributes.size() + 1, truth["attributes"].size()) << file;
        for (const auto& [name, digests] : truth["attributes"].items()) {
            const Attribute* a = schema.find(name);
            ASSERT_TRUE(a || name == "position") << file << " lacks " << name;
            for (size_t c = 0; c < digests.size(); ++c) {
                Digest digest;
                for (size_t i = 0; i < records->count; ++i) {
                    const std::byte* record = &records->bytes[i * schema.stride];
                    digest.add(a ? scalar_at(a->type, record + a->offset + c * scalar_bytes(a->type))
                                 : position_of(schema, record)[static_cast<int>(c)]);
                }
                EXPECT_EQ(digest.json(), digests[c]) << file << ' ' << name << ' ' << c;
            }
        }
    }
}

}  // namespace
}  // namespace lucarne::io
