#include "io/formats/text/ptx_scans.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/formats/common/buffered_input.h"
#include "io/formats/common/stations.h"
#include "io/formats/common/text.h"
#include "io/formats/text/sample.h"

namespace lucarne::io::ptx {
namespace {

using text::is_comment;

/// Returns the numbers of a line, if there are exactly N.
template <size_t N>
std::optional<std::array<double, N>> numbers(std::string_view line) {
    std::array<double, N> values{};
    for (double& value : values) {
        const auto parsed = parse_number<double>(next_word(line));
        if (!parsed || !usable(*parsed)) return std::nullopt;
        value = *parsed;
    }
    if (!next_word(line).empty()) return std::nullopt;
    return values;
}

std::optional<uint64_t> whole(std::string_view line) {
    const auto value = parse_number<uint64_t>(next_word(line));
    return value && next_word(line).empty() ? value : std::nullopt;
}

bool is_row_length(size_t values) {
    return values == 3 || values == 4 || values == 7;
}

/// What a line looks like as a row.
struct Row {
    size_t values = 0;    ///< at most 8
    bool point = false;   ///< a coordinate is not 0
    bool numbers = true;  ///< every value is a number
};
Row row_of(std::string_view line) {
    Row row;
    for (auto word = next_word(line); !word.empty() && row.values < 8; word = next_word(line)) {
        const auto value = parse_number<double>(word);
        row.point = row.point || (row.values < 3 && value != 0.0);
        row.numbers = row.numbers && value;
        ++row.values;
    }
    return row;
}

/// Tells which rows of a scan are surely its own, where unreadable text between them may have been the header
/// of another scan.
class Doubts {
 public:
    struct Place {
        uint64_t offset = 0;
        uint64_t rows = 0;  ///< before it
    };

    void add_row(uint64_t bytes, size_t values) {
        end_run(values);
        ++rows_;
        shortest_ = std::min(shortest_, bytes);
        longest_ = std::max(longest_, bytes);
    }
    void add_unreadable(uint64_t begin, uint64_t bytes) {
        if (run_lines_ == 0) run_ = {begin, rows_};
        ++run_lines_;
        run_bytes_ += bytes;
        unreadable_ += bytes;
    }
    uint64_t rows() const { return rows_; }

    /// Call after the last line. Returns the place from which on the rows may be those of another scan.
    std::optional<Place> first(uint64_t promised, size_t values) {
        end_run(values);
        if (first_ && promised >= rows_) {
            // Where a header was overwritten, rows of its scan follow, and the missing rows do not explain
            // the unreadable bytes.
            const auto missing = static_cast<double>(promised - rows_),
                       bytes = static_cast<double>(unreadable_), longest = static_cast<double>(longest_);
            if (bytes <= (missing + 1) * longest &&
                bytes + longest >= missing * static_cast<double>(std::min(shortest_, longest_)))
                return std::nullopt;
        }
        return first_;
    }

 private:
    void end_run(size_t values) {
        // The shortest header has 10 lines of 60 bytes. Some of its lines look like rows of 3 or 4 values; at
        // least 4 lines of 28 bytes do not.
        if (!first_ && run_lines_ > 0 && (run_lines_ >= 4 || run_bytes_ >= (values == 7 ? 60 : 28)))
            first_ = run_;
        run_lines_ = run_bytes_ = 0;
    }

    uint64_t rows_ = 0, shortest_ = UINT64_MAX, longest_ = 0;  ///< lengths of rows in bytes
    uint64_t unreadable_ = 0;                                  ///< bytes
    Place run_;                                                ///< the unreadable lines before the next row
    uint64_t run_lines_ = 0, run_bytes_ = 0;
    std::optional<Place> first_;
};

class ScanFinder {
 public:
    ScanFinder(const std::shared_ptr<const ByteSource>& file, char line_end, bool salvage)
        : size_(file->size()), line_end_(line_end), salvage_(salvage), input_(file, 0, size_) {}

    Result<Scans> find() {
        std::optional<Error> first_error;
        LUCARNE_TRY(input_.skip_mark());
        for (;;) {
            LUCARNE_ASSIGN(const bool more, salvage_ ? search_counts() : read_counts());
            if (!more) break;
            if (found_.scans.size() + 1 >= kMostStations) return wrong("has too many scans");
            auto scan = read_header();
            if (!scan && (!salvage_ || scan.error().kind != ErrorKind::input_rejected))
                return tl::unexpected(std::move(scan).error());
            if (!scan) {
                add_loss(found_.losses, lost::scan_header, 1);
                if (!first_error) first_error = std::move(scan).error();
                continue;
            }
            LUCARNE_TRY(salvage_ ? take_rows(*scan) : pass_rows(*scan));
            found_.scans.push_back(*scan);
        }
        if (salvage_ && found_.scans.empty())
            return first_error ? tl::unexpected(*first_error) : wrong("has no header of a scan");
        return std::move(found_);
    }

