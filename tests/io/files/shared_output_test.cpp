// A file that several processes write.
#include "io/files/shared_output.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "io/core/interrupt.h"
#include "tests/temporary_folder.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

/// Opens the output as one of several processes and is interrupted. `finished`: another process has given the
/// output its name by then, and the next conversion to it has begun.
[[noreturn]] void open_and_interrupt(const fs::path& path, bool finished) {
    handle_interrupts();
    const auto opened = SharedOutput::open(path);
    if (!opened) std::_Exit(1);
    if (finished) {
        fs::rename(shared_name(path), path);
        std::ofstream(shared_name(path)) << "next";
    }
    ::kill(::getpid(), SIGTERM);
    for (;;) ::pause();
}

TEST(SharedOutputTest, AnInterruptRemovesItButNotTheNextOneOfItsName) {
    for (const bool finished : {false, true}) {
        const test::Folder folder;
        const fs::path path = folder / "a.luc";
        const auto created = SharedOutput::create(path, false);
        ASSERT_TRUE(created) << created.error().line();
        EXPECT_EXIT(open_and_interrupt(path, finished), ::testing::KilledBySignal(SIGTERM), "");
        EXPECT_EQ(fs::exists(shared_name(path)), finished);
        EXPECT_EQ(fs::exists(path), finished);
    }
}

}  // namespace
}  // namespace lucarne
