// Extra bytes of LAS: their names, and how many of them are distinguished.
#include "io/formats/las/extras.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the builder's small functions

class LasExtras : public ::testing::Test {
 protected:
    std::unique_ptr<PointSource> open(const std::string& name) const {
        auto source = open_scan(folder_ / name);
        if (!source) ADD_FAILURE() << source.error().line();
        return source ? std::move(*source) : nullptr;
    }
    std::unique_ptr<PointSource> open(const LasFile& file) const {
        write_bytes(folder_ / "in.las", file.bytes());
        return open("in.las");
    }
    void write(const std::string& name, const Schema& schema, const ScanInfo& info,
               const std::vector<std::byte>& records) const {
        const auto writer = create_scan(folder_ / name, schema, info, {.overwrite = true});
        ASSERT_TRUE(writer) << writer.error().line();
        ASSERT_TRUE((*writer)->write(records) && (*writer)->finish());
    }
    /// Returns the names in a file's record, as other tools read them.
    std::vector<std::string> names_in(const std::string& name) const {
        const auto file = InputFile::open(folder_ / name);
        const auto header = las::read_header(*file);
        std::vector<std::string> names;
        const auto entries =
            std::span<const std::byte>(header->find(las::kSpecUser, las::kExtraBytesRecord)->data);
        for (size_t at = 0; at < entries.size(); at += las::kDescriptorBytes)
            names.push_back(las::extra_name(entries.subspan(at, las::kDescriptorBytes)));
        return names;
    }
    const TemporaryFolder folder_;
};

/// Returns an entry of the extra bytes record.
std::string entry(const std::string& name, uint8_t type, uint8_t options = 0) {
    std::string bytes(las::kDescriptorBytes, '\0');
    bytes[2] = static_cast<char>(type);
    bytes[3] = static_cast<char>(options);
    bytes.replace(4, name.size(), name);
    return bytes;
}

TEST_F(LasExtras, ThreeRealComponentsOfANormalAreOne) {
    constexpr uint8_t kFloat = 9, kDouble = 10, kShort = 4;
    const auto file_with = [](const std::vector<std::string>& entries, size_t bytes) {
        LasFile file;
        std::string record(20 + bytes, '\0');
        for (size_t k = 0; k < 3 && bytes == 12; ++k) put(record, 20 + 4 * k, static_cast<float>(k) - 1.0f);
        file.records.push_back(record);
        std::string data;
        for (const auto& e : entries) data += e;
        file.add_vlr("LASF_Spec", 4, data);
        return file;
    };
    for (const std::array<std::string, 3>& names :
         {std::array<std::string, 3>{"NormalX", "NormalY", "NormalZ"},
          {"nx", "ny", "nz"},
          {"normalx", "normaly", "normalz"}}) {
        const auto file =
            file_with({entry(names[0], kFloat), entry(names[1], kFloat), entry(names[2], kFloat)}, 12);
        const auto source = open(file);
        const Attribute* normal = source->schema().find(names::normal);
        ASSERT_TRUE(normal) << names[0];
        EXPECT_EQ(normal->components, 3u);
        EXPECT_EQ(normal->type, ScalarType::f32);
        const auto records = read_all(*source);
        EXPECT_EQ(load<float>(&records->bytes[normal->offset + 8]), 1.0f);
        // Written again they are what they were.
        write("out.las", source->schema(), source->info(), records->bytes);
        EXPECT_EQ(names_in("out.las"), std::vector<std::string>(names.begin(), names.end()));
        EXPECT_TRUE(read_all(*open("out.las"))->bytes == records->bytes);
    }
    // Others are not: scaled ones, whole numbers, other orders, two of three.
    for (const auto& [entries, bytes] :
         {std::pair(
              std::vector{entry("NormalX", kFloat, 8), entry("NormalY", kFloat), entry("NormalZ", kFloat)},
              size_t{12}),
          std::pair(std::vector{entry("NormalX", kShort), entry("NormalY", kShort), entry("NormalZ", kShort)},
                    size_t{6}),
          std::pair(std::vector{entry("NormalX", kFloat), entry("NormalZ", kFloat), entry("NormalY", kFloat)},
                    size_t{12}),
          std::pair(
              std::vector{entry("NormalX", kDouble), entry("NormalY", kFloat), entry("NormalZ", kFloat)},
              size_t{16}),
          std::pair(std::vector{entry("NormalX", kFloat), entry("NormalY", kFloat)}, size_t{8})})
        EXPECT_FALSE(open(file_with(entries, bytes))->schema().find(names::normal));
}

