// Folders include one way only: io <- octree <- gi <- viewer. No engine's folder includes another's.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace {

const std::array<std::string, 4> kOrder = {"io", "octree", "gi", "viewer"};

std::vector<std::string> includes_of(const std::filesystem::path& file) {
    static const std::regex pattern("^\\s*#\\s*include\\s*\"([^\"]+)\"");
    std::vector<std::string> found;
    std::ifstream in(file);
    std::smatch match;
    for (std::string line; std::getline(in, line);)
        if (std::regex_search(line, match, pattern)) found.push_back(match[1]);
    return found;
}

bool is_shader(const std::filesystem::path& extension) {
    return std::set<std::filesystem::path>{".comp", ".vert", ".geom", ".frag", ".glsl"}.contains(extension);
}

bool starts_with(const std::string& text, const std::string& prefix) {
    return text.rfind(prefix, 0) == 0;
}

TEST(Structure, FoldersIncludeOneWayOnly) {
    size_t files = 0;
    for (size_t folder = 0; folder < kOrder.size(); ++folder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(
                 std::filesystem::path(LUCARNE_SOURCE_DIR) / kOrder[folder])) {
            if (!entry.is_regular_file()) continue;
            ++files;
            for (const auto& include : includes_of(entry.path()))
                for (size_t above = folder + 1; above < kOrder.size(); ++above)
                    EXPECT_FALSE(starts_with(include, kOrder[above] + "/"))
                        << entry.path() << " includes " << include;
        }
    EXPECT_GT(files, 20u);
}

TEST(Structure, NoEngineIncludesAnother) {
    const auto rooms = std::filesystem::path(LUCARNE_SOURCE_DIR) / "gi/engines";
    std::set<std::string> engines;
    for (const auto& entry : std::filesystem::directory_iterator(rooms))
        engines.insert(entry.path().filename());
    EXPECT_GE(engines.size(), 4u);
    for (const auto& engine : engines)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(rooms / engine)) {
            if (!entry.is_regular_file()) continue;
            for (const auto& include : includes_of(entry.path()))
                for (const auto& other : engines)
                    EXPECT_FALSE(other != engine && starts_with(include, "gi/engines/" + other + "/"))
                        << entry.path() << " includes " << include;
        }
}

/// Tests run beside each other, so a folder with a fixed name would be emptied by one while another uses it.
TEST(Structure, TestsTakeTemporaryFoldersFromOnePlace) {
    const auto tests = std::filesystem::path(LUCARNE_SOURCE_DIR) / "tests";
    const std::set<std::filesystem::path> allowed = {
        tests / "temporary_folder.h", tests / "structure/includes_test.cpp",
        tests / "viewer/window/golden_window_test.cpp"};  // leaves its picture for people to look at
    size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(tests)) {
        const auto extension = entry.path().extension();
        if ((extension != ".cpp" && extension != ".h") || allowed.contains(entry.path())) continue;
        ++files;
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);)
            EXPECT_EQ(line.find("temp_directory_path"), std::string::npos)
                << entry.path() << ": use test::Folder of tests/temporary_folder.h";
    }
    EXPECT_GT(files, 100u);
}

/// For each folder or file of one folder: the others of that folder that it includes.
using Graph = std::map<std::string, std::set<std::string>>;

/// Returns the nodes of a cycle, or nothing if there is none.
std::vector<std::string> find_cycle(const Graph& graph) {
    std::set<std::string> done;
    std::vector<std::string> path;
    const std::function<bool(const std::string&)> visit = [&](const std::string& node) {
        const auto seen = std::find(path.begin(), path.end(), node);
        if (seen != path.end()) {
            path.erase(path.begin(), seen);
            return true;
        }
        if (done.contains(node)) return false;
        path.push_back(node);
        if (const auto found = graph.find(node); found != graph.end())
            for (const std::string& next : found->second)
                if (visit(next)) return true;
        path.pop_back();
        done.insert(node);
        return false;
    };
    for (const auto& [node, nexts] : graph)
        if (visit(node)) return path;
    return {};
}

