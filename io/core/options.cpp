#include "io/core/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lucarne {
namespace {

/// Returns how many letters have to be inserted, deleted, replaced, or exchanged with their neighbour to make
/// one word of another (the optimal string alignment distance).
size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
    for (size_t i = 0; i <= a.size(); ++i)
        for (size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                cost[i][j] = i + j;
                continue;
            }
            const size_t other = a[i - 1] != b[j - 1];
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + other});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    return cost[a.size()][b.size()];
}

}  // namespace

Result<uint64_t> parse_bytes(std::string_view option, std::string_view text) {
    double number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit = text.substr(static_cast<size_t>(end - text.data()));
    static constexpr std::string_view kPrefixes = "KMGT";
    double factor = 0;
    if (unit.empty() || unit == "B") {
        factor = 1;
    } else if (const auto at = kPrefixes.find(static_cast<char>(unit[0] & ~0x20));
               at != std::string_view::npos) {
        const auto rest = unit.substr(1);
        if (rest.empty() || rest == "B" || rest == "iB")
            factor = std::pow(1024.0, static_cast<double>(at + 1));
    }
    const double bytes = number * factor;
    if (code != std::errc{} || factor == 0 || !(bytes >= 0) || bytes > 9e15)
        return bad_arguments(std::string(option), fmt::format("'{}' is not an amount of memory", text),
                             "write for example 512M or 2G");
    return static_cast<uint64_t>(bytes);
}

Result<uint64_t> parse_count(std::string_view option, std::string_view text) {
    double number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit = text.substr(static_cast<size_t>(end - text.data()));
    double factor = 0;
    if (unit.empty()) factor = 1;
    if (unit.size() == 1)
        if (const auto at = std::string_view("KMG").find(static_cast<char>(unit[0] & ~0x20));
            at != std::string_view::npos)
            factor = std::pow(1000.0, static_cast<double>(at + 1));
    const double count = std::round(number * factor);
    if (code != std::errc{} || factor == 0 || !(count >= 0) || count > 0x1p53)
        return bad_arguments(std::string(option), fmt::format("'{}' is not a count", text),
                             "write for example 250000 or 5M");
    return static_cast<uint64_t>(count);
}

Result<ImageSize> parse_size(std::string_view option, std::string_view text) {
    ImageSize size;
    const char* last = text.data() + text.size();
    const auto first = std::from_chars(text.data(), last, size.width);
    if (first.ec == std::errc{} && first.ptr != last && *first.ptr == 'x') {
        const auto second = std::from_chars(first.ptr + 1, last, size.height);
        if (second.ec == std::errc{} && second.ptr == last && size.width >= 1 && size.height >= 1 &&
            size.width <= 16384 && size.height <= 16384)
            return size;
    }
    return bad_arguments(std::string(option), fmt::format("'{}' is not a picture size", text),
                         "write WIDTHxHEIGHT, for example 1280x720");
}

std::string bytes_text(uint64_t bytes) {
    static constexpr const char* kUnits[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    auto value = static_cast<double>(bytes);
    int unit = 0;
    while (value >= 1024 && unit < 4) value /= 1024, ++unit;
    return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string advice(std::string_view unknown, std::span<const std::string_view> names) {
    constexpr size_t kLongest = 64;  // what is longer resembles no name
    std::string_view nearest;
    size_t least = 3;
    for (const std::string_view name : names) {
        const size_t away = unknown.size() <= kLongest ? distance(unknown, name) : least;
        if (away < least && 3 * away <= name.size()) nearest = name, least = away;
    }
    const std::string all = fmt::format("{}", fmt::join(names, ", "));
    return nearest.empty() ? "choose one of: " + all
                           : fmt::format("did you mean {}? (all: {})", nearest, all);
}

}  // namespace lucarne
