// Conversions of two small scans on several ranks, one of which fails.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/cluster/ranks.h"

namespace lucarne::test {

inline constexpr const char* kSmall = " --memory 48M -o ";

class RankFaults : public testing::Test {
 protected:
    void SetUp() override {
        LUCARNE_NEEDS_RANKS();
        for (const char* scene : {"cornell", "house"}) {
            const Outcome made = lucarne(std::string("generate ") + scene + " --points 60k -o " +
                                         folder_ / (std::string(scene) + ".las"));
            ASSERT_EQ(made.code, 0) << made.output;
        }
        std::filesystem::create_directory(folder_ / "out");
        std::filesystem::create_directory(folder_ / "temp");
    }
    std::string inputs() const { return folder_ / "cornell.las" + " " + folder_ / "house.las"; }
    std::string output() const { return folder_ / "out/a.luc"; }
    std::string convert() const {
        return "convert " + inputs() + " --temp " + folder_ / "temp" + temp_of_rank_ + kSmall + output();
    }
    /// Runs the conversion without a fault, each rank with the --temp that its number gives.
    Outcome without_fault(const std::string& options, int count) const {
        return with_fault(count, "none", options, count);
    }
    /// Runs a conversion on some ranks, one of them with a fault.
    Outcome with_fault(int rank, const std::string& fault, const std::string& options = {},
                       int count = 3) const {
        const std::string script = folder_ / "rank.sh";
        std::ofstream(script) << "#!/bin/sh\nif [ \"$OMPI_COMM_WORLD_RANK\" = " << rank
                              << " ]; then ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" LUCARNE_FAULTS
                                 "' LUCARNE_FAULT='"
                              << fault << "'; export ASAN_OPTIONS LD_PRELOAD LUCARNE_FAULT; fi\nexec "
                              << LUCARNE_BINARY << " " << convert() << " " << options << "\n";
        return shell(mpirun(count) + "sh " + script);
    }
    void expect_nothing_left(bool resumable = false) const {
        for (const char* place : {"out", "temp"})
            if (!resumable || place != std::string("temp"))
                for (const auto& entry : std::filesystem::directory_iterator(folder_ / place))
                    ADD_FAILURE() << entry.path() << " was left";
    }
    TemporaryFolder folder_;
    /// What follows --temp; the shell of each rank expands it.
    std::string temp_of_rank_;
};

/// Returns how often a text occurs.
inline size_t times(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
    return count;
}

}  // namespace lucarne::test
