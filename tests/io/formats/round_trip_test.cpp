// A file that is read, written and read again stays the same: bit for bit if the format is the same.
#include <map>

#include <gmock/gmock.h>

#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::read_all;
using testing::read_bytes;
using testing::TemporaryFolder;

std::unique_ptr<PointSource> opened(const std::filesystem::path& path) {
    ReadOptions as_points;
    as_points.mesh.vertices = true;
    auto source = open_scan(path, as_points);
    if (!source) ADD_FAILURE() << source.error().line();
    return source ? std::move(*source) : nullptr;
}

/// Writes the whole of `source` to `path`.
Result<void> copy_scan(const PointSource& source, const std::filesystem::path& path,
                       WriteOptions options = {}) {
    LUCARNE_ASSIGN(const auto writer, create_scan(path, source.schema(), source.info(), options));
    LUCARNE_ASSIGN(const auto reader, source.open());
    PointBatch batch;
    for (;;) {
        LUCARNE_ASSIGN(const size_t got, reader->read(batch, 777));
        if (got == 0) return writer->finish();
        LUCARNE_TRY(writer->write(std::span(batch.bytes).first(got * source.schema().stride)));
    }
}

std::vector<std::filesystem::path> shared_scans(const std::string& folder, const std::string& extension) {
    std::vector<std::filesystem::path> found;
    if (testing::shared_data().empty()) return found;
    for (const auto& entry : std::filesystem::directory_iterator(testing::shared_data() / folder))
        if (entry.path().extension() == extension) found.push_back(entry.path());
    return found;
}

#define SKIP_WITHOUT_SHARED_DATA() \
    if (testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here"

void expect_same_scan(const PointSource& a, const PointSource& b, const std::string& name) {
    EXPECT_EQ(a.schema(), b.schema()) << name;
    const auto ra = read_all(a), rb = read_all(b);
    ASSERT_TRUE(ra && rb) << name;
    EXPECT_EQ(ra->count, rb->count) << name;
    EXPECT_TRUE(ra->bytes == rb->bytes) << name << ": the records differ";
}

/// Returns the points of a LAS file as the bytes in it.
std::string las_points(const std::string& file, size_t count) {
    const auto* bytes = reinterpret_cast<const std::byte*>(file.data());
    return file.substr(load<uint32_t>(bytes + 96), count * load<uint16_t>(bytes + 105));
}

TEST(RoundTrip, LasToLasKeepsEveryPointBitForBitAndTheWholeHeader) {
    SKIP_WITHOUT_SHARED_DATA();
    const TemporaryFolder folder;
    for (const auto& path : shared_scans("las", ".las")) {
        const auto source = opened(path);
        const auto copy_path = folder / path.filename().string();
        const auto written = copy_scan(*source, copy_path);
        ASSERT_TRUE(written) << written.error().line();
        const auto copy = opened(copy_path);
        EXPECT_EQ(copy->info().format, source->info().format);
        EXPECT_TRUE(copy->info().notes == source->info().notes) << path;
        EXPECT_EQ(copy->info().metres_per_unit, source->info().metres_per_unit);
        const size_t count = source->info().declared_points;
        EXPECT_TRUE(las_points(read_bytes(path), count) == las_points(read_bytes(copy_path), count)) << path;
    }
}

TEST(RoundTrip, PlyToPlyKeepsEveryPropertyUnderItsNameAndType) {
    SKIP_WITHOUT_SHARED_DATA();
    const TemporaryFolder folder;
    for (const auto& path : shared_scans("ply", ".ply")) {
        const auto source = opened(path);
        const auto copy_path = folder / path.filename().string();
        const auto written = copy_scan(*source, copy_path);
        ASSERT_TRUE(written) << written.error().line();
        const auto copy = opened(copy_path);
        expect_same_scan(*source, *copy, path.string());
        const auto &before = source->info().notes.ply, &after = copy->info().notes.ply;
        if (!before) continue;  // a mesh
        ASSERT_TRUE(after && after->properties.size() >= before->properties.size());
        for (size_t i = 0; i < before->properties.size(); ++i)
            EXPECT_TRUE(before->properties[i] == after->properties[i]) << path;
    }
}

TEST(RoundTrip, LasToPlyAndBackKeepsEveryInteger) {
    SKIP_WITHOUT_SHARED_DATA();
    const TemporaryFolder folder;
    for (const auto& path : shared_scans("las", ".las")) {
        const auto source = opened(path);
        const auto ply_path = folder / (path.stem().string() + ".ply");
        const auto written = copy_scan(*source, ply_path);
        ASSERT_TRUE(written) << written.error().line();
        const auto copy = opened(ply_path);
        EXPECT_EQ(copy->info().color_bits, source->info().color_bits);
        EXPECT_EQ(copy->info().metres_per_unit, source->info().metres_per_unit);
        const auto before = read_all(*source), after = read_all(*copy);
        ASSERT_TRUE(before && after);
        ASSERT_EQ(before->count, after->count);
        for (size_t i = 0; i < before->count; ++i) {
            const std::byte* old_record = &before->bytes[i * source->schema().stride];
            const std::byte* new_record = &after->bytes[i * copy->schema().stride];
            const glm::dvec3 position = position_of(copy->schema(), new_record);
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_EQ(std::llround((position[axis] - source->schema().offset[axis]) /
                                       source->schema().scale[axis]),
                          load<int32_t>(old_record + 4 * axis))
                    << path;
            for (const Attribute& a : source->schema().attributes) {
                const Attribute* b = copy->schema().find(a.name);
                if (!b) continue;  // several components or 64 bits: tested separately
                ASSERT_EQ(std::memcmp(old_record + a.offset, new_record + b->offset, a.bytes()), 0)
                    << path << ' ' << a.name;
            }
        }
    }
}

TEST(RoundTrip, PlyToLasKeepsEveryValueInFieldsOrExtraBytes) {
    SKIP_WITHOUT_SHARED_DATA();
    const TemporaryFolder folder;
    for (const auto& path : shared_scans("ply", ".ply")) {
        const auto source = opened(path);
        const auto las_path = folder / (path.stem().string() + ".las");
        const auto written = copy_scan(*source, las_path);
        ASSERT_TRUE(written) << written.error().line();
        const auto copy = opened(las_path);
        const auto before = read_all(*source), after = read_all(*copy);
        ASSERT_TRUE(before && after);
        ASSERT_EQ(before->count, after->count);
        for (size_t i = 0; i < before->count; ++i) {
            const std::byte* old_record = &before->bytes[i * source->schema().stride];
            const std::byte* new_record = &after->bytes[i * copy->schema().stride];
            const glm::dvec3 moved =
                position_of(source->schema(), old_record) - position_of(copy->schema(), new_record);
            for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(moved[axis]), 0.50001e-4) << path;
            for (const Attribute& a : source->schema().attributes) {
                const Attribute* b = copy->schema().find(a.name);
                ASSERT_TRUE(b) << path << ' ' << a.name;
                const bool widened = a.name == names::color && a.type == ScalarType::u8;  // 255 -> 65535
                for (size_t c = 0; c < a.components; ++c)
                    ASSERT_EQ(scalar_at(a.type, old_record + a.offset + c * scalar_bytes(a.type)) *
                                  (widened ? 257 : 1),
                              scalar_at(b->type, new_record + b->offset + c * scalar_bytes(b->type)))
                        << path << ' ' << a.name;
            }
        }
    }
}

}  // namespace
}  // namespace lucarne::io