 private:
    /// A line that is neither blank nor a comment. The text is valid until the next line is read.
    struct Line {
        std::string_view text;
        uint64_t begin = 0, end = 0;  ///< in the file
        uint64_t number = 0;          ///< from 1
    };

    tl::unexpected<Error> wrong(std::string why) const { return rejected(input_.path(), std::move(why)); }
    tl::unexpected<Error> wrong_line(const Line& line, std::string_view what) {
        held_ = line;
        return wrong(fmt::format("line {} is not {}", line.number, what));
    }

    /// Returns the next line; nothing at the end of the file.
    Result<std::optional<Line>> next_line() {
        if (held_) return std::exchange(held_, std::nullopt);
        for (;;) {
            const uint64_t begin = input_.position();
            LUCARNE_ASSIGN(const auto text, input_.line(line_end_));
            if (!text) return std::nullopt;
            ++line_;
            std::string_view rest = *text;
            while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
            if (!rest.empty() && !is_comment(rest)) return Line{rest, begin, input_.position(), line_};
        }
    }
    Result<Line> header_line() {
        LUCARNE_ASSIGN(const auto line, next_line());
        if (!line) return wrong("ends within the header of a scan");
        return *line;
    }

    /// Returns the next line, unless the next two are the counts of a header: two whole numbers, each in a
    /// line of its own, are no rows. Then returns nothing and sets `counts_`.
    Result<std::optional<Line>> next_row() {
        LUCARNE_ASSIGN(auto line, next_line());
        const auto columns = line ? whole(line->text) : std::nullopt;
        if (!columns) return line;
        line->text = {};  // reading on invalidates it, and it is no row
        LUCARNE_ASSIGN(held_, next_line());
        const auto rows = held_ ? whole(held_->text) : std::nullopt;
        if (!rows) return line;
        counts_ = {*columns, *rows, line->begin, line->number};
        held_.reset();
        return std::nullopt;
    }

    /// Reads the counts that begin a header. Returns false at the end of the file.
    Result<bool> read_counts() {
        LUCARNE_ASSIGN(const auto first, next_line());
        if (!first) return false;
        const auto columns = whole(first->text);
        if (!columns) {
            auto error = wrong_line(*first, "the number of columns or rows of a scan");
            if (!found_.scans.empty() && is_row_length(row_of(first->text).values))
                error.value().todo = "if it is a further point of the scan before it, --salvage reads it";
            return error;
        }
        const uint64_t begin = first->begin, number = first->number;
        LUCARNE_ASSIGN(const Line second, header_line());
        const auto rows = whole(second.text);
        if (!rows) return wrong_line(second, "the number of columns or rows of a scan");
        counts_ = {*columns, *rows, begin, number};
        return true;
    }
    /// The same, but passes over lines before the counts. They are rows of a scan whose pose is unknown.
    Result<bool> search_counts() {
        while (!counts_) {
            LUCARNE_ASSIGN(const auto line, next_row());
            if (!line && !counts_) return false;
            if (line && is_row_length(row_of(line->text).values)) add_loss(found_.losses, lost::damaged, 1);
        }
        return true;
    }

