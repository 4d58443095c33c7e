// Checks every shader, with every combination of its switches, and every header that shaders share
// with C++, with Khronos' own compiler.
#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/device/common/shader_source.h"
#include "gi/device/common/shader_texts.h"
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
const Defines kConstants = {{"RAMP", "16"}, {"VERTICES", "15"}};

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

/// Writes shaders to files and compiles them with glslangValidator.
class Glslang {
 public:
    void add(const std::string& name, const ShaderSource& source) {
        std::ofstream(folder_ / name) << source.text;
        files_ += " " + name;
        ++count_;
    }
    size_t count() const { return count_; }
    void expect_success() const {
        ASSERT_EQ(test::shell("glslangValidator --version").code, 0) << "install glslang-tools";
        const auto checked = test::shell("cd '" + folder_.path().string() + "' && glslangValidator" + files_);
        EXPECT_EQ(checked.code, 0) << checked.output;
    }

 private:
    test::TemporaryFolder folder_;
    std::string files_;
    size_t count_ = 0;
};

TEST(Shaders, EveryVariantIsAcceptedByGlslang) {
    Glslang glslang;
    for (const ShaderText& shader : shader_texts()) {
        const auto is = [&](std::string_view extension) { return shader.path.ends_with(extension); };
        if (!is(".comp") && !is(".vert") && !is(".geom") && !is(".frag")) continue;
        for (const auto& [name, source] : variants(shader.path)) glslang.add(name, source);
    }
    EXPECT_GT(glslang.count(), 50u);
    glslang.expect_success();
}

TEST(Shaders, EveryHeaderSharedWithCppCompilesAlone) {
    Glslang glslang;
    for (const ShaderText& header : shader_texts()) {
        if (!header.path.ends_with(".h")) continue;
        const std::string text =
            "#include \"" + std::string(header.path) + "\"\nlayout(local_size_x = 1) in;\nvoid main() {}\n";
        std::vector<ShaderText> texts = shader_texts();
        texts.push_back({"test.comp", text});
        const auto source = shader_source("test.comp", {}, texts);
        ASSERT_TRUE(source) << header.path << ": " << source.error().line();
        std::string name(header.path);
        std::replace(name.begin(), name.end(), '/', '-');
        glslang.add(name + ".comp", *source);
    }
    EXPECT_GT(glslang.count(), 15u);
    glslang.expect_success();
}

TEST(Shaders, NoneAsksForTheLengthOfARuntimeArray) {
    for (const ShaderText& shader : shader_texts())
        EXPECT_EQ(shader.text.find(".length()"), std::string_view::npos)
            << shader.path << ": drivers differ there, pass the size as a uniform";
}

}  // namespace
}  // namespace lucarne::gi
