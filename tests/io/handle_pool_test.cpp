#include "io/core/handle_pool.h"

#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "io/core/file.h"
#include "io/core/machine.h"
#include "io/core/page_cache.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::TemporaryFolder;

std::filesystem::path write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path) << text;
    return path;
}

std::string first_bytes(const InputFile& file) {
    std::string text(4, ' ');
    const auto read = file.read_at(0, std::as_writable_bytes(std::span(text)));
    return read ? text : read.error().why;
}

TEST(HandlePool, ManyFilesAreReadThroughAFewHandlesByManyThreads) {
    const TemporaryFolder folder;
    const auto pool = std::make_shared<HandlePool>(4);
    std::vector<InputFile> files;
    for (int i = 0; i < 50; ++i)
        files.push_back(
            InputFile::open(write(folder / std::to_string(i), std::to_string(1000 + i)), pool).value());
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 500; ++i) {
                const int which = (i * 7 + t * 13) % 50;
                EXPECT_EQ(first_bytes(files[static_cast<size_t>(which)]), std::to_string(1000 + which));
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(pool->open(), 4u);
    files.clear();
    EXPECT_EQ(pool->open(), 0u) << "a file that goes leaves no handle";
}

TEST(HandlePool, FileThatWasReplacedIsNotReadAsTheOneOpened) {
    const TemporaryFolder folder;
    const auto pool = std::make_shared<HandlePool>(1);
    const InputFile a = InputFile::open(write(folder / "a", "1111"), pool).value();
    const InputFile b = InputFile::open(write(folder / "b", "2222"), pool).value();
    EXPECT_EQ(first_bytes(a), "1111");
    EXPECT_EQ(first_bytes(b), "2222");
    write(folder / "new", "9999");
    std::filesystem::rename(folder / "new", folder / "a");
    EXPECT_EQ(first_bytes(a), "has been replaced since it was opened");
    std::filesystem::remove(folder / "a");
    EXPECT_NE(first_bytes(a), "9999");
}

TEST(PageCache, FileIsReadAsBeforeAfterTheKernelForgotIt) {
    const TemporaryFolder folder;
    const std::string text(1 << 20, 'x');
    const auto path = write(folder / "file", text);
    const auto held = drop_page_cache(path);
    ASSERT_TRUE(held) << held.error().line();
    EXPECT_GE(*held, 0.0);
    EXPECT_LE(*held, 1.0);
    EXPECT_EQ(first_bytes(InputFile::open(path).value()), "xxxx");
    EXPECT_EQ(drop_page_cache(folder / "none").error().kind, ErrorKind::input_rejected);
    EXPECT_EQ(drop_page_cache(folder.path()).error().kind, ErrorKind::input_rejected);
    EXPECT_EQ(drop_page_cache(write(folder / "empty", "")).value(), 0.0);
}

TEST(Machine, BuildAndHardwareAreKnown) {
    const BuildInfo build = build_info();
    EXPECT_FALSE(build.version.empty());
    EXPECT_FALSE(build.revision.empty());
    EXPECT_FALSE(build.compiler.empty());
    const MachineInfo machine = machine_info();
    EXPECT_GE(machine.cores, 1u);
    EXPECT_GT(machine.memory, uint64_t{1} << 20);
    EXPECT_TRUE(machine.system.starts_with("Linux"));
}

}  // namespace
}  // namespace lucarne
