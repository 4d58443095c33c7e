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
    for (const char* part : {"--output", "--mood", "--engine", "--size", "\nPoints and colours:",
                             "--clip-box", "\nExposure, albedo and comparison:", "--exposure",
                             "\nDetail and memory:", "--memory", "\nEngines:", "--bounces",
                             "Do not favour VPLs that light the view", "\nReading scans:", "--columns"}) {
        const size_t at = ran.output.find(part, last);
        ASSERT_NE(at, std::string::npos) << part << " is missing, or above what it should follow";
        last = at;
    }
}

TEST(CommandHelp, ListsCommandsInGroups) {
    const std::string help = test::lucarne("--help").output;
    size_t last = 0;
    for (const char* part : {"\nLook:", "\n  view ", "\n  render ", "\nScans and caches:", "\n  convert ",
                             "\nMeasure and compare:", "\n  generate "}) {
        const size_t at = help.find(part, last);
        ASSERT_NE(at, std::string::npos) << part << " in " << help;
        last = at;
    }
}

TEST(CommandErrors, WrongNamesAreFoundBeforeAnythingIsOpened) {
    const test::TemporaryFolder folder;
    const std::string output = folder / "never.png";
    const auto refused = [&](const std::string& options) {
        // The scan is not there, which would be said first if it were opened.
        const test::Outcome ran = test::lucarne("render " + (folder / "no.las") + " -o " + output + options);
        EXPECT_EQ(ran.code, 2) << ran.output;
        return ran.output;
    };
    EXPECT_EQ(refused(" --engine vlp").find("lucarne: unknown engine 'vlp'; did you mean vpl?"), 0u);
    EXPECT_EQ(refused(" --tone-map filmc")
                  .find("lucarne: --tone-map: unknown tone map 'filmc'; did you mean filmic?"),
              0u);
    EXPECT_EQ(refused(" --colour elevatoin")
                  .find("lucarne: --colour: unknown colour 'elevatoin'; did you mean elev"),
              0u);
    EXPECT_EQ(refused(" --beside vlp").find("lucarne: unknown engine 'vlp'"), 0u);
    EXPECT_NE(refused(" --luminance 3").find("is not a range of luminances"), std::string::npos);
}

TEST(CommandErrors, AnAxisThatDoesNotExistPointsNowhere) {
    const test::Outcome ran = test::lucarne("info --up w no.las");
    EXPECT_EQ(ran.code, 2);
    EXPECT_NE(ran.output.find("--up: is none of x, y, z, -x, -y, -z"), std::string::npos) << ran.output;
}

TEST(CommandErrors, AMissingInputIsCalledSo) {
    for (const std::string command : {"render -o a.png", "render", "convert -o a.luc", "info"}) {
        const test::Outcome ran = test::lucarne(command);
        EXPECT_EQ(ran.code, 2);
        const std::string name = command.substr(0, command.find(' '));
        EXPECT_EQ(ran.output, "lucarne: no input given; see lucarne " + name + " --help\n");
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