    Result<Scan> read_header() {
        const Counts counts = *std::exchange(counts_, std::nullopt);
        const uint64_t most = salvage_ ? UINT32_MAX : size_;
        const bool too_many = counts.columns > 0 && counts.rows > most / counts.columns;
        if (too_many && !salvage_)
            return wrong(fmt::format("is truncated: the scan at line {} has {} x {} points", counts.line,
                                     counts.columns, counts.rows));
        Scan scan;
        scan.promised = too_many ? most : counts.columns * counts.rows;
        for (int i = 0; i < 4; ++i) {  // the position and three axes
            LUCARNE_ASSIGN(const Line line, header_line());
            const auto values = numbers<3>(line.text);
            if (!values) return wrong_line(line, "three numbers of a scanner's pose");
            if (i == 0) scan.station = {(*values)[0], (*values)[1], (*values)[2]};
        }
        for (int i = 0; i < 4; ++i) {
            LUCARNE_ASSIGN(const Line line, header_line());
            const auto values = numbers<4>(line.text);
            if (!values) return wrong_line(line, "four numbers of a scan's matrix");
            const glm::dvec3 row((*values)[0], (*values)[1], (*values)[2]);
            (i < 3 ? scan.pose.axes[i] : scan.pose.origin) = row;
        }
        // The scanner is at the origin of its own coordinates. If these are the world's already, the stated
        // position says where it stood.
        if (scan.pose.axes != glm::dmat3(1.0) || scan.pose.origin != glm::dvec3(0.0))
            scan.station = scan.pose.origin;
        scan.begin = here();
        scan.first_line = line_ + 1;
        return scan;
    }
    /// Returns where the next line begins.
    uint64_t here() const { return held_ ? held_->begin : input_.position(); }

    /// Passes as many rows as the scan promises. They are parsed later.
    Result<void> pass_rows(Scan& scan) {
        bool point = false;
        for (; scan.rows < scan.promised; ++scan.rows) {
            LUCARNE_ASSIGN(const auto line, next_row());
            const uint64_t missing = scan.promised - scan.rows;
            if (counts_)
                return wrong(
                    fmt::format("the next scan begins at line {}, but {} of {} points of the scan before it "
                                "are missing",
                                counts_->line, missing, scan.promised));
            if (!line)
                return wrong(
                    fmt::format("ends early: {} of {} points of a scan are missing", missing, scan.promised));
            if (point) continue;
            // The first row that is a point tells how many values a row has.
            const Row row = row_of(line->text);
            scan.values = std::max(scan.values, row.values);
            point = row.point;
            if (point && !is_row_length(scan.values)) return bad_values(scan);
        }
        if (scan.rows > 0 && !is_row_length(scan.values)) return bad_values(scan);
        scan.end = here();
        return {};
    }
    tl::unexpected<Error> bad_values(const Scan& scan) const {
        return wrong(fmt::format("line {} has {} values, a PTX point has 3, 4 or 7", line_, scan.values));
    }

    /// Finds the rows of a scan in a damaged file: those before the next header.
    Result<void> take_rows(Scan& scan) {
        Doubts doubts;
        scan.end = scan.begin;
        for (;;) {
            LUCARNE_ASSIGN(const auto line, next_row());
            if (!line) break;
            scan.end = line->end;
            const Row row = row_of(line->text);
            if (scan.values == 0 && row.point && row.numbers && is_row_length(row.values))
                scan.values = row.values;
            const bool missed = row.values >= 3 && !row.point;
            if (missed || (row.numbers && row.values == scan.values))
                doubts.add_row(line->end - line->begin, scan.values);
            else
                doubts.add_unreadable(line->begin, line->end - line->begin);
        }
        if (scan.values == 0) scan.values = 3;  // no row is a point
        scan.rows = doubts.rows();
        if (const auto doubt = doubts.first(scan.promised, scan.values)) {
            add_loss(found_.losses, lost::damaged, scan.rows - doubt->rows);
            scan.promised -=
                std::min(scan.promised - std::min(scan.promised, doubt->rows), scan.rows - doubt->rows);
            scan.rows = doubt->rows;
            scan.end = doubt->offset;
        }
        return {};
    }

    struct Counts {
        uint64_t columns = 0, rows = 0;
        uint64_t begin = 0, line = 0;  ///< of the first count
    };

    uint64_t size_;
    char line_end_;
    bool salvage_;
    BufferedInput input_;
    uint64_t line_ = 0;             ///< the last line that was read, from 1
    std::optional<Line> held_;      ///< the last line, if it is to be read again
    std::optional<Counts> counts_;  ///< of the next header
    Scans found_;
};

}  // namespace

Result<Scans> find_scans(std::shared_ptr<const ByteSource> file, char line_end, bool salvage) {
    return ScanFinder(file, line_end, salvage).find();
}

bool begins_scan(std::string_view head) {
    head = without_mark(head);
    const char line_end = text::line_end_of(head);
    for (int i = 0; i < 3; ++i) {
        const size_t end = head.find(line_end);
        if (end == head.npos && i < 2) return false;
        const auto line = head.substr(0, end);
        if (i < 2 ? !whole(line) : !numbers<3>(line)) return false;
        if (i < 2) head.remove_prefix(end + 1);
    }
    return true;
}

}  // namespace lucarne::io::ptx