TEST_F(LasExtras, NormalsOfOtherFormatsAreWrittenAsThreeComponents) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.stride = 12;
    schema.add(std::string(names::normal), ScalarType::f64, 3);
    std::vector<std::byte> records(schema.stride);
    store(&records[28], 1.0);
    write("out.las", schema, {}, records);
    EXPECT_EQ(names_in("out.las"), (std::vector<std::string>{"NormalX", "NormalY", "NormalZ"}));
    const auto source = open("out.las");
    ASSERT_TRUE(source->schema().find(names::normal));
    EXPECT_EQ(load<double>(&read_all(*source)->bytes[source->schema().find(names::normal)->offset + 16]),
              1.0);
}

TEST_F(LasExtras, LongNamesAreCutBetweenCharactersAndNumberedWhereTheyBecomeAlike) {
    const std::string same = "a name whose first 32 bytes are no other's ";
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.stride = 12;
    const std::vector<std::string> long_names = {same + "1",
                                                 same + "2",
                                                 "thirty-one bytes and a letter..",
                                                 same + "3",
                                                 "thirty-one bytes and a letter..ü",
                                                 "23 letters: üüüüüüüüüüü"};
    for (const std::string& name : long_names) schema.add(name, ScalarType::u8);
    const std::vector<std::byte> record(schema.stride);
    for (const char* file : {"a.las", "a.laz"}) {
        write(file, schema, {}, record);
        EXPECT_EQ(names_in(file), (std::vector<std::string>{
                                      "a name whose first 32 bytes are ", "a name whose first 32 bytes ar_2",
                                      "thirty-one bytes and a letter..", "a name whose first 32 bytes ar_3",
                                      "thirty-one bytes and a letter._2", "23 letters: üüüüüüüüüü"}));
        EXPECT_EQ(open(file)->schema().attributes.back().name, names_in(file).back());
    }
}

TEST_F(LasExtras, NamesThatAreNoUtf8AreWrittenAsTheyAreShown) {
    LasFile file;
    file.add_vlr("LASF_Spec", 4, extra_descriptor(1, "H\xf6he") + extra_descriptor(1, ""));
    file.records = {record0(1, 2, 3) + "ab"};
    const auto source = open(file);
    write("out.las", source->schema(), source->info(), read_all(*source)->bytes);
    EXPECT_EQ(names_in("out.las"), (std::vector<std::string>{"H?he", "unnamed"}));
}

TEST_F(LasExtras, ATimeOfWholeNumbersFillsItsFieldHoweverLargeItIs) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.stride = 12;
    schema.add(std::string(names::gps_time), ScalarType::u64);
    std::vector<std::byte> record(schema.stride);
    store(&record[12], uint64_t{1'700'000'000'123'456});
    write("a.las", schema, {}, record);
    const auto source = open("a.las");
    const auto all = read_all(*source);
    const Attribute *field = source->schema().find("las_gps_time"),
                    *whole = source->schema().find(names::gps_time);
    ASSERT_TRUE(field && whole);
    EXPECT_EQ(scalar_at(field->type, &all->bytes[field->offset]), 1'700'000'000'123'456.0);
    EXPECT_EQ(load<uint64_t>(&all->bytes[whole->offset]), 1'700'000'000'123'456u);
}

TEST_F(LasExtras, CalledLikeTheWritersOwnTheyAreNotTakenForFields) {
    LasFile file;
    std::string original = extra_descriptor(11, "original_return_number");
    original.replace(160, 25, "lucarne: of its own type");
    original.resize(192);
    file.add_vlr("LASF_Spec", 4, extra_descriptor(21, "las_return_number") + original);
    file.records = {record0(1, 2, 3, 0, 1) + "\x05\x05\x05\x05\x05"};
    const auto source = open(file);
    write("out.las", source->schema(), source->info(), read_all(*source)->bytes);
    const std::string bytes = read_bytes(folder_ / "out.las");
    EXPECT_EQ(load<uint32_t>(reinterpret_cast<const std::byte*>(&bytes[111 + 4 * 4])), 0u)
        << "no fifth returns";
}

TEST_F(LasExtras, OfThousandsTheFirstAreToldApart) {
    LasFile file;
    file.minor = 4;
    std::string entries;
    for (size_t i = 0; i < las::kMostEntries + 500; ++i)
        entries += extra_descriptor(1, fmt::format("e{}", i));
    file.add_vlr("LASF_Spec", 4, entries, true);
    file.records = {record0(1, 2, 3) + std::string(las::kMostEntries + 500, 'x')};
    const auto source = open(file);
    EXPECT_TRUE(source->schema().find("e999"));
    EXPECT_FALSE(source->schema().find("e1000"));
    EXPECT_EQ(source->schema().find("extra_bytes")->components, 500u);
}

}  // namespace
}  // namespace lucarne::io
