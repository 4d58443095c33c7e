#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include <glm/vec3.hpp>

#include "io/core/error.h"

// Options of engines. An engine declares each of its options once, in its own folder. The command line,
// scene files, presets, the window, reports and documents follow from these declarations.
namespace lucarne::gi {

/// How much time a picture may take: the presets of the viewer, cheapest first.
enum class Effort : uint8_t { preview, interactive, high };
inline constexpr size_t kEfforts = 3;

/// The value of an option: a switch, a whole number (or the index of a choice), a number, or a colour
/// (linear RGB).
using OptionValue = std::variant<bool, int64_t, double, glm::dvec3>;

enum class OptionKind : uint8_t { flag, integer, number, choice, colour };

/// Range of the window's slider for a number.
struct SliderRange {
    double least = 0, most = 0;
    bool logarithmic = false;  ///< for whole numbers: powers of two
};

/// Describes an option to everything that uses it. Texts and lists are constants with static lifetime.
struct OptionInfo {
    OptionKind kind = OptionKind::flag;
    std::string_view key;                  ///< in scene files and reports; the command line writes - for _
    std::string_view label;                ///< in the window
    std::string_view help;                 ///< one line
    std::string_view cost;                 ///< what larger values cost: the tooltip in the window
    std::string_view placeholder = "N";    ///< in the help of the command line
    double least = 0, most = 0;            ///< of numbers
    std::span<const int64_t> values = {};  ///< if not empty, the only values of a whole number
    std::span<const std::string_view> choices = {};  ///< the names of a choice's values
    /// If not empty, a whole number can also be unset, and this is its text. Its value is then `least` - 1,
    /// which no file or option can give.
    std::string_view unset = {};
    SliderRange slider = {};                          ///< both ends 0: no slider in the window
    std::array<OptionValue, kEfforts> defaults = {};  ///< by preset
    /// A preset does not change it, because it selects what is shown, not how much time it takes.
    bool keeps = false;
    /// The direction that makes a picture cheaper: -1 smaller, 1 larger, 0 neither.
    int cheaper = 0;

    /// Returns "--light-resolution"; for switches that are on by default "--no-reuse".
    std::string flag_name() const;
    /// Returns whether the window has a control for it: it needs a label, and numbers need a slider range.
    bool in_window() const {
        const bool slides = kind == OptionKind::integer || kind == OptionKind::number;
        return !label.empty() && (!slides || slider.least != slider.most);
    }
};

/// An option with values of type T: bool, an integer type, double, glm::dvec3, or an enumeration for a
/// choice.
template <class T>
struct Option {
    OptionInfo info;
    using Value = T;
};

/// Values of options by key. An option without a value has its default of the preset `interactive`.
class EngineSettings {
 public:
    template <class T>
    T operator[](const Option<T>& option) const {
        const OptionValue& value = get(option.info);
        if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, double> || std::is_same_v<T, glm::dvec3>)
            return std::get<T>(value);
        else
            return static_cast<T>(std::get<int64_t>(value));
    }
    template <class T>
    void set(const Option<T>& option, std::type_identity_t<T> value) {
        if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, double> || std::is_same_v<T, glm::dvec3>)
            set(option.info, OptionValue(value));
        else
            set(option.info, OptionValue(static_cast<int64_t>(value)));
    }
    const OptionValue& get(const OptionInfo& option) const;
    void set(const OptionInfo& option, OptionValue value);
    bool has(const OptionInfo& option) const { return values_.contains(option.key); }
    bool empty() const { return values_.empty(); }
    /// Copies every value of `over`, replacing values set here.
    void override_with(const EngineSettings& over);
    /// Copies those values of `under` that are not set here.
    void fill_from(const EngineSettings& under);

    bool operator==(const EngineSettings&) const = default;

 private:
    std::map<std::string_view, OptionValue> values_;  ///< the keys point into constant OptionInfos
};

/// Returns the options of all engines, each once.
std::span<const OptionInfo* const> engine_options();
/// Returns the option with this key; null if no engine has it.
const OptionInfo* find_option(std::string_view key);

/// Returns the defaults of a preset for the options of all engines.
EngineSettings default_settings(Effort effort);

/// Returns the value as a double; 0 for values that are not numbers.
double number_of(const OptionValue& value);

/// Parses a value as the command line gives it: "4", "1.5", "name", "0.2,0.4,1". Errors
/// (ErrorKind::arguments): not a value of this option, or out of range; the message lists what is allowed.
Result<OptionValue> parse_option(const OptionInfo& option, std::string_view text);
/// Returns the allowed values for people: "1 to 64", "1, 2, 4", "flat, occlusion", "on or off", "R,G,B of 0
/// to 1".
std::string range_text(const OptionInfo& option);
/// Returns a value as text that parse_option() accepts; an unset number as OptionInfo::unset.
std::string option_text(const OptionInfo& option, const OptionValue& value);

}  // namespace lucarne::gi
