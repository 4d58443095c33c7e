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

// What engines let the user set. An engine declares each of its options once, in its own folder; the command
// line, scene files, presets, the window, reports and the documents are made from that.
namespace lucarne::gi {

/// How much is spent on a picture: the presets of the viewer, cheapest first.
enum class Effort : uint8_t { preview, interactive, high };
inline constexpr size_t kEfforts = 3;

/// A switch, a whole number (or the index of a choice), a number, a colour (linear RGB).
using OptionValue = std::variant<bool, int64_t, double, glm::dvec3>;

enum class OptionKind : uint8_t { flag, integer, number, choice, colour };

/// What the window's slider shows of a number.
struct SliderRange {
    double least = 0, most = 0;
    bool logarithmic = false;  ///< of whole numbers: the powers of two
};

/// An option as all its users see it. Texts and lists are constants that outlive everything.
struct OptionInfo {
    OptionKind kind = OptionKind::flag;
    std::string_view key;                  ///< in scene files and reports; on the command line with - for _
    std::string_view label;                ///< in the window
    std::string_view help;                 ///< one line
    std::string_view cost;                 ///< what more of it costs: the tooltip in the window
    std::string_view placeholder = "N";    ///< in the help of the command line
    double least = 0, most = 0;            ///< of numbers
    std::span<const int64_t> values = {};  ///< where there are any, a whole number is one of these
    std::span<const std::string_view> choices = {};  ///< names of the values of a choice
    /// Where it is not empty, a whole number can be unset: it then is `least` - 1, which no file or option
    /// can say.
    std::string_view unset = {};
    SliderRange slider = {};                          ///< both ends 0: not in the window
    std::array<OptionValue, kEfforts> defaults = {};  ///< by preset
    /// Choosing a preset leaves it alone: it says what is seen, not how much is spent.
    bool keeps = false;
    /// The direction that makes a picture cheaper: -1 smaller, 1 larger, 0 neither.
    int cheaper = 0;

    /// "--light-resolution"; of switches that are usually on "--no-reuse".
    std::string flag_name() const;
    /// Whether the window has a control for it: where it has a label, and a slider's range where it takes
    /// one.
    bool in_window() const {
        const bool slides = kind == OptionKind::integer || kind == OptionKind::number;
        return !label.empty() && (!slides || slider.least != slider.most);
    }
};

/// An option whose values are read as T: bool, an integer type, double, glm::dvec3, or an enumeration for a
/// choice.
template <class T>
struct Option {
    OptionInfo info;
    using Value = T;
};

/// Values of options by key. What is not there has its default of the preset `interactive`.
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
    /// Takes every value that `over` has.
    void override_with(const EngineSettings& over);
    /// Takes every value that `under` has and this has not.
    void fill_from(const EngineSettings& under);

    bool operator==(const EngineSettings&) const = default;

 private:
    std::map<std::string_view, OptionValue> values_;  ///< keys are those of the constant OptionInfos
};

/// The options of all engines, each once; defined with the list of engines.
std::span<const OptionInfo* const> engine_options();
/// None: no engine has it.
const OptionInfo* find_option(std::string_view key);

/// The defaults of a preset, of all engines.
EngineSettings default_settings(Effort effort);

/// A whole number or a number; 0 of other values.
double number_of(const OptionValue& value);

/// A value as the command line gives it: "4", "1.5", "name", "0.2,0.4,1". Errors (ErrorKind::arguments): it
/// is none, or out of range; the message lists what is allowed.
Result<OptionValue> parse_option(const OptionInfo& option, std::string_view text);
/// "1 to 64", "1, 2, 4", "flat, occlusion", "on or off", "R,G,B of 0 to 1".
std::string range_text(const OptionInfo& option);
/// A value for people, as parse_option takes it.
std::string option_text(const OptionInfo& option, const OptionValue& value);

}  // namespace lucarne::gi
