#include "viewer/commands/options/numbers.h"

#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace lucarne::viewer {

Result<std::vector<double>> parse_numbers(std::string_view option, std::string_view text, char between,
                                          size_t count) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (bool more = true; more;) {
        double number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc() || !std::isfinite(number)) break;
        numbers.push_back(number);
        more = next != end && *next == between;
        at = more ? next + 1 : next;
    }
    if (at == end && numbers.size() == count) return numbers;
    return bad_arguments(std::string(option),
                         fmt::format("'{}' is not {} numbers separated by '{}'", text, count, between));
}

}  // namespace lucarne::viewer
