// Truncated and damaged files. Without `salvage` they are rejected, and the error says how many points could
// be saved. With it these points are returned, and the rest is counted.
#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <gmock/gmock.h>

#include "io/core/counted.h"
#include "io/formats/las/header.h"
#include "io/formats/las/laz/chunk_table.h"
#include "tests/io/formats/e57/e57_builder.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::read_all;
using testing::Records;

const ReadOptions kSalvage{"", true, {0, 0, true}, true};

uint64_t lost_points(const Losses& losses) {
    uint64_t points = 0;
    for (const Loss& loss : losses)
        if (loss.what == lost::cut_off || loss.what == lost::damaged || loss.what == lost::no_number ||
            loss.what == "rays that met nothing" || loss.what == "points whose state is invalid")
            points += loss.count;
    return points;
}

/// The result of a pass with `salvage`; nothing if the file is rejected even then.
struct Saved {
    Records records;
    uint64_t lost = 0;
    size_t stride = 1;
};
std::optional<Saved> salvage(const std::filesystem::path& path) {
    const auto source = open_scan(path, kSalvage);
    if (!source) {
        EXPECT_EQ(source.error().kind, ErrorKind::input_rejected);
        return std::nullopt;
    }
    auto records = read_all(**source);
    const auto contents = survey(**source);
    if (!records || !contents) {
        ADD_FAILURE() << (records ? contents.error().line() : records.error().line());
        return std::nullopt;
    }
    EXPECT_EQ(contents->points, records->count);
    return Saved{std::move(*records), lost_points(contents->losses), (*source)->schema().stride};
}

/// Opens a file and reads it to its end without `salvage`.
Result<Records> read_as_usual(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const auto source, open_scan(path, {"", true, {0, 0, true}}));
    return read_all(*source);
}

/// Cuts a sound file at many places. `expected(cut)` returns how many records can be saved of the first `cut`
/// bytes. If it returns nothing, any number is accepted that is not smaller than for a shorter piece.
using Expected = std::function<std::optional<uint64_t>(size_t cut)>;
void cut_everywhere(const std::string& name, const std::string& bytes, const Expected& expected) {
    const testing::TemporaryFolder folder;
    const auto path = folder / name;
    testing::write_bytes(path, bytes);
    const auto whole = salvage(path);
    ASSERT_TRUE(whole) << name;
    const uint64_t promised = whole->records.count + whole->records.dropped;
    std::set<size_t> cuts = {bytes.size() - 1, bytes.size() - 2};
    for (size_t i = 1; i < 40; ++i) cuts.insert(bytes.size() * i / 40);
    uint64_t before = 0;
    size_t rejected = 0, saved_some = 0;
    for (const size_t cut : cuts) {
        std::filesystem::remove(path);
        testing::write_bytes(path, std::string_view(bytes).substr(0, cut));
        const auto saved = salvage(path);
        const uint64_t seen = saved ? saved->records.count + saved->records.dropped : 0;
        const auto usual = read_as_usual(path);
        const auto wanted = expected(cut);
        ASSERT_EQ(seen, wanted.value_or(seen)) << name << " cut to " << cut;
        ASSERT_GE(seen, before) << name << " cut to " << cut;
        before = seen;
        if (saved) {
            // Text that lacks only the end of its last number looks complete.
            ASSERT_TRUE(usual || std::equal(saved->records.bytes.begin(), saved->records.bytes.end(),
                                            whole->records.bytes.begin()))
                << name << " cut to " << cut;
            ASSERT_EQ(saved->records.count + saved->lost, promised) << name << " cut to " << cut;
        }
        saved_some += saved && saved->records.count > 0;
        if (usual) {
            ASSERT_EQ(seen, promised) << name << " cut to " << cut;
            continue;
        }
        ++rejected;
        const Error advice = with_salvage_advice(usual.error(), path, {"", true, {0, 0, true}});
        if (saved && saved->records.count > 0) {
            ASSERT_THAT(advice.line(), HasSubstr("; " + counted(saved->records.count, "points") +
                                                 " can be saved with --salvage"));
        } else if (saved) {
            ASSERT_THAT(advice.line(), HasSubstr("none of its points can be saved"))
                << name << " cut to " << cut;
        } else {
            ASSERT_EQ(advice.line(), usual.error().line());
        }
    }
    EXPECT_GT(rejected, 20u) << name;
    EXPECT_GT(saved_some, 0u) << name;
}

