#include "io/core/terminal.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

namespace lucarne {

size_t shown_bytes(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    if (first < 0x80) return first >= 0x20 && first != 0x7f;
    if (first < 0xc2 || first > 0xf4) return 0;
    const size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (text.size() < bytes) return 0;
    uint32_t code = first & (0x7fu >> bytes);
    for (const char c : text.substr(1, bytes - 1)) {
        if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) return 0;
        code = code << 6 | (static_cast<unsigned char>(c) & 0x3f);
    }
    constexpr std::array<uint32_t, 5> kLeast = {0, 0, 0xa0, 0x800,
                                                0x10000};  // by number of bytes; C1 ends at 0xa0
    const bool no_character = code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000);
    const bool not_seen = (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
    return no_character || not_seen ? 0 : bytes;
}

std::string shown(std::string_view text, size_t most) {
    constexpr std::string_view kGap = " ... ";
    std::string line;
    line.reserve(std::min(text.size(), most));
    while (!text.empty()) {
        const size_t bytes = shown_bytes(text);
        line += bytes ? text.substr(0, bytes) : "?";
        text.remove_prefix(std::max<size_t>(bytes, 1));
    }
    if (line.size() <= most) return line;
    const auto inside = [&](size_t at) { return (static_cast<unsigned char>(line[at]) & 0xc0) == 0x80; };
    size_t head = (most - kGap.size()) / 2, tail = line.size() - head;
    while (inside(head)) --head;
    while (tail < line.size() && inside(tail)) ++tail;
    return line.substr(0, head).append(kGap).append(line, tail);
}

void print_line(std::string_view text) {
    // If stdout cannot be written, main reports it at the end.
    const std::string line = shown(text) + '\n';
    std::fwrite(line.data(), 1, line.size(), stdout);
}

void print_lines(std::string_view text) {
    for (size_t end; (end = text.find('\n')) != text.npos; text.remove_prefix(end + 1))
        print_line(text.substr(0, end));
}

}  // namespace lucarne
