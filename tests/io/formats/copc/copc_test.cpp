// COPC files with false values: every lie in the info record and the pages. The files are made by Lucarne's
// own writer.
#include <random>

#include <gmock/gmock.h>

#include "io/formats/copc/writer.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

constexpr size_t kInfoAt = 375 + 54, kPageOffsetAt = kInfoAt + 40;

/// A file with a chain of six nodes, one per level, so deep that the hierarchy has a second page.
class Copc : public ::testing::Test {
 protected:
    void SetUp() override {
        const testing::TemporaryFolder folder;
        Schema schema;
        schema.position = PositionType::i32_scaled;
        schema.scale = glm::dvec3(0.01);
        schema.stride = 12;
        schema.add(std::string(names::intensity), ScalarType::u16);
        copc::Info cube;
        cube.centre = glm::dvec3(8);
        cube.half_size = 8;
        cube.spacing = 0.125;
        const auto path = folder / "a.copc.laz";
        const auto writer = copc::NodeWriter::create(path, schema, {}, {}, cube);
        ASSERT_TRUE(writer) << writer.error().line();
        for (uint32_t level = 0; level < 6; ++level) {
            std::vector<std::byte> records(level == 2 ? 0 : 40 * schema.stride);  // one without points
            for (size_t i = 0; i < records.size() / schema.stride; ++i)
                for (size_t axis = 0; axis < 3; ++axis)
                    store(&records[i * schema.stride + 4 * axis], static_cast<int32_t>((i * 7 + axis) % 40));
            ASSERT_TRUE((*writer)->write({level, 0, 0, 0}, records));
        }
        const auto done = (*writer)->finish();
        ASSERT_TRUE(done) << done.error().line();
        bytes_ = testing::read_bytes(path);
        page_ = get<uint64_t>(kPageOffsetAt);
    }

    template <class T>
    T get(size_t at) const {
        return load<T>(reinterpret_cast<const std::byte*>(&bytes_[at]));
    }
    /// Returns the file with one number changed.
    template <class T>
    std::string with(size_t at, T value) const {
        std::string changed = bytes_;
        std::memcpy(&changed[at], &value, sizeof value);
        return changed;
    }
    Result<copc::File> open(const std::string& bytes) const {
        file_.set(bytes);
        return copc::File::open(InputFile::open_shared(file_.path()).value());
    }
    std::string refusal(const std::string& bytes) const {
        const auto opened = open(bytes);
        if (opened) return "opened";
        EXPECT_EQ(opened.error().kind, ErrorKind::input_rejected);
        return opened.error().line();
    }
    size_t entry(size_t i) const { return page_ + i * copc::kEntryBytes; }

    std::string bytes_;
    uint64_t page_ = 0;
    const testing::MemoryFile file_;
};

TEST_F(Copc, AllNodesOfAllPagesAreFound) {
    const auto file = open(bytes_);
    ASSERT_TRUE(file) << file.error().line();
    ASSERT_EQ(file->nodes().size(), 6u);
    EXPECT_EQ(file->info().page_bytes, 5 * copc::kEntryBytes) << "levels 0 to 3 and a reference";
    EXPECT_EQ(file->info().half_size, 8.0);
    EXPECT_TRUE(copc::is_copc(*InputFile::open(file_.path())));
    for (size_t i = 0; i < 6; ++i) {
        const auto records = file->read(i);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->size(), (i == 2 ? 0u : 40u) * file->scan().schema().stride);
    }
    EXPECT_EQ(file->min(), glm::dvec3(0.0));
    EXPECT_NEAR(file->max().x, 0.39, 1e-12);
}

TEST_F(Copc, PagesThatLieAreRefused) {
    ASSERT_EQ(get<int32_t>(entry(4) + 28), -1);
    const uint64_t below = get<uint64_t>(entry(4) + 16);
    EXPECT_THAT(refusal(with(entry(4) + 16, page_)), HasSubstr("pages that overlap")) << "a cycle";
    EXPECT_THAT(refusal(with(entry(4) + 16, below - 32)), HasSubstr("pages that overlap"));
    EXPECT_THAT(refusal(with(entry(4) + 16, uint64_t{bytes_.size()})), HasSubstr("ends before a page"));
    EXPECT_THAT(refusal(with(entry(4) + 16, UINT64_MAX - 31)), HasSubstr("ends before a page"));
    EXPECT_THAT(refusal(with(entry(4) + 24, int32_t{33})), HasSubstr("is no list of entries"));
    EXPECT_THAT(refusal(with(entry(4) + 24, int32_t{0})), HasSubstr("is no list of entries"));
    EXPECT_THAT(refusal(with(entry(4) + 24, int32_t{-32})), HasSubstr("negative size"));
    EXPECT_THAT(refusal(with(kPageOffsetAt + 8, UINT64_MAX - 31)), HasSubstr("ends before a page"));
    EXPECT_THAT(refusal(with(kPageOffsetAt, page_ + 32)), HasSubstr("overlap"));
}