std::string shared_bytes(const std::string& file) {
    return testing::read_bytes(testing::shared_data() / file);
}
uint32_t u32_at(const std::string& bytes, size_t at) {
    return load<uint32_t>(reinterpret_cast<const std::byte*>(bytes.data()) + at);
}

class SharedSalvage : public ::testing::Test {
 protected:
    void SetUp() override {
        if (testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    }
};

TEST_F(SharedSalvage, OfLasEveryWholeRecord) {
    for (const char* name : {"4_6_crop.las", "extrabytes.las", "test1_4.las"}) {
        const std::string bytes = shared_bytes(std::string("las/") + name);
        const size_t offset = u32_at(bytes, 96), length = u32_at(bytes, 105) & 0xffff;
        const uint64_t count = std::max(u32_at(bytes, 107), bytes[25] >= 4 ? u32_at(bytes, 247) : 0);
        cut_everywhere(name, bytes, [=](size_t cut) {
            return cut < offset ? 0 : std::min<uint64_t>(count, (cut - offset) / length);
        });
    }
}

TEST_F(SharedSalvage, OfBinaryPlyAndPcdEveryWholeRecord) {
    const std::string ply = shared_bytes("ply/statue_lion_takanawa_big_endian.ply");
    const size_t ply_begin = ply.find("end_header\n") + 11;
    const size_t ply_length = (ply.size() - ply_begin) / 341989;
    cut_everywhere("a.ply", ply,
                   [=](size_t cut) { return cut < ply_begin ? 0 : (cut - ply_begin) / ply_length; });
    const std::string pcd = shared_bytes("pcd/open3d_fragment.pcd");
    const size_t pcd_begin = pcd.find("DATA binary\n") + 12;
    const size_t pcd_length = (pcd.size() - pcd_begin) / 113662;
    cut_everywhere("a.pcd", pcd,
                   [=](size_t cut) { return cut < pcd_begin ? 0 : (cut - pcd_begin) / pcd_length; });
}

/// Rows that end before the cut, with their line end. Only the last row may lack it.
Expected rows_behind(const std::string& bytes, size_t begin, uint64_t promised) {
    return [&bytes, begin, promised](size_t cut) -> std::optional<uint64_t> {
        if (cut <= begin) return 0;
        const auto text = std::string_view(bytes).substr(begin, cut - begin);
        const auto lines = static_cast<uint64_t>(std::count(text.begin(), text.end(), '\n'));
        if (lines + 1 >= promised) return std::nullopt;
        return lines;
    };
}

TEST_F(SharedSalvage, OfTextEveryWholeRow) {
    const std::string ply = shared_bytes("ply/ankylosaurus_ascii_rgb_normals.ply");
    cut_everywhere("a.ply", ply, rows_behind(ply, ply.find('\n', ply.find("end_header")) + 1, 34820));
    const std::string pts = shared_bytes("ptx_pts/test.pts");
    cut_everywhere("a.pts", pts, rows_behind(pts, pts.find('\n') + 1, 19));
    const std::string ptx = shared_bytes("ptx_pts/1.2-with-color.ptx");
    size_t begin = 0;
    for (int i = 0; i < 10; ++i) begin = ptx.find('\n', begin) + 1;
    cut_everywhere("a.ptx", ptx, rows_behind(ptx, begin, 1065));
}

TEST_F(SharedSalvage, OfCompressedPcdPointsAsFarAsItsLastFieldGoes) {
    // All x come before all y, and these before all z, so only a cut within z leaves points.
    for (const char* name : {"room_scan1.pcd", "region_growing_rgb_tutorial.pcd"})
        cut_everywhere(name, shared_bytes(std::string("pcd/") + name), [](size_t) { return std::nullopt; });
}

/// Returns where the chunks of a sound LAZ file are.
std::vector<laz::ChunkPlace> chunks_of(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    const auto header = las::read_header(*file);
    const auto compression = laz::read_compression(path.string(), *header);
    return laz::read_chunks(*file, *header, *compression).value();
}

TEST_F(SharedSalvage, OfLazEveryWholeChunkWithoutTheTableAtItsEnd) {
    for (const char* name : {"1.2-with-color.copc.laz", "statue_lion_takanawa.copc.laz"}) {
        const auto chunks = chunks_of(testing::shared_data() / "las" / name);
        cut_everywhere(name, shared_bytes(std::string("las/") + name), [&](size_t cut) {
            uint64_t points = 0;
            for (const auto& chunk : chunks)
                if (chunk.offset + chunk.bytes <= cut) points += chunk.points;
            return points;
        });
    }
}

TEST_F(SharedSalvage, OfPointWiseLazEveryPointBeforeTheCut) {
    const auto path = testing::shared_data() / "las/autzen_trim.laz";
    const auto chunks = chunks_of(path);
    const std::string bytes = testing::read_bytes(path);
    cut_everywhere("autzen.laz", bytes, [](size_t) { return std::nullopt; });
    // Half a chunk gives about half of its points, and those of later chunks are not affected.
    const testing::TemporaryFolder folder;
    const auto cut = chunks[1].offset + chunks[1].bytes / 2;
    testing::write_bytes(folder / "half.laz", std::string_view(bytes).substr(0, cut));
    const auto saved = salvage(folder / "half.laz");
    ASSERT_TRUE(saved);
    EXPECT_GT(saved->records.count, chunks[0].points + chunks[1].points / 4);
    EXPECT_LT(saved->records.count, chunks[0].points + chunks[1].points * 3 / 4);
}

TEST_F(SharedSalvage, OfLazWhoseHeaderPromisesTooManyNoPointThatNeverWas) {
    std::string bytes = shared_bytes("las/autzen_trim.laz");
    const testing::TemporaryFolder folder;
    testing::write_bytes(folder / "sound.laz", bytes);
    const auto sound = salvage(folder / "sound.laz");
    ASSERT_TRUE(sound);
    const auto count = static_cast<uint32_t>(sound->records.count);
    for (const uint32_t promised : {200'000u, 1'000'000u}) {
        std::memcpy(&bytes[107], &promised, sizeof promised);
        testing::write_bytes(folder / fmt::format("{}.laz", promised), bytes);
        const auto saved = salvage(folder / fmt::format("{}.laz", promised));
        ASSERT_TRUE(saved);
        EXPECT_EQ(saved->records.count, count);
        EXPECT_EQ(saved->lost, promised - count);
        EXPECT_TRUE(saved->records.bytes == sound->records.bytes);
    }
}

TEST_F(SharedSalvage, OfLazWithADamagedChunkAllOthers) {
    for (const char* name : {"autzen_trim.laz", "statue_lion_takanawa.copc.laz", "lone-star.copc.laz"}) {
        const auto path = testing::shared_data() / "las" / name;
        const auto chunks = chunks_of(path);
        std::string bytes = testing::read_bytes(path);
        const auto whole = salvage(path);
        ASSERT_GE(chunks.size(), 3u) << name;
        const auto& bad = chunks[1];
        for (size_t i = bad.bytes / 2; i < bad.bytes; ++i) bytes[bad.offset + i] ^= '\x5a';
        const testing::TemporaryFolder folder;
        testing::write_bytes(folder / "a.laz", bytes);
        const auto usual = read_as_usual(folder / "a.laz");
        ASSERT_FALSE(usual) << name;
        EXPECT_THAT(with_salvage_advice(usual.error(), folder / "a.laz", {}).line(),
                    HasSubstr(fmt::format("{} points can be saved", whole->records.count - bad.points)));
        const auto saved = salvage(folder / "a.laz");
        ASSERT_TRUE(saved) << name;
        EXPECT_EQ(saved->records.count, whole->records.count - bad.points) << name;
        EXPECT_EQ(saved->lost, bad.points) << name;
        auto expected = whole->records.bytes;
        const auto gap = expected.begin() + static_cast<std::ptrdiff_t>(chunks[0].points * saved->stride);
        expected.erase(gap, gap + static_cast<std::ptrdiff_t>(bad.points * saved->stride));
        EXPECT_TRUE(saved->records.bytes == expected) << name;
    }
}

TEST_F(SharedSalvage, OfE57EveryRecordOutsideTheDamagedPage) {
    for (const char* name : {"bunnyInt19.e57", "pump_155k_rgb_with_image.e57"}) {
        const std::string bytes = shared_bytes(std::string("e57/") + name);
        const testing::TemporaryFolder folder;
        const auto path = folder / name;
        testing::write_bytes(path, bytes);
        const auto whole = salvage(path);
        size_t damaged_points = 0;
        for (size_t place = 1; place < 20; ++place) {
            std::string damaged = bytes;
            damaged[bytes.size() * place / 20] ^= '\x10';
            std::filesystem::remove(path);
            testing::write_bytes(path, damaged);
            const auto usual = read_as_usual(path);
            const auto saved = salvage(path);
            if (!saved || usual) continue;  // the description itself is damaged, or an image
            EXPECT_EQ(saved->records.count + saved->lost, whole->records.count + whole->lost) << name;
            if (saved->lost == whole->lost) continue;
            ++damaged_points;
            // A page has at most 1020 bytes of a field, of 3 bits or more for each record.
            EXPECT_LT(saved->lost - whole->lost, 2800u) << name << ' ' << place;
            EXPECT_THAT(
                with_salvage_advice(usual.error(), path, {}).line(),
                HasSubstr(fmt::format("{} points can be saved with --salvage", saved->records.count)));
        }
        EXPECT_GT(damaged_points, 1u) << name;
    }
}

/// Returns an E57 file whose description comes before its points, as some writers place it.
std::string description_first(uint64_t points) {
    testing::BuiltScan scan{testing::kXyzFields, points, {}, {}, {}, {}, {}};
    for (uint64_t i = 0; i < points; i += 100) {
        std::vector<std::array<double, 3>> some;
        for (uint64_t k = i; k < i + 100; ++k) some.push_back({static_cast<double>(k), 2, 3});
        scan.packets += testing::xyz_packet(some);
    }
    constexpr size_t kPoints = 4 * e57::kPageContent;
    scan.file_offset = std::to_string(testing::physical(kPoints));
    const std::string usual = testing::BuiltFile{{scan}}.logical();
    const size_t section = 32 + scan.packets.size();
    std::string file = usual.substr(0, e57::kHeaderBytes) + usual.substr(e57::kHeaderBytes + section);
    testing::put(file, 24, uint64_t{e57::kHeaderBytes});
    file.resize(kPoints);
    file += usual.substr(e57::kHeaderBytes, section);
    testing::put(file, kPoints + 16, testing::physical(kPoints + 32));
    testing::put(file, 16,
                 uint64_t{(file.size() + e57::kPageContent - 1) / e57::kPageContent * e57::kPageBytes});
    return testing::with_checksums(file);
}

TEST(Salvage, OfATruncatedE57WholePacketsOfWholePages) {
    static constexpr uint64_t kPoints = 10'000, kPacket = 100 * 24 + 12;
    const std::string bytes = description_first(kPoints);
    cut_everywhere("a.e57", bytes, [](size_t cut) -> uint64_t {
        // The checksum of the last page may be cut off.
        const size_t logical = (cut + 4) / e57::kPageBytes * e57::kPageContent,
                     begin = 4 * e57::kPageContent + 32;
        return logical < begin ? 0 : std::min<uint64_t>(kPoints, (logical - begin) / kPacket * 100);
    });
}

TEST(Salvage, OfAnE57WithoutItsDescriptionNothing) {
    const testing::TemporaryFolder folder;
    const std::string bytes = testing::read_bytes(LUCARNE_SOURCE_DIR "/tests/io/formats/e57/posed.e57");
    testing::write_bytes(folder / "a.e57", std::string_view(bytes).substr(0, bytes.size() / 2));
    EXPECT_FALSE(salvage(folder / "a.e57"));
    const auto usual = read_as_usual(folder / "a.e57");
    ASSERT_FALSE(usual);
    EXPECT_THAT(with_salvage_advice(usual.error(), folder / "a.e57", {}).line(),
                AllOf(HasSubstr("is truncated"), HasSubstr("none can be saved")));
}

TEST(Salvage, PassesOverRowsThatMakeNoSense) {
    const testing::TemporaryFolder folder;
    testing::write_bytes(folder / "a.xyz", "1 2 3\n4 five 6\n7 8 9\n10 11\n12 13 14\n");
    testing::write_bytes(folder / "a.ply",
                         "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float "
                         "y\nproperty float z\nend_header\n1 2 3\n4 five 6\n7 8 9\n10 11\n12 13 14\n");
    for (const char* name : {"a.xyz", "a.ply"}) {
        const ReadOptions options{name[2] == 'x' ? "x,y,z" : "", true, {}, true};
        const auto source = open_scan(folder / name, options);
        ASSERT_TRUE(source) << source.error().line();
        const auto contents = survey(**source);
        ASSERT_TRUE(contents) << contents.error().line();
        EXPECT_EQ(contents->points, 3u) << name;
        EXPECT_EQ(contents->losses, (Losses{{std::string(lost::damaged), 2}})) << name;
        EXPECT_EQ(contents->max, glm::dvec3(12, 13, 14)) << name;
    }
}

TEST(Salvage, GivesNoAdviceAboutFilesThatAreSound) {
    const testing::TemporaryFolder folder;
    testing::LasFile las;
    las.records = {testing::record0(1, 2, 3)};
    testing::write_bytes(folder / "a.las", las.bytes());
    const Error other{ErrorKind::input_rejected, (folder / "a.las").string(), "is in another unit",
                      "so what"};
    EXPECT_EQ(with_salvage_advice(other, folder / "a.las", {}).line(), other.line());
}

TEST(Salvage, LooksAtHostileCountsNoLongerThanTheFileIs) {
    const testing::TemporaryFolder folder;
    testing::LasFile las;
    las.minor = 4;
    las.records = {testing::record0(1, 2, 3), testing::record0(4, 5, 6)};
    las.said_points = INT64_MAX;
    testing::write_bytes(folder / "a.las", las.bytes());
    testing::write_bytes(
        folder / "a.ptx",
        "60000\n60000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 "
        "0.5\n4 5 6 0.5\n");
    testing::write_bytes(folder / "a.pts", "18446744073709551615\n1 2 3\n4 5 6\n");
    testing::write_bytes(folder / "a.pcd",
                         "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 18446744073709551615\nHEIGHT 1\nDATA "
                         "ascii\n1 2 3\n4 5 6\n");
    for (const char* name : {"a.las", "a.ptx", "a.pts", "a.pcd"}) {
        const auto saved = salvage(folder / name);
        ASSERT_TRUE(saved) << name;
        EXPECT_EQ(saved->records.count, 2u) << name;
    }
}

TEST(Losses, OfOneKindAreAddedUpAndNothingIsNoLoss) {
    Losses losses;
    add_loss(losses, "a", 2);
    add_loss(losses, "b", 0);
    add_losses(losses, {{"a", 3}, {"c", 1}});
    EXPECT_EQ(losses, (Losses{{"a", 5}, {"c", 1}}));
}

TEST(ReadOptions, ThatChangeThePointsHaveATextOfTheirOwn) {
    EXPECT_EQ(options_text({}), "");
    EXPECT_EQ(options_text({"", true, {}, false}), "");
    const std::set<std::string> texts = {
        options_text({"x,y,z", false, {}, false}), options_text({"", false, {}, true}),
        options_text({"x,y,z", false, {}, true}), options_text({"z,y,x", false, {}, true})};
    EXPECT_EQ(texts.size(), 4u);
}

}  // namespace
}  // namespace lucarne::io
