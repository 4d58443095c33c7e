// What goes wrong on one rank ends all of them with a clear error, and nothing half-written stays.
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/cluster/rank_faults.h"

namespace lucarne {
namespace {

using test::kSmall;
using test::lucarne;
using test::mpirun;
using test::on_ranks;
using test::Outcome;
using test::RankFaults;
using test::shell;
using test::times;

TEST_F(RankFaults, AKilledRankEndsAllAndLeavesNothing) {
    const std::string counted = folder_ / "calls";
    for (const int rank : {0, 1}) {
        ASSERT_EQ(with_fault(rank, "count:" + counted).code, 0);
        ASSERT_EQ(std::filesystem::remove(output()), true);
        const int calls = std::stoi(test::bytes_of(counted));
        ASSERT_GT(calls, 20);
        for (const int at : {calls / 3, 2 * calls / 3}) {
            const Outcome killed = with_fault(rank, "kill:" + std::to_string(at));
            EXPECT_NE(killed.code, 0) << killed.output;
            EXPECT_NE(killed.output.find("signal 9"), std::string::npos) << killed.output;
            expect_nothing_left(true);
        }
    }
}

TEST_F(RankFaults, AFullDiskOfOneRankIsTheErrorOfAll) {
    const std::string counted = folder_ / "calls";
    ASSERT_EQ(with_fault(1, "count:" + counted).code, 0);
    std::filesystem::remove(output());
    const int calls = std::stoi(test::bytes_of(counted));
    const Outcome full = with_fault(1, "full:" + std::to_string(calls / 2));
    EXPECT_EQ(full.code, 1) << full.output;
    EXPECT_EQ(times(full.output, "No space left on device"), 3u) << full.output;
    for (const char* who : {"(rank 0 of 3)", "(rank 1 of 3)", "(rank 2 of 3)"})
        EXPECT_EQ(times(full.output, who), 1u) << full.output;
    expect_nothing_left();
}

TEST_F(RankFaults, ABrokenInputIsSkippedAsByOneProcess) {
    const std::string broken = folder_ / "broken.las", bytes = test::bytes_of(folder_ / "house.las");
    std::ofstream(broken, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    const std::string what = "convert " + inputs() + " " + broken + kSmall;
    const Outcome one = lucarne(what + folder_ / "one.luc"), several = on_ranks(3, what + output());
    EXPECT_EQ(one.code, 3) << one.output;
    EXPECT_EQ(several.code, 3) << several.output;
    EXPECT_TRUE(test::bytes_of(folder_ / "one.luc") == test::bytes_of(output()));
}

TEST_F(RankFaults, WarningsAboutInputsAreThoseOfOneProcess) {
    // Some are about headers, which other ranks read than the points.
    std::string odd;
    std::vector<std::string> warnings;
    for (const char* name : {"a.ply", "b.ply", "c.ply", "d.ply", "e.ply"}) {
        std::ofstream(folder_ / name) << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                         "property float y\nend_header\n0 0\n1 0\n0 1\n1 1\n";
        odd += folder_ / name + " ";
        warnings.push_back(folder_ / name + ": its vertices have no z");
    }
    for (const char* name : {"f.las", "g.las", "h.las"}) {  // they state boxes of 1 mm
        std::string bytes = test::bytes_of(folder_ / "cornell.las");
        for (const size_t high : {179, 195, 211}) {
            double low = 0;
            std::memcpy(&low, &bytes[high + sizeof low], sizeof low);
            const double just_above = low + .001;
            std::memcpy(&bytes[high], &just_above, sizeof just_above);
        }
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        odd += folder_ / name + " ";
        warnings.push_back(folder_ / name + ": has points far outside the bounds");
    }
    const std::string what = "convert " + odd + kSmall;
    const Outcome one = lucarne(what + folder_ / "one.luc"), several = on_ranks(3, what + output());
    ASSERT_EQ(one.code, 0) << one.output;
    ASSERT_EQ(several.code, 0) << several.output;
    for (const std::string& warning : warnings) {
        EXPECT_EQ(times(one.output, warning), 1u) << one.output;
        EXPECT_EQ(times(several.output, warning), 1u) << several.output;
    }
}

TEST_F(RankFaults, AnInputThatChangesWhileItIsReadIsTheErrorOfAll) {
    // The first two writes of a rank are records of its journal: the identity, and that of the scan stage.
    // No rank reads its inputs again before all have written the second one.
    const std::string house = folder_ / "house.las";
    // Nearly all its points move to one place, in a file of the same size.
    ASSERT_GT(std::filesystem::file_size(house), 1501000u);
    ::setenv("LUCARNE_FAULT_COMMAND",
             ("dd if=/dev/zero of=" + house + " bs=1000 seek=1 count=1500 conv=notrunc status=none").c_str(),
             1);
    const Outcome changed = with_fault(2, "run-write:2");
    ::unsetenv("LUCARNE_FAULT_COMMAND");
    EXPECT_EQ(changed.code, 3) << changed.output;
    EXPECT_EQ(times(changed.output, "changed while they were read"), 3u) << changed.output;
    expect_nothing_left();
}

TEST_F(RankFaults, ASecondConversionToTheSameCacheIsRefused) {
    // The first one is any process that holds the lock of the unfinished file: this one.
    const std::string part = folder_ / "out/.a.luc.lucarne-part";
    std::ofstream(part) << "x";
    const int held = ::open(part.c_str(), O_RDWR | O_CLOEXEC);
    struct flock lock {};
    lock.l_type = F_WRLCK;
    ASSERT_EQ(::fcntl(held, F_OFD_SETLK, &lock), 0);
    const Outcome second = on_ranks(2, convert());
    EXPECT_EQ(second.code, 1) << second.output;
    EXPECT_EQ(times(second.output, "another conversion to this cache is running"), 2u) << second.output;
    EXPECT_EQ(test::bytes_of(part), "x");
    ::close(held);
}

TEST_F(RankFaults, WhatAKilledConversionLeftIsReplaced) {
    std::ofstream(folder_ / "out/.a.luc.lucarne-part") << "left by a power cut";
    const Outcome done = on_ranks(2, convert());
    EXPECT_EQ(done.code, 0) << done.output;
    const Outcome one = lucarne("convert " + inputs() + kSmall + folder_ / "one.luc");
    ASSERT_EQ(one.code, 0) << one.output;
    EXPECT_TRUE(test::bytes_of(folder_ / "one.luc") == test::bytes_of(output()));
}

TEST_F(RankFaults, RanksThatSeeOtherInputsOrOptionsAreRefused) {
    const std::string script = folder_ / "rank.sh";
    std::ofstream(script) << "#!/bin/sh\nexec " << LUCARNE_BINARY
                          << " convert " + inputs() + " --memory 5${OMPI_COMM_WORLD_RANK}M -o " + output() +
                                 "\n";
    const Outcome options = shell(mpirun(2) + "sh " + script);
    EXPECT_EQ(options.code, 1) << options.output;
    EXPECT_EQ(times(options.output, "rank 1 has another one than rank 0"), 2u) << options.output;
    std::ofstream(script) << "#!/bin/sh\nif [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then first=" +
                                 folder_ / "house.las" + "; fi\nexec " + LUCARNE_BINARY + " convert $first " +
                                 folder_ / "cornell.las" + kSmall + output() + "\n";
    const Outcome seen = shell(mpirun(2) + "sh " + script);
    EXPECT_EQ(seen.code, 1) << seen.output;
    EXPECT_EQ(times(seen.output, "rank 1 has another one than rank 0"), 2u) << seen.output;
    expect_nothing_left();
}

TEST_F(RankFaults, RanksOfDifferentBuildsAreRefused) {
    // A build of the same revision, with other bytes.
    const std::string other = folder_ / "lucarne";
    std::filesystem::copy_file(LUCARNE_BINARY, other);
    std::filesystem::copy_file(test::mpi_program(), other + "-mpi");
    std::ofstream(other + "-mpi", std::ios::binary | std::ios::app) << "x";
    const std::string script = folder_ / "rank.sh";
    std::ofstream(script) << "#!/bin/sh\nprogram=" << LUCARNE_BINARY
                          << "\nif [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then program=" << other
                          << "; fi\nexec $program " << convert() << "\n";
    const Outcome refused = shell(mpirun(3) + "sh " + script);
    EXPECT_EQ(refused.code, 1) << refused.output;
    EXPECT_EQ(times(refused.output, "lucarne-mpi: rank 1 has another one than rank 0"), 3u) << refused.output;
    expect_nothing_left();
}

TEST_F(RankFaults, AnErrorOfAppendingIsTheErrorOfAll) {
    const Outcome missing = on_ranks(3, convert() + " --append");
    EXPECT_EQ(missing.code, 3) << missing.output;
    EXPECT_EQ(times(missing.output, "lucarne: " + output()), 3u) << missing.output;
    expect_nothing_left();
}

TEST(WithoutMpi, AConversionInSeveralCopiesIsRefused) {
    const test::TemporaryFolder folder;
    const std::string alone = folder / "lucarne";
    std::filesystem::copy_file(LUCARNE_BINARY, alone);
    const Outcome refused = shell("OMPI_COMM_WORLD_SIZE=3 " + alone + " convert a.las -o a.luc");
    EXPECT_EQ(refused.code, 1) << refused.output;
    EXPECT_NE(refused.output.find("was started in 3 copies by MPI, but"), std::string::npos)
        << refused.output;
}

}  // namespace
}  // namespace lucarne
