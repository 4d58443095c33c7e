#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

// Text for terminals. Names of files and the strings in them are hostile: written raw, an escape sequence
// moves the cursor, changes the title or the clipboard.
namespace lucarne {

/// How many bytes the first character of `text` takes; 0 where it is not valid UTF-8 (RFC 3629) or must not
/// be shown: control characters, line ends, marks that turn the direction of text. `text` is not empty.
size_t shown_bytes(std::string_view text);

/// `text` as one line of valid UTF-8; each byte that must not be shown becomes '?'. Of a text of more than
/// `most` bytes the middle is left out.
std::string shown(std::string_view text, size_t most = std::string::npos);

/// Writes one line of results to stdout, as shown() has it. Only this, the log, the progress bar and main
/// write to a terminal.
void print_line(std::string_view text);

template <class... Args>
requires(sizeof...(Args) > 0) void print_line(fmt::format_string<Args...> text, Args&&... args) {
    print_line(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}

/// The same for every line of a text that ends with a line end.
void print_lines(std::string_view text);

}  // namespace lucarne
