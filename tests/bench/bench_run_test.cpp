#include "tests/bench/bench_run.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace lucarne::bench {
namespace {

std::string read(std::vector<std::string> arguments, BenchRun& run) {
    arguments.insert(arguments.begin(), "program");
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    return read_arguments(static_cast<int>(pointers.size()), pointers.data(),
                          {.options = {"only"}, .subjects = {"thesis"}, .parts = {"5", "6"}}, run);
}

TEST(BenchRun, ReadsFolderSubjectPartsAndNumbers) {
    BenchRun run;
    EXPECT_EQ(read({"folder", "thesis", "6", "5", "--scale", ".5", "--only", "3"}, run), "");
    EXPECT_EQ(run.folder, "folder");
    EXPECT_EQ(run.subject, "thesis");
    EXPECT_TRUE(run.wants("5"));
    EXPECT_FALSE(run.wants("7"));
    EXPECT_EQ(run.scale, .5);
    EXPECT_EQ(run.option("only", 0), 3);
}

TEST(BenchRun, APartThatDoesNotExistIsNoFolder) {
    BenchRun run;
    EXPECT_EQ(read({"thesis", "4"}, run), "4");
    EXPECT_TRUE(run.folder.empty());
}

TEST(BenchRun, ASecondFolderIsAMistake) {
    BenchRun run;
    EXPECT_EQ(read({"here", "thesiss"}, run), "thesiss");
}

}  // namespace
}  // namespace lucarne::bench
