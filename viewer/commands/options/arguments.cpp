#include "viewer/commands/options/arguments.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lucarne::viewer {
namespace {

/// Returns how many letters have to be inserted, deleted or replaced to turn one word into the other
/// (Levenshtein 1966).
size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); ++i) {
        size_t above_left = std::exchange(row[0], i + 1);
        for (size_t j = 0; j < b.size(); ++j) {
            const size_t replaced = above_left + (a[i] != b[j]);
            above_left = row[j + 1];
            row[j + 1] = std::min({replaced, above_left + 1, row[j] + 1});
        }
    }
    return row.back();
}

/// Returns a remedy that names the word most like a mistyped one, or `otherwise` if none is like it.
std::string did_you_mean(std::string_view word, std::span<const std::string> known,
                         const std::string& otherwise) {
    const size_t most = std::max<size_t>(1, word.size() / 3);
    const auto best = std::ranges::min_element(
        known, {}, [&](const std::string& name) { return edit_distance(word, name); });
    if (best == known.end() || edit_distance(word, *best) > most) return otherwise;
    return fmt::format("did you mean {}?", *best);
}

/// Returns the long names of a command's options, with their hyphens.
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// Returns whether a parsed command needs scans and has none.
bool lacks_input(const CLI::App& command) {
    return std::ranges::any_of(command.get_options(), [](const CLI::Option* option) {
        const std::string name = option->get_name(true);
        return (name == "INPUT" || name == "inputs") && option->get_required() && option->count() == 0;
    });
}

}  // namespace

Argument& Argument::required(bool is_required) {
    option_->required(is_required);
    return *this;
}

Argument& Argument::type_name(const std::string& name) {
    option_->type_name(name);
    return *this;
}

Argument& Argument::description(const std::string& text) {
    option_->description(text);
    return *this;
}

Argument& Argument::show_default() {
    option_->capture_default_str();
    return *this;
}

Argument& Argument::show_default(const std::string& text) {
    option_->default_str(text);
    return *this;
}

template <class T>
Argument& Argument::range(T low, T high) {
    option_->check(CLI::Range(low, high));
    return *this;
}
template Argument& Argument::range(int, int);
template Argument& Argument::range(uint32_t, uint32_t);
template Argument& Argument::range(uint64_t, uint64_t);
template Argument& Argument::range(double, double);

Argument& Argument::positive() {
    option_->check(CLI::PositiveNumber);
    return *this;
}

Argument& Argument::one_of(std::initializer_list<int> values) {
    option_->check(CLI::IsMember(std::vector<int>(values)));
    return *this;
}

Argument& Argument::one_of(std::initializer_list<const char*> values) {
    option_->check(CLI::IsMember(std::vector<std::string>(values.begin(), values.end())));
    return *this;
}

Argument& Argument::excludes(const Argument& other) {
    option_->excludes(other.option_);
    return *this;
}

Argument& Argument::values(int count) {
    option_->expected(count);
    return *this;
}

Argument& Argument::separator(char character) {
    option_->delimiter(character);
    return *this;
}

Argument& Argument::repeatable() {
    option_->take_all()->allow_extra_args(false);
    return *this;
}

template <class T>
Argument Arguments::add(const std::string& names, T& value, const std::string& help) {
    return Argument(app_->add_option(names, value, help));
}
template Argument Arguments::add(const std::string&, std::string&, const std::string&);
template Argument Arguments::add(const std::string&, std::filesystem::path&, const std::string&);
template Argument Arguments::add(const std::string&, uint32_t&, const std::string&);
template Argument Arguments::add(const std::string&, uint64_t&, const std::string&);
template Argument Arguments::add(const std::string&, double&, const std::string&);
template Argument Arguments::add(const std::string&, std::optional<int>&, const std::string&);
template Argument Arguments::add(const std::string&, std::optional<uint32_t>&, const std::string&);
template Argument Arguments::add(const std::string&, std::optional<uint64_t>&, const std::string&);
template Argument Arguments::add(const std::string&, std::optional<double>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<std::vector<double>>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<uint32_t>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<int>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<double>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<std::string>&, const std::string&);
template Argument Arguments::add(const std::string&, std::vector<std::filesystem::path>&, const std::string&);

Argument Arguments::flag(const std::string& names, bool& value, const std::string& help) {
    return Argument(app_->add_flag(names, value, help));
}

Argument Arguments::flag(const std::string& names, std::function<void()> set, const std::string& help) {
    return Argument(app_->add_flag_callback(names, std::move(set), help));
}

