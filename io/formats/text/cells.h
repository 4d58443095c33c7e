#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "io/formats/common/text.h"

// Cuts lines of text into cells.
namespace lucarne::io::text {

/// How the cells of a line are separated, and what their numbers look like.
struct Cut {
    char separator = ' ';  ///< ' ' means blanks; otherwise ',' ';' or a tab, with optional blanks around it
    bool decimal_comma = false;  ///< "12,5"; then no comma is a separator
};

/// Finds the separator of a line: the first of semicolons, commas and blanks that gives a row. The order
/// matters because quoted cells, or a text after the numbers, may hold any of them. Returns nothing if commas
/// may be either separators or decimal commas ("1,5, 2,5, 3,5").
std::optional<Cut> cut_of(std::string_view line);

/// Returns the place after a quoted text that begins at `at`. Returns `at` if there is none, or if it does
/// not end before `line_end` or `end`.
inline const char* behind_quotes(const char* at, const char* end, char line_end = '\n') {
    if (at == end || *at != '"') return at;
    for (const char* next = at + 1; next != end && *next != line_end; ++next) {
        if (*next != '"') continue;
        if (next + 1 == end || next[1] != '"') return next + 1;
        ++next;  // "" inside quotes stands for a quote
    }
    return at;
}

/// Returns the cell without the quotes around it.
inline std::string_view unquoted(std::string_view cell) {
    const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
    return quoted ? cell.substr(1, cell.size() - 2) : cell;
}

/// Returns whether a character is a blank beside a cell, and not what separates cells.
inline bool is_padding(char c, char separator) {
    return is_blank(c) && (c != separator || separator == ' ');
}

/// Splits a line into cells. A quoted cell may hold separators.
std::vector<std::string_view> split(std::string_view line, char separator);

/// Joins the words of a header that stand in brackets to the word before: "X (US", "ft)" becomes "X (US ft)".
/// The words must be parts of one text, in its order.
std::vector<std::string_view> with_brackets(const std::vector<std::string_view>& words);

/// Returns whether a cell says that there is no number: NULL, N/A, None, or the NaN of old Microsoft
/// compilers
/// (-1.#IND, 1.#QNAN, 1.#SNAN). Infinities (1.#INF) count as well.
bool says_no_number(std::string_view cell);

/// Returns a cell as a number, NaN if it says that there is none. The decimal separator must be a point.
inline std::optional<double> cell_number(std::string_view cell) {
    const auto value = parse_number<double>(unquoted(cell));
    if (value || !says_no_number(unquoted(cell))) return value;
    return std::numeric_limits<double>::quiet_NaN();
}

/// Returns whether cells may be a point: at least three are a number or empty, and not all of them are empty.
bool is_row(const std::vector<std::string_view>& cells);

}  // namespace lucarne::io::text
