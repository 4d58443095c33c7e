#pragma once

#include "io/formats/text/columns.h"

namespace lucarne::io::text {

struct Sampled {
    Sample sample;
    uint64_t rows = 0;  ///< in the file: counted up to 4 MiB, otherwise estimated
};

/// Samples the rows of [begin, end) at 64 places of 64 KiB, or all of it if that is no more. `columns` is the
/// number of values in a row; other lines are left out.
Result<Sampled> take_sample(const ByteSource& file, uint64_t begin, uint64_t end, const RowLayout& layout,
                            size_t columns);

/// Returns the line end: '\r' in files of old Macintoshes.
inline char line_end_of(std::string_view head) {
    return head.find('\n') == head.npos && head.find('\r') != head.npos ? '\r' : '\n';
}

/// Returns whether a line, without leading blanks, is a comment.
inline bool is_comment(std::string_view line) {
    return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

}  // namespace lucarne::io::text
