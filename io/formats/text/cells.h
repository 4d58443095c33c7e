#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "io/formats/common/text.h"

// Lines of text cut into cells.
namespace lucarne::io::text {

/// How the cells of a line stand apart, and what their numbers look like.
struct Cut {
    char separator = ' ';        ///< ' ' means blanks; else ',' or ';', with blanks as one likes
    bool decimal_comma = false;  ///< "12,5", where no comma is a separator
};

/// Semicolons go before commas, commas before blanks, the first between which a row stands: what is quoted,
/// or a text behind the numbers, may hold any of them. Nothing where commas may be either ("1,5, 2,5, 3,5").
std::optional<Cut> cut_of(std::string_view line);

/// Where the quotes that may begin at `at` end, behind them; `at` where they do not, before `line_end` or
/// `end`.
inline const char* behind_quotes(const char* at, const char* end, char line_end = '\n') {
    if (at == end || *at != '"') return at;
    for (const char* next = at + 1; next != end && *next != line_end; ++next) {
        if (*next != '"') continue;
        if (next + 1 == end || next[1] != '"') return next + 1;
        ++next;  // "" within them is a quote
    }
    return at;
}

/// Without the quotes around it.
inline std::string_view unquoted(std::string_view cell) {
    const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
    return quoted ? cell.substr(1, cell.size() - 2) : cell;
}

/// The cells of a line; one that is quoted may hold separators.
std::vector<std::string_view> split(std::string_view line, char separator);

/// A cell as a number; the decimal point is a point.
inline std::optional<double> cell_number(std::string_view cell) {
    return parse_number<double>(unquoted(cell));
}

/// Whether cells may be a point: three that are a number or empty, and not all empty.
bool is_row(const std::vector<std::string_view>& cells);

}  // namespace lucarne::io::text
