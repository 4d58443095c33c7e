#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/core/error.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lucarne::viewer {

// CLI11 behind a small interface: its headers take ten seconds to compile, so only arguments.cpp includes
// them.

/// One declared argument; each function adds a rule or a text and returns the argument.
class Argument {
 public:
    explicit Argument(CLI::Option* option) : option_(option) {}

    Argument& required(bool is_required = true);
    Argument& type_name(const std::string& name);  ///< the placeholder in the help: FILE
    Argument& description(const std::string& text);
    Argument& show_default();                         ///< shows the variable's current value in the help
    Argument& show_default(const std::string& text);  ///< shows `text` as the default in the help
    /// Both ends are allowed. T: int, uint32_t, uint64_t, double.
    template <class T>
    Argument& range(T low, T high);
    Argument& positive();
    Argument& one_of(std::initializer_list<int> values);
    Argument& one_of(std::initializer_list<const char*> values);
    Argument& excludes(const Argument& other);
    Argument& values(int count);          ///< takes exactly so many
    Argument& separator(char character);  ///< between the values in one word
    Argument& repeatable();               ///< may be given several times, one value each

 private:
    CLI::Option* option_;
};

/// The arguments of one command.
class Arguments {
 public:
    explicit Arguments(CLI::App& app) : app_(&app) {}

    /// `names` are "-o,--output", or "inputs" for a positional argument. `value` outlives the parsing and
    /// keeps its value where the argument is absent. T: std::string, std::filesystem::path, an integer,
    /// double, an optional or a vector of these; arguments.cpp lists the types.
    template <class T>
    Argument add(const std::string& names, T& value, const std::string& help);
    Argument flag(const std::string& names, bool& value, const std::string& help);
    Argument flag(const std::string& names, std::function<void()> set, const std::string& help);
    /// `set` takes the text; its error, where it returns one, rejects the argument.
    Argument parsed(const std::string& names,
                    std::function<std::optional<std::string>(const std::string& text)> set,
                    const std::string& help);
    /// One of the named values of an enumeration. The help shows "a|b|c".
    template <class Enum>
    Argument choice(const std::string& names, Enum& value, std::vector<std::pair<std::string, Enum>> choices,
                    const std::string& help) {
        std::vector<std::string> words;
        for (const auto& [word, chosen] : choices) words.push_back(word);
        return add_choice(
            names, words, [&value, choices](size_t index) { value = choices[index].second; }, help);
    }
    Argument find(const std::string& name);          ///< one that was declared
    bool given(const std::string& name) const;       ///< on the parsed command line
    void footer(const std::string& text);            ///< below the help
    void run(std::function<Result<void>()> action);  ///< what the command does once its arguments are parsed

 private:
    friend class CommandLine;
    Argument add_choice(const std::string& names, const std::vector<std::string>& words,
                        std::function<void(size_t)> set, const std::string& help);

    CLI::App* app_;
    std::shared_ptr<std::function<Result<void>()>> action_ =
        std::make_shared<std::function<Result<void>()>>();
};

/// The program's command line: one command and its arguments.
class CommandLine {
 public:
    CommandLine(const std::string& program, const std::string& description);
    ~CommandLine();

    Arguments add(const std::string& name, const std::string& help);
    /// The action of the chosen command; empty where the help was asked for and printed. Errors
    /// (ErrorKind::arguments): the arguments are wrong.
    Result<std::function<Result<void>()>> parse(int argc, char** argv);

 private:
    std::unique_ptr<CLI::App> app_;
    std::vector<Arguments> commands_;
};

}  // namespace lucarne::viewer