/// Within each folder, its folders and files include each other one way only. A header and its .cpp count as
/// two files, so that an implementation may use files that include its interface.
TEST(Structure, NoFolderHasCyclesAmongItsParts) {
    const std::filesystem::path root = LUCARNE_SOURCE_DIR;
    std::map<std::string, Graph> folders;
    for (const std::string& top : kOrder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / top)) {
            if (!entry.is_regular_file()) continue;
            const std::filesystem::path from = entry.path().lexically_relative(root);
            for (const std::string& include : includes_of(entry.path())) {
                const std::filesystem::path to = include;
                auto a = from.begin(), b = to.begin();
                std::filesystem::path common;
                for (; a != from.end() && b != to.end() && *a == *b; ++a, ++b) common /= *a;
                if (!common.empty() && a != from.end() && b != to.end())
                    folders[common][a->string()].insert(b->string());
            }
        }
    EXPECT_GT(folders.size(), 30u);
    for (const auto& [folder, graph] : folders) {
        std::string cycle;
        for (const std::string& node : find_cycle(graph)) cycle += node + " -> ";
        EXPECT_TRUE(cycle.empty()) << folder << ": " << cycle << "...";
    }
}

TEST(Structure, NoFileIsADumpingGround) {
    constexpr size_t kMostLines = 600;
    const std::filesystem::path root = LUCARNE_SOURCE_DIR;
    for (const std::string& top : kOrder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / top)) {
            std::ifstream in(entry.path());
            size_t lines = 0;
            for (std::string line; std::getline(in, line);) ++lines;
            if (entry.path().extension() != ".md") {
                EXPECT_LE(lines, kMostLines) << entry.path();
            }
        }
}

/// C++ and shaders take bindings from one header a room (bindings.h).
TEST(Structure, NoShaderHasABindingOfItsOwn) {
    const std::regex literal("binding *= *[0-9]");
    size_t shaders = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(LUCARNE_SOURCE_DIR) / "gi")) {
        const auto extension = entry.path().extension();
        if (!is_shader(extension)) continue;
        ++shaders;
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);)
            EXPECT_FALSE(std::regex_search(line, literal)) << entry.path() << ": " << line;
    }
    EXPECT_GT(shaders, 40u);
}

/// Returns the constants (k...) that a file defines, also those after a comma.
std::set<std::string> constants_of(const std::filesystem::path& file) {
    static const std::regex begins("\\b(const|constexpr|LUCARNE_CONST)\\b");
    static const std::regex name("\\b(k[A-Z]\\w*)(\\[[^=]*\\])? *(=[^=]|[({])");
    std::set<std::string> found;
    std::ifstream in(file);
    bool inside = false;  // a statement that defines constants
    for (std::string line; std::getline(in, line);) {
        line = line.substr(0, std::min(line.find("//"), size_t{300})) + " ";
        inside = inside || std::regex_search(line, begins);
        if (!inside) continue;
        for (std::sregex_iterator at(line.begin(), line.end(), name), end; at != end; ++at)
            found.insert((*at)[1]);
        inside = line.find_first_of(";{}") == std::string::npos;
    }
    return found;
}

/// What both need stands in one header beside the shader, in the language of gi/shared/language.h.
TEST(Structure, NoConstantStandsInAShaderAndInCpp) {
    const std::filesystem::path root = LUCARNE_SOURCE_DIR;
    std::map<std::string, std::string> in_shaders;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "gi")) {
        const auto extension = entry.path().extension();
        if (!is_shader(extension) && extension != ".cl") continue;
        for (const std::string& name : constants_of(entry.path()))
            in_shaders[name] = entry.path().lexically_relative(root);
    }
    EXPECT_TRUE(in_shaders.contains("kMostHidden")) << "one that a shader has for itself";
    size_t constants = 0;
    for (const std::string folder : {"gi", "viewer"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
            const auto extension = entry.path().extension();
            if (extension != ".cpp" && extension != ".h") continue;
            for (const std::string& name : constants_of(entry.path())) {
                ++constants;
                const auto other = in_shaders.find(name);
                EXPECT_TRUE(other == in_shaders.end())
                    << name << " of " << entry.path() << " is also one of " << other->second;
            }
        }
    EXPECT_GT(constants, 500u);
}

/// Hostile names and texts reach a terminal only through io/core/terminal.h, which neutralises them.
TEST(Structure, OnlyFewFilesWriteToTheTerminal) {
    const std::set<std::string> allowed = {"io/core/terminal.cpp", "io/core/progress.cpp", "io/core/log.cpp",
                                           "viewer/program/program.cpp"};
    const std::regex writes(
        "^[^/]*(, "
        "std(out|err)\\)|\\(std(out|err)[,)]|std::cout|std::cerr|fmt::print|\\b(printf|puts|perror)\\()");
    const std::filesystem::path root = LUCARNE_SOURCE_DIR;
    for (const std::string& folder : kOrder)
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
            const auto extension = entry.path().extension();
            if ((extension != ".cpp" && extension != ".h") ||
                allowed.contains(entry.path().lexically_relative(root)))
                continue;
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);)
                EXPECT_FALSE(std::regex_search(line, writes)) << entry.path() << ": " << line;
        }
}

}  // namespace
