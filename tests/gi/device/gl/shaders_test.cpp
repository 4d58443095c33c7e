// Checks every compute shader, with every combination of its switches, with Khronos' own compiler.
#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/device/gl/shader_source.h"
#include "gi/device/gl/shader_texts.h"
#include "tests/viewer/program.h"

namespace lucarne::gi {
namespace {

/// Returns the macros that a source tests with #if and #ifdef, without include guards.
std::vector<std::string> switches_of(const std::string& text) {
    static const std::regex conditional("^\\s*#\\s*(?:el)?if(?:def)?\\b.*$", std::regex::multiline);
    static const std::regex name("LUCARNE_[A-Z_]+");
    std::set<std::string> names;
    for (std::sregex_iterator line(text.begin(), text.end(), conditional), end; line != end; ++line) {
        const std::string words = line->str();
        for (std::sregex_iterator word(words.begin(), words.end(), name); word != end; ++word)
            names.insert(word->str());
    }
    return {names.begin(), names.end()};
}

/// Constants that every shader gets; shaders that do not use one ignore it.
const Defines kConstants = {{"RAMP", "16"}};

/// Returns the sources with every subset of their switches, under a file name each.
std::vector<std::pair<std::string, ShaderSource>> variants(std::string_view path) {
    std::vector<std::pair<std::string, ShaderSource>> made;
    const auto plain = shader_source(path, {}, shader_texts());
    if (!plain) {
        ADD_FAILURE() << plain.error().line();
        return made;
    }
    const auto switches = switches_of(plain->text);
    std::string name(path);
    std::replace(name.begin(), name.end(), '/', '-');
    for (uint32_t chosen = 0; chosen < 1u << switches.size(); ++chosen) {
        Defines defines = kConstants;
        for (size_t i = 0; i < switches.size(); ++i)
            if (chosen >> i & 1) defines.emplace_back(switches[i], "1");
        auto source = shader_source(path, defines, shader_texts());
        EXPECT_TRUE(source) << path;
        if (source) made.emplace_back(std::to_string(chosen) + "-" + name, std::move(*source));
    }
    return made;
}

TEST(Shaders, EveryVariantIsAcceptedByGlslang) {
    ASSERT_EQ(test::shell("glslangValidator --version").code, 0) << "install glslang-tools";
    const test::TemporaryFolder folder;
    size_t count = 0;
    std::string files;
    for (const ShaderText& shader : shader_texts()) {
        if (!shader.path.ends_with(".comp")) continue;
        for (const auto& [name, source] : variants(shader.path)) {
            std::ofstream(folder / name) << source.text;
            files += " " + name;
            ++count;
        }
    }
    EXPECT_GT(count, 40u);
    const auto checked = test::shell("cd '" + folder.path().string() + "' && glslangValidator" + files);
    EXPECT_EQ(checked.code, 0) << checked.output;
}

TEST(Shaders, NoneAsksForTheLengthOfARuntimeArray) {
    for (const ShaderText& shader : shader_texts())
        EXPECT_EQ(shader.text.find(".length()"), std::string_view::npos)
            << shader.path << ": drivers differ there, pass the size as a uniform";
}

}  // namespace
}  // namespace lucarne::gi
