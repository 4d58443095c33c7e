#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "io/formats/common/text.h"

// Cuts lines of text into cells.
namespace lucarne::io::text {

/// How the cells of a line are separated, and what their numbers look like.
struct Cut {
    char separator = ' ';        ///< ' ' means blanks; otherwise ',' or ';' with optional blanks
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

/// Splits a line into cells. A quoted cell may hold separators.
std::vector<std::string_view> split(std::string_view line, char separator);

/// Returns a cell as a number. The decimal separator must be a point.
inline std::optional<double> cell_number(std::string_view cell) {
    return parse_number<double>(unquoted(cell));
}

/// Returns whether cells may be a point: at least three are a number or empty, and not all of them are empty.
bool is_row(const std::vector<std::string_view>& cells);

}  // namespace lucarne::io::text
