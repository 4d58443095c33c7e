#include "gi/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lucarne::gi {
namespace {

/// Parses a number; fails unless the number is the whole text.
template <class T>
bool parse_all(std::string_view text, T& value) {
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    return problem == std::errc() && end == text.data() + text.size();
}

/// Parses a colour such as "0.2,0.4,1".
bool parse_colour(std::string_view text, glm::dvec3& colour) {
    for (int i = 0; i < 3; ++i) {
        const size_t comma = text.find(',');
        if ((comma == text.npos) != (i == 2) || !parse_all(text.substr(0, comma), colour[i])) return false;
        if (!(colour[i] >= 0 && colour[i] <= 1)) return false;
        if (i < 2) text.remove_prefix(comma + 1);
    }
    return true;
}

bool parse_flag(std::string_view text, bool& value) {
    value = text == "on" || text == "true";
    return value || text == "off" || text == "false";
}

}  // namespace

std::string OptionInfo::flag_name() const {
    const bool usually_on = kind == OptionKind::flag && std::get<bool>(defaults[size_t(Effort::interactive)]);
    std::string name = fmt::format("--{}{}", usually_on ? "no-" : "", key);
    std::ranges::replace(name, '_', '-');
    return name;
}

const OptionValue& EngineSettings::get(const OptionInfo& option) const {
    const auto found = values_.find(option.key);
    return found != values_.end() ? found->second : option.defaults[size_t(Effort::interactive)];
}

void EngineSettings::set(const OptionInfo& option, OptionValue value) {
    values_[option.key] = value;
}

void EngineSettings::override_with(const EngineSettings& over) {
    for (const auto& [key, value] : over.values_) values_[key] = value;
}

void EngineSettings::fill_from(const EngineSettings& under) {
    values_.insert(under.values_.begin(), under.values_.end());
}

const OptionInfo* find_option(std::string_view key) {
    const auto all = engine_options();
    const auto found = std::ranges::find(all, key, [](const OptionInfo* option) { return option->key; });
    return found != all.end() ? *found : nullptr;
}

EngineSettings default_settings(Effort effort) {
    EngineSettings settings;
    for (const OptionInfo* option : engine_options()) settings.set(*option, option->defaults[size_t(effort)]);
    return settings;
}

double number_of(const OptionValue& value) {
    if (const auto* whole = std::get_if<int64_t>(&value)) return static_cast<double>(*whole);
    const auto* number = std::get_if<double>(&value);
    return number ? *number : 0;
}

Result<OptionValue> parse_option(const OptionInfo& option, std::string_view text) {
    const auto wrong = [&] {
        return bad_arguments(option.flag_name(), fmt::format("'{}' is not {}", text, range_text(option)));
    };
    switch (option.kind) {
        case OptionKind::flag:
            if (bool value; parse_flag(text, value)) return value;
            return wrong();
        case OptionKind::integer: {
            int64_t value = 0;
            if (!parse_all(text, value)) return wrong();
            const bool allowed = option.values.empty()
                                     ? double(value) >= option.least && double(value) <= option.most
                                     : std::ranges::find(option.values, value) != option.values.end();
            if (!allowed) return wrong();
            return value;
        }
        case OptionKind::number: {
            double value = 0;
            if (!parse_all(text, value) || !(value >= option.least && value <= option.most)) return wrong();
            return value;
        }
        case OptionKind::choice: {
            const auto found = std::ranges::find(option.choices, text);
            if (found == option.choices.end()) return wrong();
            return int64_t{found - option.choices.begin()};
        }
        case OptionKind::colour: {
            glm::dvec3 colour(0.0);
            if (!parse_colour(text, colour)) return wrong();
            return colour;
        }
    }
    return wrong();
}

std::string range_text(const OptionInfo& option) {
    switch (option.kind) {
        case OptionKind::flag:
            return "on or off";
        case OptionKind::integer:
            if (!option.values.empty()) return fmt::format("{}", fmt::join(option.values, ", "));
            return fmt::format("{:.0f} to {:.0f}", option.least, option.most);
        case OptionKind::number:
            return fmt::format("{:g} to {:g}", option.least, option.most);
        case OptionKind::choice:
            return fmt::format("{}", fmt::join(option.choices, ", "));
        case OptionKind::colour:
            return "R,G,B of 0 to 1";
    }
    return {};
}

std::string option_text(const OptionInfo& option, const OptionValue& value) {
    switch (option.kind) {
        case OptionKind::flag:
            return std::get<bool>(value) ? "on" : "off";
        case OptionKind::integer:
            if (!option.unset.empty() && double(std::get<int64_t>(value)) < option.least)
                return std::string(option.unset);
            return fmt::format("{}", std::get<int64_t>(value));
        case OptionKind::number:
            return fmt::format("{:g}", std::get<double>(value));
        case OptionKind::choice:
            return std::string(option.choices[static_cast<size_t>(std::get<int64_t>(value))]);
        case OptionKind::colour: {
            const auto& c = std::get<glm::dvec3>(value);
            return fmt::format("{:g},{:g},{:g}", c.x, c.y, c.z);
        }
    }
    return {};
}

}  // namespace lucarne::gi