TEST_F(Copc, NodesThatLieAreRefused) {
    EXPECT_THAT(refusal(with(entry(1), int32_t{-1})), HasSubstr("outside the root cube"));
    EXPECT_THAT(refusal(with(entry(1), int32_t{32})), HasSubstr("outside the root cube"));
    EXPECT_THAT(refusal(with(entry(1) + 4, int32_t{2})), HasSubstr("outside the root cube"));
    EXPECT_THAT(refusal(with(entry(1) + 8, int32_t{-1})), HasSubstr("outside the root cube"));
    EXPECT_THAT(refusal(with(entry(1) + 16, uint64_t{375})), HasSubstr("points lie outside the file"));
    EXPECT_THAT(refusal(with(entry(1) + 16, UINT64_MAX)), HasSubstr("points lie outside the file"));
    EXPECT_THAT(refusal(with(entry(1) + 24, INT32_MAX)), HasSubstr("points lie outside the file"));
    EXPECT_THAT(refusal(with(entry(1) + 28, int32_t{-2})), HasSubstr("negative size"));
    EXPECT_THAT(refusal(with(entry(1) + 28, INT32_MAX)), HasSubstr("more than its"));
    EXPECT_THAT(refusal(with(entry(1) + 28, int32_t{39})), HasSubstr("199 points in its hierarchy and 200"));
    EXPECT_THAT(refusal(with(entry(1) + 16, get<uint64_t>(entry(0) + 16))), HasSubstr("points overlap"));
}

TEST_F(Copc, AnInfoRecordWithoutACubeIsRefused) {
    for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e300})
        EXPECT_THAT(refusal(with(kInfoAt + 24, size)), HasSubstr("no cube"));
    EXPECT_THAT(refusal(with(kInfoAt, std::nan(""))), HasSubstr("no cube"));
    EXPECT_THAT(refusal(with(377, 'x')), HasSubstr("no COPC"));
    testing::MemoryFile file;
    file.set(with(377, 'x'));
    EXPECT_FALSE(copc::is_copc(*InputFile::open(file.path())));
    EXPECT_TRUE(open_scan(file.path())) << "what is no COPC is LAZ all the same";
}

TEST_F(Copc, ABoxThatLiesIsThatOfTheRootCube) {
    for (const double lie : {std::nan(""), -HUGE_VAL, -1.0}) {
        const auto file = open(with(179, lie));  // max x
        ASSERT_TRUE(file) << file.error().line();
        EXPECT_EQ(file->min().x, 0.0);
        EXPECT_EQ(file->max().x, 16.0);
    }
}

TEST_F(Copc, FilesThatEndAnywhereAreRefusedOrRead) {
    for (size_t end = 0; end < bytes_.size(); end += 1 + end / 200)
        EXPECT_NE(refusal(bytes_.substr(0, end)), "opened") << "at " << end;
}

TEST_F(Copc, OfADamagedNodeItIsSaidHowTheRestIsRead) {
    const auto sound = open(bytes_);
    const auto& layers = sound->nodes()[3].chunk;
    const auto file =
        open(with(layers.offset + layers.bytes - 12, ~get<uint64_t>(layers.offset + layers.bytes - 12)));
    ASSERT_TRUE(file) << file.error().line();
    const auto records = file->read(3);
    ASSERT_FALSE(records);
    EXPECT_NE(records.error().line().find("; only convert can read the rest, as LAZ"), std::string::npos);
}

TEST_F(Copc, ChangedBytesNeverCrashTheReader) {
    std::mt19937 random(5);
    size_t opened = 0;
    for (int round = 0; round < 2000; ++round) {
        std::string changed = bytes_;
        for (int n = 0; n < 1 + round % 4; ++n) {
            const size_t from = round % 2 ? page_ : 0;
            changed[from + random() % (changed.size() - from)] = static_cast<char>(random());
        }
        const auto file = open(changed);
        if (!file) continue;
        ++opened;
        for (size_t i = 0; i < file->nodes().size(); ++i) (void)file->read(i);
    }
    EXPECT_GT(opened, 50u);
}

TEST(CopcName, IsOnlyWrittenFromAnOctree) {
    const auto writer = create_scan("/tmp/x.COPC.laz", {}, {}, {});
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().kind, ErrorKind::arguments);
}

}  // namespace
}  // namespace lucarne::io
