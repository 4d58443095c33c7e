// Folders include one way only: io <- octree <- gi <- viewer; no engine's room includes another's.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

namespace {

const std::array<std::string, 4> kOrder = {"io", "octree", "gi", "viewer"};
const std::array<std::string, 9> kEngines = {"direct", "vpl", "micro", "environment", "paths", "volume", "fields", "reference", "unlit"};

std::vector<std::string> includes_of(const std::filesystem::path& file) {
    static const std::regex pattern("^\\s*#\\s*include\\s*\"([^\"]+)\"");
    std::vector<std::string> found;
    std::ifstream in(file);
    std::smatch match;
    for (std::string line; std::getline(in, line);)
        if (std::regex_search(line, match, pattern)) found.push_back(match[1]);
    return found;
}

bool starts_with(const std::string& text, const std::string& prefix) { return text.rfind(prefix, 0) == 0; }

TEST(Structure, FoldersIncludeOneWayOnly) {
    size_t files = 0;
    for (size_t folder = 0; folder < kOrder.size(); ++folder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(LUCARNE_SOURCE_DIR) / kOrder[folder])) {
            if (!entry.is_regular_file()) continue;
            ++files;
            for (const auto& include : includes_of(entry.path()))
                for (size_t above = folder + 1; above < kOrder.size(); ++above)
                    EXPECT_FALSE(starts_with(include, kOrder[above] + "/")) << entry.path() << " includes " << include;
        }
    EXPECT_GT(files, 20u);
}

TEST(Structure, NoEngineIncludesAnother) {
    for (const auto& engine : kEngines) {
        const auto room = std::filesystem::path(LUCARNE_SOURCE_DIR) / "gi/engines" / engine;
        if (!std::filesystem::exists(room)) continue;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(room)) {
            if (!entry.is_regular_file()) continue;
            for (const auto& include : includes_of(entry.path()))
                for (const auto& other : kEngines)
                    EXPECT_FALSE(other != engine && starts_with(include, "gi/engines/" + other + "/")) << entry.path() << " includes " << include;
        }
    }
}

/// Hostile names and texts reach a terminal only through io/core/terminal.h, which makes them harmless.
TEST(Structure, OnlyFewFilesWriteToTheTerminal) {
    const std::set<std::string> allowed = {"io/core/terminal.cpp", "io/core/progress.cpp", "io/core/log.cpp",
                                           "viewer/main.cpp"};
    const std::regex writes("^[^/]*(, std(out|err)\\)|\\(std(out|err)[,)]|std::cout|std::cerr|fmt::print|\\b(printf|puts|perror)\\()");
    const std::filesystem::path root = LUCARNE_SOURCE_DIR;
    for (const std::string& folder : kOrder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
            const auto extension = entry.path().extension();
            if ((extension != ".cpp" && extension != ".h") || allowed.contains(entry.path().lexically_relative(root)))
                continue;
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);)
                EXPECT_FALSE(std::regex_search(line, writes)) << entry.path() << ": " << line;
        }
}

}  // namespace
