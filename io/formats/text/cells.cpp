#include "io/formats/text/cells.h"

#include <algorithm>
#include <array>
#include <string>

namespace lucarne::io::text {
namespace {

std::string with_points(std::string_view text) {
    std::string points(text);
    std::ranges::replace(points, ',', '.');
    return points;
}

/// Returns whether every word, apart from a comma at its end, has a decimal comma: "1,5, 2,5, 3,5".
bool may_be_decimal(std::string_view line) {
    auto words = split(line, ' ');
    return words.size() >= 3 && std::ranges::all_of(words, [](std::string_view word) {
               if (word.ends_with(',')) word.remove_suffix(1);
               return std::ranges::count(word, ',') == 1 && !word.starts_with(',') && !word.ends_with(',') &&
                      word.find('.') == word.npos && cell_number(with_points(word));
           });
}

}  // namespace

std::vector<std::string_view> split(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    const auto skip_blanks = [&] {
        while (!line.empty() && is_padding(line.front(), separator)) line.remove_prefix(1);
    };
    for (bool more = true; more;) {
        skip_blanks();
        const char* end = line.data() + line.size();
        const auto quoted = static_cast<size_t>(behind_quotes(line.data(), end) - line.data());
        const size_t length =
            separator == ' '
                ? static_cast<size_t>(
                      std::find_if(line.begin() + static_cast<std::ptrdiff_t>(quoted), line.end(), is_blank) -
                      line.begin())
                : std::min(line.find(separator, quoted), line.size());
        more = length < line.size();
        auto cell = line.substr(0, length);
        line.remove_prefix(more ? length + 1 : length);
        while (!cell.empty() && is_blank(cell.back())) cell.remove_suffix(1);
        if ((more && separator != ' ') || !cell.empty())
            cells.push_back(cell);  // a separator after the last cell means nothing
    }
    return cells;
}

std::vector<std::string_view> with_brackets(const std::vector<std::string_view>& words) {
    std::vector<std::string_view> joined;
    bool open = false;
    for (const std::string_view word : words) {
        const bool begins = word.starts_with('(') || word.starts_with('[');
        if (!joined.empty() && (begins || open)) {
            const char* first = joined.back().data();
            joined.back() = {first, static_cast<size_t>(word.data() + word.size() - first)};
        } else {
            joined.push_back(word);
        }
        const size_t last = joined.back().find_last_of("([])");
        open = last != std::string_view::npos && (joined.back()[last] == '(' || joined.back()[last] == '[');
    }
    return joined;
}

bool says_no_number(std::string_view cell) {
    constexpr std::array<std::string_view, 4> kWords = {"null", "n/a", "na", "none"};
    if (cell.size() < 2 || cell.size() > 12) return false;
    if (cell.front() == '-' || cell.front() == '+') cell.remove_prefix(1);
    const std::string word = lower(cell);
    return word.starts_with("1.#ind") || word.starts_with("1.#qnan") || word.starts_with("1.#snan") ||
           word.starts_with("1.#inf") || std::ranges::find(kWords, word) != kWords.end();
}

bool is_row(const std::vector<std::string_view>& cells) {
    const auto numbers =
        std::ranges::count_if(cells, [](auto cell) { return cell_number(cell).has_value(); });
    return numbers > 0 && numbers + std::ranges::count(cells, std::string_view()) >= 3;
}

std::optional<Cut> cut_of(std::string_view line) {
    const bool commas = line.find(',') != line.npos, semicolons = line.find(';') != line.npos;
    const Cut usual{semicolons ? ';' : commas ? ',' : ' ', semicolons && commas};
    if (semicolons && is_row(split(with_points(line), ';'))) return usual;
    if (commas && is_row(split(line, ','))) {
        if (may_be_decimal(line)) return std::nullopt;
        return Cut{','};
    }
    if (is_row(split(with_points(line), ' '))) return Cut{' ', commas};
    return usual;
}

}  // namespace lucarne::io::text
