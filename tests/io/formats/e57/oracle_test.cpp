// Compares Lucarne's E57 reader with libE57Format: see tests/oracles/e57_oracle.py, which wrote
// e57_expected.json.
#include <cmath>

#include "tests/io/formats/digest.h"

namespace lucarne::io {
namespace {

/// Returns sum x_i and sum (i + 1) x_i.
template <class At>
std::array<double, 2> sums(size_t count, const At& at) {
    long double sum = 0, weighted = 0;
    for (size_t i = 0; i < count; ++i) {
        const long double value = at(i);
        sum += value;
        weighted += static_cast<long double>(i + 1) * value;
    }
    return {static_cast<double>(sum), static_cast<double>(weighted)};
}

void expect_component(const PointSource& source, const testing::Records& records, const std::string& name,
                      size_t component, const nlohmann::json& truth) {
    const Schema& schema = source.schema();
    const std::string what = source.info().path + ' ' + name + ' ' + std::to_string(component);
    const bool position = name == "position";
    const Attribute* a = schema.find(name);
    ASSERT_TRUE(position || a) << what;
    const auto axis = static_cast<int>(component);
    const auto value = [&](size_t i) {
        const std::byte* record = &records.bytes[i * schema.stride];
        if (position) return position_of(schema, record)[axis];
        return scalar_at(a->type, record + a->offset + component * scalar_bytes(a->type));
    };
    if (truth.contains("digest")) {
        // Coordinates as doubles, in whatever type they are stored.
        testing::Records column{std::vector<std::byte>(records.count * sizeof(double)), records.count, 0};
        for (size_t i = 0; position && i < records.count; ++i)
            store(&column.bytes[i * sizeof(double)], value(i));
        EXPECT_EQ(position ? testing::digest(column, sizeof(double), 0, ScalarType::f64)
                           : testing::digest(records, schema.stride,
                                             a->offset + component * scalar_bytes(a->type), a->type),
                  truth["digest"])
            << what;
        return;
    }
    // Scaled integers may be kept as floats, which have fewer digits.
    const double digits = !position && a->type == ScalarType::f32 ? 1e-7 : 1e-14;
    const auto ours = sums(records.count, value);
    const auto& theirs = truth["sums"];
    EXPECT_NEAR(ours[0], theirs[0].get<double>(), digits * theirs[2].get<double>()) << what;
    EXPECT_NEAR(ours[1], theirs[1].get<double>(), digits * theirs[2].get<double>()) << what;
}

void expect_same(const PointSource& source, const nlohmann::json& truth) {
    const auto records = testing::read_all(source);
    ASSERT_TRUE(records) << records.error().line();
    EXPECT_EQ(records->count, truth["points"].get<size_t>());
    EXPECT_EQ(records->count + records->dropped, source.info().declared_points);
    auto stations = nlohmann::json::array();
    for (const Station& s : source.info().stations)
        stations.push_back({s.id, s.position.x, s.position.y, s.position.z});
    EXPECT_EQ(stations, truth["stations"]);
    EXPECT_EQ(source.info().notes.e57->image_count, truth["images"]);
    EXPECT_EQ(source.schema().attributes.size() + 1, truth["attributes"].size());
    for (const auto& [name, components] : truth["attributes"].items())
        for (size_t c = 0; c < components.size(); ++c)
            expect_component(source, *records, name, c, components[c]);
}

class E57Oracle : public ::testing::Test {
 protected:
    static nlohmann::json expected() {
        std::ifstream in(std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests/oracles/e57_expected.json");
        return nlohmann::json::parse(in);
    }
    static void expect_file(const std::filesystem::path& path, const nlohmann::json& truth) {
        SCOPED_TRACE(path.string());
        const auto opened = open_scan(path);
        ASSERT_TRUE(opened) << opened.error().line();
        expect_same(**opened, truth);
    }
};

TEST_F(E57Oracle, TurnedAndMovedScansAreWhatLibE57FormatReads) {
    const std::string name = "e57_posed.e57";  // the oracle's name for it
    expect_file(std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests/io/formats/e57/posed.e57",
                expected().at(name));
}

TEST_F(E57Oracle, EveryValueOfEveryAttributeIsWhatLibE57FormatReads) {
    const auto folder = testing::shared_data();
    if (folder.empty()) GTEST_SKIP() << "the shared data is not here";
    auto all = expected();
    all.erase("e57_posed.e57");
    ASSERT_GE(all.size(), 17u);
    for (const auto& [name, truth] : all.items()) expect_file(folder / "e57" / name, truth);
}

}  // namespace
}  // namespace lucarne::io
