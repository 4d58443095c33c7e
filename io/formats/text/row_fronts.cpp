#include "io/formats/text/row_fronts.h"

#include <algorithm>

namespace lucarne::io::text {
namespace {

constexpr uint64_t kPartBytes = uint64_t{64} << 10, kMostParts = 65536;
constexpr uint64_t kFrontBytes = uint64_t{256} << 10;
constexpr uint64_t kLongRow = uint64_t{16} << 10;

size_t parts_of(const Section& section) {
    return static_cast<size_t>(
        std::clamp<uint64_t>((section.end - section.begin) / kPartBytes, 1, kMostParts));
}

/// Returns the rows that begin in [first, last) of a section, with their line ends.
Result<std::string> rows_that_begin(const ByteSource& file, const Section& section, uint64_t first,
                                    uint64_t last) {
    const char line_end = section.layout.line_end;
    // A row begins behind a line end, which may be the byte before `first`.
    const uint64_t begin = first - (first > section.begin);
    const uint64_t end = std::min(section.end, last + kLongRow);
    std::string text(static_cast<size_t>(end - begin), '\0');
    LUCARNE_TRY(file.read_at(begin, std::as_writable_bytes(std::span(text))));
    if (end == section.end) text += line_end;  // the last row may lack it
    const size_t from = first > section.begin ? text.find(line_end) : std::string::npos;
    if (first > section.begin && from == text.npos) return std::string();
    const size_t cut =
        std::min(text.find(line_end, static_cast<size_t>(last - 1 - begin)), text.rfind(line_end));
    text.resize(cut == text.npos ? 0 : cut + 1);
    text.erase(0, std::min(from + 1, text.size()));  // npos + 1 is 0
    return text;
}

}  // namespace

size_t row_parts(std::span<const Section> sections) {
    size_t parts = 0;
    for (const Section& section : sections) parts += parts_of(section);
    return std::max<size_t>(1, parts);
}

Result<void> read_row_front(const ByteSource& file, std::span<const Section> sections, size_t part,
                            size_t most, PointBatch& batch) {
    batch.bytes.clear();
    batch.count = 0;
    size_t at = 0;
    for (; at < sections.size() && part >= parts_of(sections[at]); ++at) part -= parts_of(sections[at]);
    if (at == sections.size() || sections[at].begin == sections[at].end) return {};
    const Section& section = sections[at];
    const auto bound = [&](size_t i) {
        return section.begin + static_cast<uint64_t>(static_cast<unsigned __int128>(i) *
                                                     (section.end - section.begin) / parts_of(section));
    };
    const uint64_t first = bound(part), last = std::min(bound(part + 1), first + kFrontBytes);
    LUCARNE_ASSIGN(std::string text, rows_that_begin(file, section, first, last));
    RowLayout layout = section.layout;
    layout.salvage = true;
    if (layout.decimal_comma) std::ranges::replace(text, ',', '.');
    Piece piece;
    parse_rows(layout, text, piece);
    batch.count = static_cast<size_t>(std::min<uint64_t>(piece.points, most));
    piece.records.resize(batch.count * layout.schema.stride);
    batch.bytes = std::move(piece.records);
    return {};
}

}  // namespace lucarne::io::text
