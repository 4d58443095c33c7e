#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

// Text for terminals. File names and the strings in files are hostile: written raw, an escape sequence can
// move the cursor and change the title or the clipboard.
namespace lucarne {

/// Returns how many bytes the first character of `text` takes. Returns 0 if it is not valid UTF-8 (RFC 3629)
/// or must not be shown: control characters, line ends, marks that change the direction of text. `text` must
/// not be empty.
size_t shown_bytes(std::string_view text);

/// Returns `text` as one line of valid UTF-8. Each byte that must not be shown becomes '?'. If the text is
/// longer than `most` bytes, its middle is left out.
std::string shown(std::string_view text, size_t most = std::string::npos);

/// Writes one line of results to stdout, cleaned by shown(). Only this function, the log, the progress bar
/// and main write to a terminal.
void print_line(std::string_view text);

template <class... Args>
requires(sizeof...(Args) > 0) void print_line(fmt::format_string<Args...> text, Args&&... args) {
    print_line(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}

/// Writes every line of `text` in the same way. The text must end with a line end.
void print_lines(std::string_view text);

}  // namespace lucarne