Argument Arguments::parsed(const std::string& names,
                           std::function<std::optional<std::string>(const std::string& text)> set,
                           const std::string& help) {
    const auto take = [names, set = std::move(set)](const std::string& text) {
        if (auto problem = set(text)) throw CLI::ValidationError(names, *problem);
    };
    return Argument(app_->add_option_function<std::string>(names, take, help));
}

Argument Arguments::add_choice(const std::string& names, const std::vector<std::string>& words,
                               std::function<void(size_t)> set, const std::string& help) {
    const auto take = [words, set = std::move(set)](const std::string& text) {
        set(static_cast<size_t>(std::ranges::find(words, text) - words.begin()));
    };
    auto* option = app_->add_option_function<std::string>(names, take, help);
    // The check's own description would repeat the words that are shown as the type.
    option->check(CLI::IsMember(words).description(""));
    option->type_name(fmt::format("{}", fmt::join(words, "|")));
    return Argument(option);
}

Argument Arguments::find(const std::string& name) {
    return Argument(app_->get_option(name));
}

bool Arguments::given(const std::string& name) const {
    return app_->count(name) > 0;
}

bool Arguments::given_only(std::initializer_list<const char*> names) const {
    return std::ranges::all_of(app_->get_options(), [&](const CLI::Option* option) {
        return option->count() == 0 ||
               std::ranges::any_of(names, [&](const char* name) { return option->check_name(name); });
    });
}

void Arguments::footer(const std::string& text) {
    app_->footer(text);
}

void Arguments::run(std::function<Result<void>()> action) {
    *action_ = std::move(action);
}

ArgumentGroup::ArgumentGroup(Arguments& command, const std::string& title)
    : app_(command.app_), before_(app_->option_defaults()->get_group()) {
    app_->option_defaults()->group(title);
}

ArgumentGroup::~ArgumentGroup() {
    app_->option_defaults()->group(before_);
}

CommandLine::CommandLine(const std::string& program, const std::string& description)
    : app_(std::make_unique<CLI::App>(description)) {
    app_->name(program);
    app_->require_subcommand(1);
    app_->set_version_flag("--version", fmt::format("{} {}", program, LUCARNE_VERSION),
                           "Print the version and exit");
}

CommandLine::~CommandLine() = default;

Arguments CommandLine::add(const std::string& name, const std::string& help) {
    return commands_.emplace_back(*app_->add_subcommand(name, help)->group(group_));
}

/// Returns where the help of the parsed command, or of the program, is.
std::string CommandLine::see_help() const {
    for (const Arguments& command : commands_)
        if (*command.app_) return fmt::format("see lucarne {} --help", command.app_->get_name());
    return "see lucarne --help";
}

Result<std::function<Result<void>()>> CommandLine::parse(int argc, char** argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    std::vector<std::string> names;
    for (const Arguments& command : commands_) names.push_back(command.app_->get_name());
    const bool a_word = !words.empty() && !words[0].starts_with('-');
    const bool about =
        !words.empty() && (words[0] == "-h" || words[0] == "--help" || words[0] == "--version");
    if (!a_word && !about) words.insert(words.begin(), "view");
    if (a_word && std::ranges::find(names, words[0]) == names.end()) {
        std::error_code unreadable;
        if (std::filesystem::exists(words[0], unreadable)) {
            words.insert(words.begin(), "view");
        } else {
            return bad_arguments("arguments", fmt::format("'{}' is neither a command nor a file", words[0]),
                                 did_you_mean(words[0], names, "see lucarne --help"));
        }
    }
    std::ranges::reverse(words);  // as CLI11 takes them
    try {
        app_->parse(words);
    } catch (const CLI::ExtrasError& error) {
        std::string remedy = see_help();
        for (const Arguments& command : commands_) {
            if (!*command.app_) continue;
            const auto extras = command.app_->remaining();
            if (!extras.empty()) remedy = did_you_mean(extras[0], option_names(*command.app_), remedy);
        }
        return bad_arguments("arguments", error.what(), remedy);
    } catch (const CLI::RequiredError& error) {
        const bool input = std::ranges::any_of(
            commands_, [](const Arguments& command) { return *command.app_ && lacks_input(*command.app_); });
        return bad_arguments("", input ? "no input given" : error.what(), see_help());
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) return bad_arguments("arguments", error.what(), "see lucarne --help");
        app_->exit(error);  // prints the help
        return std::function<Result<void>()>();
    }
    for (const Arguments& command : commands_)
        if (*command.app_) return *command.action_;
    return std::function<Result<void>()>();
}

}  // namespace lucarne::viewer
