#pragma once

#include <bit>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "io/formats/common/number.h"

// Words and numbers of text formats, independent of the locale.
namespace lucarne::io {

constexpr bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Returns the text after the byte order mark that some editors put before UTF-8.
constexpr std::string_view without_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    return text;
}

/// Removes the next word from the front of `line` and returns it; empty if there is none.
inline std::string_view next_word(std::string_view& line) {
    size_t first = 0;
    while (first < line.size() && is_blank(line[first])) ++first;
    size_t last = first;
    while (last < line.size() && !is_blank(line[last])) ++last;
    const auto word = line.substr(first, last - first);
    line.remove_prefix(last);
    return word;
}

/// Returns the text without the blanks around it.
constexpr std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Returns a name without blanks and quotes around it: some programs quote file names that hold blanks.
constexpr std::string_view without_quotes(std::string_view name) {
    name = trimmed(name);
    const bool quoted =
        name.size() >= 2 && name.front() == name.back() && (name.front() == '"' || name.front() == '\'');
    return quoted ? trimmed(name.substr(1, name.size() - 2)) : name;
}

/// Converts ASCII letters to lower case.
inline std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

/// Returns whether two words are equal apart from the case of ASCII letters.
constexpr bool same_letters(std::string_view a, std::string_view b) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i)
        if (small(a[i]) != small(b[i])) return false;
    return true;
}

/// Returns the index of the entry called `name`. If there is none, returns the first whose name differs only
/// in case, otherwise the size of the list.
template <class List, class NameOf>
size_t index_of_name(const List& list, std::string_view name, NameOf name_of) {
    size_t alike = list.size();
    for (size_t i = 0; i < list.size(); ++i) {
        const std::string_view theirs = std::invoke(name_of, list[i]);
        if (theirs == name) return i;
        if (alike == list.size() && same_letters(theirs, name)) alike = i;
    }
    return alike;
}

/// Returns whether `value`, the double nearest to some decimal, surely rounds to the float nearest to that
/// decimal. Returns false if `value` lies halfway between two floats, because the decimal may lie on either
/// side, and for values below the normal floats, whose midpoints are elsewhere.
inline bool rounds_to_float(double value) {
    constexpr uint64_t kHalfway = uint64_t{1} << 28, kBelowFloat = (uint64_t{1} << 29) - 1;
    if (std::abs(value) < std::numeric_limits<float>::min()) return value == 0;
    return (std::bit_cast<uint64_t>(value) & kBelowFloat) != kHalfway;
}

/// Parses the whole word as a number. An integer must have no fraction and be in range. "nan" and "inf" are
/// numbers. A value too large for a float becomes infinite, one too small becomes zero.
template <class T>
std::optional<T> parse_number(std::string_view word) {
    if constexpr (std::is_floating_point_v<T>) {
        const char* last = word.data() + word.size();
        double plain = 0;
        if (text::plain_number(word.data(), plain, last) == last && !word.empty() &&
            (sizeof(T) == sizeof plain || rounds_to_float(plain)))
            return static_cast<T>(plain);
    }
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    const char* end = word.data() + word.size();
    T value{};
    const auto [stop, code] = std::from_chars(word.data(), end, value);
    if (stop != end) return std::nullopt;
    if (code == std::errc{}) return value;
    if constexpr (std::is_floating_point_v<T>) {
        if (code != std::errc::result_out_of_range) return std::nullopt;
        const size_t exponent = word.find_first_of("eE");
        const bool tiny = exponent != word.npos ? word.substr(exponent + 1).starts_with('-')
                                                : word.find_first_of("123456789") > word.find('.');
        const T size = tiny ? T{0} : std::numeric_limits<T>::infinity();
        return word[0] == '-' ? -size : size;
    } else {
        return std::nullopt;
    }
}

}  // namespace lucarne::io
