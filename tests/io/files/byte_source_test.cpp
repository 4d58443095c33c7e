// Bytes by offset: files and memory give the same results, also to the readers of scans.
#include "io/files/byte_source.h"

#include <gmock/gmock.h>

#include "io/files/file.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::TemporaryFolder;

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// The same text as a file, as memory that the source owns and as memory that it does not own.
class ByteSources : public ::testing::Test {
 protected:
    ByteSources() {
        io::testing::write_bytes(folder_ / "a", kText);
        sources_ = {InputFile::open_shared(folder_ / "a").value(),
                    std::make_shared<const MemorySource>("b", bytes_of(kText), 7),
                    std::make_shared<const MemorySource>("c", std::as_bytes(std::span(kText)))};
    }
    static constexpr std::string_view kText = "0123456789";
    const TemporaryFolder folder_;
    std::vector<std::shared_ptr<const ByteSource>> sources_;
};

TEST_F(ByteSources, ReadsGiveWhatIsThere) {
    for (const auto& source : sources_) {
        EXPECT_EQ(source->size(), kText.size());
        for (const auto& [offset, wanted, there] :
             std::vector<std::tuple<uint64_t, size_t, std::string_view>>{{0, 10, "0123456789"},
                                                                         {3, 4, "3456"},
                                                                         {8, 4, "89"},
                                                                         {10, 1, ""},
                                                                         {11, 5, ""},
                                                                         {1ull << 62, 5, ""},
                                                                         {4, 0, ""}}) {
            std::string text(wanted, ' ');
            const auto out = std::as_writable_bytes(std::span(text));
            EXPECT_EQ(source->read_some(offset, out).value(), there.size());
            EXPECT_EQ(text.substr(0, there.size()), there);
            EXPECT_EQ(source->read_at(offset, out).has_value(), there.size() == wanted) << offset;
        }
    }
}

TEST_F(ByteSources, AReadPastTheEndNamesTheSourceAndSaysHowMuchWasThere) {
    std::array<std::byte, 4> out{};
    for (const auto& source : sources_) {
        const auto read = source->read_at(8, out);
        ASSERT_FALSE(read);
        EXPECT_EQ(read.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(read.error().line(), ::testing::HasSubstr(source->path().string() +
                                                              ": ends early: 4 bytes wanted at 8, 2 there"));
    }
}

TEST_F(ByteSources, TheStateOfAFileShowsThatItWasChanged) {
    EXPECT_EQ(sources_[1]->modified(), 7);
    EXPECT_EQ(sources_[2]->modified(), 0);
    const auto before = sources_[0];
    std::filesystem::last_write_time(folder_ / "a",
                                     std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
    const auto after = InputFile::open_shared(folder_ / "a").value();
    EXPECT_GT(after->modified(), before->modified());
}

TEST(MemoryScans, EverySharedScanReadsTheSameOutOfMemory) {
    if (io::testing::shared_data().empty()) GTEST_SKIP() << "no shared data";
    constexpr uintmax_t kLargest = 5 << 20;
    io::ReadOptions options;
    options.quiet = true;
    options.mesh.samples = 1000;
    size_t scans = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(io::testing::shared_data())) {
        if (!entry.is_regular_file() || entry.file_size() > kLargest) continue;
        const auto file = InputFile::open_shared(entry.path()).value();
        const auto bytes = bytes_of(io::testing::read_bytes(entry.path()));
        const auto memory =
            std::make_shared<const MemorySource>(entry.path(), std::span(bytes), file->modified());
        const auto a = io::open_scan(file, options), b = io::open_scan(memory, options);
        ASSERT_EQ(a.has_value(), b.has_value()) << entry.path();
        if (!a) {
            EXPECT_EQ(a.error().line(), b.error().line());
            continue;
        }
        EXPECT_EQ((*a)->info().format, (*b)->info().format);
        EXPECT_EQ((*a)->info().modified, (*b)->info().modified);
        const auto x = io::testing::read_all(**a), y = io::testing::read_all(**b);
        ASSERT_EQ(x.has_value(), y.has_value()) << entry.path();
        if (x) {
            EXPECT_TRUE(x->bytes == y->bytes) << entry.path();
        }
        ++scans;
    }
    EXPECT_GT(scans, 30u);
}

}  // namespace
}  // namespace lucarne
