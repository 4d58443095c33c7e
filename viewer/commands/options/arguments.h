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

// A small interface to CLI11. CLI11's headers take ten seconds to compile, so only arguments.cpp includes
// them.

/// One declared argument. Each function adds a rule or a text and returns the argument.
class Argument {
 public:
    explicit Argument(CLI::Option* option) : option_(option) {}

    Argument& required(bool is_required = true);
    Argument& type_name(const std::string& name);  ///< the placeholder in the help, for example FILE
    Argument& description(const std::string& text);
    Argument& show_default();                         ///< shows the variable's current value in the help
    Argument& show_default(const std::string& text);  ///< shows `text` as the default in the help
    /// Accepts values from `low` to `high`, both included. T: int, uint32_t, uint64_t, double.
    template <class T>
    Argument& range(T low, T high);
    Argument& positive();
    Argument& one_of(std::initializer_list<int> values);
    Argument& one_of(std::initializer_list<const char*> values);
    Argument& excludes(const Argument& other);
    Argument& values(int count);          ///< takes exactly `count` values
    Argument& separator(char character);  ///< separates the values within one word
    Argument& repeatable();               ///< may be given several times, with one value each

 private:
    CLI::Option* option_;
};

/// The arguments of one command.
class Arguments {
 public:
    explicit Arguments(CLI::App& app) : app_(&app) {}

    /// Declares an argument. `names` is "-o,--output", or "inputs" for a positional argument. `value` must
    /// outlive the parsing; it keeps its value when the argument is absent. T: std::string,
    /// std::filesystem::path, an integer, double, an optional or a vector of these; arguments.cpp lists the
    /// types.
    template <class T>
    Argument add(const std::string& names, T& value, const std::string& help);
    Argument flag(const std::string& names, bool& value, const std::string& help);
    Argument flag(const std::string& names, std::function<void()> set, const std::string& help);
    /// Declares an argument whose text is passed to `set`. If `set` returns an error, the argument is
    /// rejected with it.
    Argument parsed(const std::string& names,
                    std::function<std::optional<std::string>(const std::string& text)> set,
                    const std::string& help);
    /// Declares an argument that takes one of the named values of an enumeration. The help shows "a|b|c".
    template <class Enum>
    Argument choice(const std::string& names, Enum& value, std::vector<std::pair<std::string, Enum>> choices,
                    const std::string& help) {
        std::vector<std::string> words;
        for (const auto& [word, chosen] : choices) words.push_back(word);
        return add_choice(
            names, words, [&value, choices](size_t index) { value = choices[index].second; }, help);
    }
    Argument find(const std::string& name);     ///< returns an argument that was declared
    bool given(const std::string& name) const;  ///< whether the parsed command line has it
    /// Whether the parsed command line has no others than these.
    bool given_only(std::initializer_list<const char*> names) const;
    void footer(const std::string& text);            ///< text below the help
    void run(std::function<Result<void>()> action);  ///< sets what the command does after parsing

 private:
    friend class CommandLine;
    friend class ArgumentGroup;
    Argument add_choice(const std::string& names, const std::vector<std::string>& words,
                        std::function<void(size_t)> set, const std::string& help);

    CLI::App* app_;
    std::shared_ptr<std::function<Result<void>()>> action_ =
        std::make_shared<std::function<Result<void>()>>();
};

/// While it lives, the help lists arguments that are added under a title of their own, below the others.
class ArgumentGroup {
 public:
    ArgumentGroup(Arguments& command, const std::string& title);
    ~ArgumentGroup();
    ArgumentGroup(const ArgumentGroup&) = delete;
    ArgumentGroup& operator=(const ArgumentGroup&) = delete;

 private:
    CLI::App* app_;
    std::string before_;
};

/// The program's command line: a command and its arguments.
class CommandLine {
 public:
    CommandLine(const std::string& program, const std::string& description);
    ~CommandLine();

    Arguments add(const std::string& name, const std::string& help);
    /// The help lists the commands that are added from now on under this title.
    void begin_group(const std::string& title) { group_ = title; }
    /// Parses the command line and returns the action of the chosen command. A file, a folder or an option in
    /// the place of the command, or nothing at all, stands for `view`. The action is empty if help or the
    /// version was asked for; it has been printed then. Errors (ErrorKind::arguments): the arguments are
    /// wrong; the message suggests the command or option that was probably meant.
    Result<std::function<Result<void>()>> parse(int argc, char** argv);

 private:
    std::string see_help() const;

    std::unique_ptr<CLI::App> app_;
    std::vector<Arguments> commands_;
    std::string group_ = "Commands";
};

}  // namespace lucarne::viewer
