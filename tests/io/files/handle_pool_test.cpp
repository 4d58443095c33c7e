#include "io/files/handle_pool.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/core/machine.h"
#include "io/files/file.h"
#include "io/files/page_cache.h"
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

/// Holds threads until so many have arrived, or until a timeout, which only ends a test that hangs.
class MeetingPoint {
 public:
    explicit MeetingPoint(int threads) : missing_(threads) {}
    /// Returns whether all arrived.
    bool meet() {
        std::unique_lock lock(mutex_);
        --missing_;
        changed_.notify_all();
        return changed_.wait_for(lock, std::chrono::minutes(5), [&] { return missing_ <= 0; });
    }

 private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int missing_;
};

TEST(HandlePool, OthersAreReadWhileOneFileIsSlowToOpen) {
    const TemporaryFolder folder;
    MeetingPoint others_read(3);  // two readers and the slow open
    std::atomic<bool> slow_waited{true};
    const auto pool = std::make_shared<HandlePool>(1, [&](const std::filesystem::path& path) {
        if (path.filename() == "slow") slow_waited = others_read.meet();
        return HandlePool::open_to_read(path);
    });
    const InputFile kept = InputFile::open(write(folder / "kept", "1111"), pool).value();
    const InputFile fresh = InputFile::open(write(folder / "fresh", "2222"), pool).value();
    const InputFile slow = InputFile::open(write(folder / "slow", "3333"), pool).value();
    EXPECT_EQ(first_bytes(kept), "1111");  // and the pool has no handle of the slow file
    std::vector<std::thread> threads;
    threads.emplace_back([&] { EXPECT_EQ(first_bytes(slow), "3333"); });
    for (const InputFile* file : {&kept, &fresh})
        threads.emplace_back([&, file] {
            EXPECT_EQ(first_bytes(*file), file == &kept ? "1111" : "2222");
            others_read.meet();
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(slow_waited) << "the readers waited for the slow file";
    EXPECT_EQ(pool->open(), 1u);
}

TEST(HandlePool, OneHandleIsKeptOfAFileThatTwoThreadsOpenAtOnce) {
    const TemporaryFolder folder;
    MeetingPoint both(2);
    std::atomic<int> opened{0};
    HandlePool pool(8, [&](const std::filesystem::path& path) {
        EXPECT_TRUE(both.meet()) << "one thread waited for the other's open";
        ++opened;
        return HandlePool::open_to_read(path);
    });
    struct stat status {};
    ASSERT_EQ(::stat(write(folder / "a", "1111").c_str(), &status), 0);
    const FileIdentity identity{status.st_dev, status.st_ino};
    const uint64_t number = pool.enrol();
    std::array<std::shared_ptr<const Handle>, 2> handles;
    {
        std::vector<std::thread> threads;
        for (auto& handle : handles)
            threads.emplace_back([&] { handle = pool.acquire(number, folder / "a", identity).value(); });
        for (std::thread& thread : threads) thread.join();
    }
    EXPECT_EQ(opened, 2);
    EXPECT_EQ(handles[0], handles[1]);
    EXPECT_EQ(pool.open(), 1u);
    EXPECT_EQ(handles[0].use_count(), 3) << "the pool's and ours";
}

TEST(HandlePool, TheHandleByWhichAFileWasOpenedIsTheFirstOne) {
    const TemporaryFolder folder;
    std::atomic<int> opened{0};
    const auto pool = std::make_shared<HandlePool>(2, [&](const std::filesystem::path& path) {
        ++opened;
        return HandlePool::open_to_read(path);
    });
    const InputFile file = InputFile::open(write(folder / "a", "1111"), pool).value();
    EXPECT_EQ(first_bytes(file), "1111");
    EXPECT_EQ(opened, 0);
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
