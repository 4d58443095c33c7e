// Outputs whose data is synced, but whose name in the folder cannot be synced.
#include <cerrno>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "tests/fault/run_lucarne.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::read_bytes;
using test::lucarne_with_fault;
using test::quoted;

/// Commands that write one file; their last sync is the sync of its folder.
class OutputNames : public testing::Test {
 protected:
    struct Case {
        std::filesystem::path output;
        std::string command;
    };
    std::vector<Case> cases() const {
        const auto scan = folder_ / "a.las", cache = folder_ / "a.luc", text = folder_ / "a.xyz";
        return {{scan, "generate cornell --even --points 1000 -o " + quoted(scan)},
                {cache, "convert --normals none " + quoted(scan) + " -o " + quoted(cache)},
                {text, "export " + quoted(cache) + " -o " + quoted(text)}};
    }
    /// Runs the command and lets its last sync fail.
    test::Outcome run_with(const Case& tested, int error) {
        std::filesystem::remove(tested.output);
        const auto calls = test::traced_calls(folder_ / "calls", tested.command);
        whole_ = read_bytes(tested.output);
        std::filesystem::remove(tested.output);
        const std::string last = std::to_string(test::last_call(calls, "fsync"));
        return lucarne_with_fault("error:" + last + ":" + std::to_string(error), tested.command);
    }

    const io::testing::TemporaryFolder folder_;
    std::string whole_;  ///< the output of the command without a fault
};

TEST_F(OutputNames, ThatMayBeLostAreAnErrorAndTheWholeFileStays) {
    for (const Case& tested : cases())
        for (const int error : {EIO, ENOSPC, EDQUOT}) {
            const auto outcome = run_with(tested, error);
            EXPECT_EQ(outcome.code, 1) << tested.command << outcome.text;
            const std::string says = std::string("its name cannot be synced (") + std::strerror(error) + ")";
            EXPECT_NE(outcome.text.find(says), std::string::npos) << outcome.text;
            EXPECT_TRUE(read_bytes(tested.output) == whole_) << tested.command;
        }
}

TEST_F(OutputNames, OnFileSystemsThatCannotSyncFoldersAreNoError) {
    for (const Case& tested : cases())
        for (const int error : {EINVAL, ENOTSUP}) {
            const auto outcome = run_with(tested, error);
            EXPECT_EQ(outcome.code, 0) << tested.command << outcome.text;
            EXPECT_TRUE(read_bytes(tested.output) == whole_) << tested.command;
        }
}

}  // namespace
}  // namespace lucarne
