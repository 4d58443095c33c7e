#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/temporary_folder.h"
#include "tests/viewer/program.h"
#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {
namespace {

/// A program with the commands `view` and `render`, which note what they were called with.
class CommandLineTest : public testing::Test {
 protected:
    CommandLineTest() {
        for (const char* name : {"view", "render"}) {
            Arguments command = line_.add(name, "A command of the test");
            command.add("inputs", inputs_, "Files");
            command.add("--engine", engine_, "A method");
            command.run([this, name]() -> Result<void> {
                ran_ = name;
                return {};
            });
        }
    }

    /// Parses and runs. Returns the error's line, or nothing.
    std::string run(std::vector<std::string> words) {
        words.insert(words.begin(), "lucarne");
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        const auto action = line_.parse(static_cast<int>(arguments.size()), arguments.data());
        if (!action) return action.error().line();
        if (*action) {
            EXPECT_TRUE((*action)());
        }
        return "";
    }

    CommandLine line_{"lucarne", "A test"};
    std::vector<std::string> inputs_;
    std::string engine_, ran_;
};

TEST_F(CommandLineTest, AFileInThePlaceOfACommandIsViewed) {
    const test::Folder folder;
    const auto file = folder / "scan.las";
    std::ofstream(file) << "x";
    EXPECT_EQ(run({file.string(), "--engine", "direct"}), "");
    EXPECT_EQ(ran_, "view");
    EXPECT_EQ(inputs_, std::vector{file.string()});
    EXPECT_EQ(engine_, "direct");
}

TEST_F(CommandLineTest, CommandsTakeTheirOwnArguments) {
    EXPECT_EQ(run({"render", "a.las", "b.las"}), "");
    EXPECT_EQ(ran_, "render");
    EXPECT_EQ(inputs_, (std::vector<std::string>{"a.las", "b.las"}));
}

TEST_F(CommandLineTest, SlipsAreAnsweredWithWhatWasMeant) {
    EXPECT_NE(run({"rendr", "a.las"}).find("did you mean render?"), std::string::npos);
    EXPECT_NE(run({"render", "a.las", "--enigne", "vpl"}).find("did you mean --engine?"), std::string::npos);
    EXPECT_NE(run({"render", "--entirely-different"}).find("see lucarne render --help"), std::string::npos);
    EXPECT_NE(run({"missing.las"}).find("neither a command nor a file"), std::string::npos);
    EXPECT_EQ(ran_, "");
    EXPECT_NE(run({"--enigne", "vpl"}).find("did you mean --engine?"), std::string::npos);
}

TEST_F(CommandLineTest, NothingOrAnOptionInThePlaceOfACommandIsViewed) {
    EXPECT_EQ(run({}), "");
    EXPECT_EQ(ran_, "view");
    ran_.clear();
    EXPECT_EQ(run({"--engine", "vpl", "a.las"}), "");
    EXPECT_EQ(ran_, "view");
    EXPECT_EQ(engine_, "vpl");
    EXPECT_EQ(inputs_, std::vector<std::string>{"a.las"});
}

TEST(CommandHelp, ListsEverydayOptionsFirstAndTheOthersUnderTitles) {
    const test::Outcome ran = test::lucarne("render --help");
    EXPECT_EQ(ran.code, 0);
    size_t last = 0;
    for (const char* part :
         {"--output", "--mood", "--engine", "--size", "\nReading scans:", "--columns",
          "\nEngines:", "--bounces", "\nPoints and colours:", "--clip-box",
          "\nExposure, albedo and comparison:", "--exposure", "\nDetail and memory:", "--memory"}) {
        const size_t at = ran.output.find(part, last);
        ASSERT_NE(at, std::string::npos) << part << " is missing, or above what it should follow";
        last = at;
    }
}

TEST_F(CommandLineTest, TheVersionIsPrinted) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(run({"--version"}), "");
    const std::string printed = testing::internal::GetCapturedStdout();
    EXPECT_EQ(printed.find("lucarne "), 0u);
    EXPECT_EQ(printed.find('\n'), printed.size() - 1) << "one line, which ends";
    EXPECT_EQ(ran_, "");
}

}  // namespace
}  // namespace lucarne::viewer
