#pragma once

#include <span>

#include "io/formats/text/rows.h"
#include "io/points.h"

// Rows from all over a file without the rows before them: PointSource::parts and front() of formats in text.
namespace lucarne::io::text {

/// Returns into how many parts of 64 KiB or more the sections are divided: at most 65536 each.
size_t row_parts(std::span<const Section> sections);

/// Replaces `batch` by the first points of a part, at most `most`, of its first 256 KiB. The rows of a part
/// are those that begin in it. Rows that do not fit are left out, as a whole pass reports them, and so are
/// those after one of more than 16 KiB. Thread-safe. Errors: unreadable.
Result<void> read_row_front(const ByteSource& file, std::span<const Section> sections, size_t part,
                            size_t most, PointBatch& batch);

}  // namespace lucarne::io::text
