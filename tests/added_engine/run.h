#pragma once

#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "io/image/image.h"
#include "viewer/commands/commands.h"

namespace lucarne::test {

/// Runs a command in this program, which contains the added engines.
inline Result<void> run(const std::vector<std::string>& arguments) {
    viewer::CommandLine line("lucarne", "");
    viewer::add_commands(line);
    std::vector<std::string> words = {"lucarne"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    LUCARNE_ASSIGN(const auto action, line.parse(static_cast<int>(pointers.size()), pointers.data()));
    return action ? action() : Result<void>{};
}

/// Renders `input` with an engine into `picture` (.exr), with more options of `render`. Returns the maximum
/// of each channel.
inline glm::vec3 brightest(const std::string& input, const std::string& picture, const std::string& engine,
                           const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", input,   "-o",       picture, "--overwrite",
                                      "--size", "64x48", "--engine", engine};
    words.insert(words.end(), more.begin(), more.end());
    const auto done = run(words);
    EXPECT_TRUE(done) << done.error().line();
    const auto read = io::read_exr(picture);
    EXPECT_TRUE(read);
    glm::vec3 most(0.0f);
    for (const glm::vec4& pixel : read->pixels) most = glm::max(most, glm::vec3(pixel));
    return most;
}

}  // namespace lucarne::test
