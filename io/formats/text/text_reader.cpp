// Rows of numbers: XYZ, TXT, CSV, ASC, and PTS, whose rows follow a count.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/format.h"
#include "io/formats/common/remarks.h"
#include "io/formats/common/text.h"
#include "io/formats/common/value_range.h"
#include "io/formats/text/columns.h"
#include "io/formats/text/row_fronts.h"
#include "io/formats/text/sample.h"
#include "io/formats/text/writer.h"

namespace lucarne::io {
namespace {

using namespace text;

constexpr size_t kHeadBytes = size_t{64} << 10;
constexpr size_t kMostColumns = 1000;
constexpr std::string_view kNoRows =
    "has an unrecognised format: it is text without rows of three numbers or more";
constexpr std::string_view kColumnsRemark = "lucarne columns ";

/// The part of the file before the rows.
struct Head {
    uint64_t begin = 0, line = 1;  ///< of the count, otherwise of the first row; lines count from 1
    std::optional<uint64_t> count;
    std::string header, comment;       ///< the last of each
    std::vector<std::string> remarks;  ///< Lucarne's own comments
    RowLayout layout;                  ///< separator and line end
    size_t columns = 0;
};

class TextSource final : public PointSource {
 public:
    explicit TextSource(std::shared_ptr<const ByteSource> file) : file_(std::move(file)) {}

    Result<void> describe(const ReadOptions& options) {
        const std::string extension = lower_extension(file_->path());
        std::optional<std::vector<Column>> given;
        if (!options.columns.empty()) {
            LUCARNE_ASSIGN(given, parse_columns(options.columns));
        }
        LUCARNE_TRY(read_head(given));
        const bool pts = head_.count.has_value() || extension == ".pts";
        head_.layout.has_counts = pts;
        LUCARNE_ASSIGN(auto sampled,
                       take_sample(*file_, head_.begin, file_->size(), head_.layout, head_.columns));
        LUCARNE_ASSIGN(const auto columns, choose_columns(sampled.sample, given, options));
        if (const auto& cell = sampled.sample.no_number; !cell.empty() && !options.quiet)
            log::info("{}: cells such as '{}' are read as no number", file_->path().string(), cell);
        Section section{head_.begin, file_->size(), make_layout(columns, sampled.sample), {}, head_.line};
        section.layout.separator = head_.layout.separator;
        section.layout.decimal_comma = head_.layout.decimal_comma;
        section.layout.line_end = head_.layout.line_end;
        section.layout.has_counts = pts;
        section.layout.salvage = options.salvage;
        sections_.push_back(std::move(section));
        LUCARNE_ASSIGN(const auto remarks, remarks_of(file_->path().string(), head_.remarks));
        info_.stations = remarks.stations;
        set_unit(info_, options, remarks.metres_per_unit ? remarks.metres_per_unit : unit_);
        fill_info(pts ? "PTS" : "XYZ", columns, sampled, remarks);
        // The last row may lack its line end.
        const uint64_t most =
            (file_->size() - head_.begin + 1) / (least_cell_bytes(head_.layout.separator) * head_.columns);
        if (head_.count && *head_.count > most && !options.salvage)
            return refuse(
                fmt::format("is truncated: it promises {} points, at most {} are there", *head_.count, most));
        return {};
    }

    const Schema& schema() const override { return sections_[0].layout.schema; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return read_rows(file_, sections_); }
    size_t parts() const override { return row_parts(sections_); }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        return read_row_front(*file_, sections_, part, most, batch);
    }

 private:
    Result<void> refuse(std::string why, std::string todo = {}) const {
        return rejected(file_->path().string(), std::move(why), std::move(todo));
    }

    /// Finds the first row of points.
    Result<void> read_head(const std::optional<std::vector<Column>>& given) {
        std::string bytes(static_cast<size_t>(std::min<uint64_t>(kHeadBytes, file_->size())), '\0');
        LUCARNE_TRY(file_->read_at(0, std::as_writable_bytes(std::span(bytes))));
        std::string_view rest = bytes;
        if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);  // the byte order mark of UTF-8
        head_.layout.line_end = line_end_of(rest);
        uint64_t number = 0;
        while (!rest.empty()) {
            const uint64_t begin = bytes.size() - rest.size();
            const size_t end = rest.find(head_.layout.line_end);
            auto line = rest.substr(0, end);
            rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
            ++number;
            while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
            if (line.empty()) continue;
            if (is_comment(line)) {
                const auto comment = line.substr(std::min(line.find_first_not_of("#%/ \t"), line.size()));
                if (comment.starts_with("lucarne "))
                    head_.remarks.emplace_back(trimmed(comment));
                else
                    head_.comment = comment;
                continue;
            }
            auto cut = cut_of(line);
            if (!cut && !given)
                return refuse(
                    fmt::format("its line {}, '{}', can be read with decimal commas or without", number,
                                printable(line)),
                    "set semicolons between the values, or say what the columns are with --columns");
            if (!cut) cut = Cut{','};
            if (cut->separator == ';') cut->decimal_comma = bytes.find(',') != bytes.npos;
            std::string with_points(line);
            if (cut->decimal_comma) std::ranges::replace(with_points, ',', '.');
            const auto cells = split(with_points, cut->separator);
            if (cells.size() == 1 && parse_number<uint64_t>(cells[0])) {
                head_.count = parse_number<uint64_t>(cells[0]);
                set_begin(begin, number);
            } else if (begins_rows(cells, given)) {
                if (!head_.count) set_begin(begin, number);
                // Tabs separate where they do so in the header: names and cells may hold blanks, or nothing.
                const bool tabs = cut->separator == ' ' && line.find('\t') != line.npos &&
                                  (head_.header + head_.comment).find('\t') != std::string::npos;
                if (tabs) cut->separator = '\t';
                return take_cut(*cut, tabs ? split(with_points, '\t').size() : cells.size());
            } else if (head_.count) {
                break;
            } else {
                head_.header = line;
            }
        }
        return refuse(std::string(kNoRows));
    }
    static bool begins_rows(const std::vector<std::string_view>& cells,
                            const std::optional<std::vector<Column>>& given) {
        if (!given || cells.size() != given->size()) return is_row(cells) && !named_columns(cells);
        std::vector<std::string_view> axes;
        for (size_t i = 0; i < cells.size(); ++i)
            for (const char* axis : {"x", "y", "z"})
                if ((*given)[i].name == axis) axes.push_back(cells[i]);
        return is_row(axes);
    }
    Result<void> take_cut(const Cut& cut, size_t columns) {
        if (columns > kMostColumns)
            return refuse(
                fmt::format("has {} or more values in a row, {} can be read", columns, kMostColumns));
        head_.layout.separator = cut.separator;
        head_.layout.decimal_comma = cut.decimal_comma;
        head_.columns = columns;
        return {};
    }
    void set_begin(uint64_t begin, uint64_t line) {
        head_.begin = begin;
        head_.line = line;
    }

    Result<std::vector<Column>> choose_columns(const Sample& sample,
                                               const std::optional<std::vector<Column>>& given,
                                               const ReadOptions& options) {
        if (given) {
            if (given->size() != sample.columns)
                return bad_arguments("--columns",
                                     fmt::format("names {} columns, the rows of {} have {}", given->size(),
                                                 file_->path().string(), sample.columns));
            return *given;
        }
        for (std::string_view remark : head_.remarks) {
            if (!remark.starts_with(kColumnsRemark)) continue;
            auto columns = written_columns(remark.substr(kColumnsRemark.size()));
            if (columns && columns->size() == sample.columns) return std::move(*columns);
        }
        for (const bool is_header : {true, false}) {
            const std::string& text = is_header ? head_.header : head_.comment;
            auto words = split(text, head_.layout.separator);
            // Blanks may separate the words of a comment even if commas separate the cells of the rows.
            if (!is_header && words.size() != sample.columns) words = split(text, ' ');
            if (words.size() != sample.columns) words = with_brackets(words);
            auto columns = named_columns(words);
            if (columns && words.size() == sample.columns) {
                const AxisUnit unit = axis_unit(words, *columns);
                if (!unit.problem.empty() && !options.quiet && !options.metres_per_unit)
                    log::warn("{}: {}", file_->path().string(), unit.problem);
                unit_ = unit.metres;
                return std::move(*columns);
            }
            if (is_header && !text.empty())
                return rejected(
                    file_->path().string(),
                    fmt::format("its header '{}' does not name the {} columns of its rows, with x, y "
                                "and z among them once each",
                                printable(text), sample.columns),
                    "say what they are with --columns");
        }
        auto columns = guess_columns(sample, head_.layout.has_counts);
        if (!columns) return rejected(file_->path().string(), std::string(kNoRows));
        const std::string text = columns_text(*columns);
        if (!options.quiet)
            log::info("{}: its columns are taken as {}{}; --columns can say otherwise",
                      file_->path().string(), text, text.find('-') == text.npos ? "" : " (- is left out)");
        return std::move(*columns);
    }

    void fill_info(std::string_view name, const std::vector<Column>& columns, const Sampled& sampled,
                   const Remarks& remarks) {
        info_.path = file_->path().string();
        info_.format = fmt::format("{}, columns {}", name, columns_text(columns));
        info_.declared_points = head_.count.value_or(sampled.rows);
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        if (schema().find(names::color))
            info_.color_bits = remarks.color_bits.value_or(color_bits(columns, sampled.sample));
        info_.notes.color_bits = info_.color_bits;
        const Attribute* intensity = schema().find(names::intensity);
        if (name == "PTS" && intensity && intensity->type == ScalarType::i32)
            info_.notes.intensity_limits = {-2048, 2047, true};  // Leica's whole numbers of 12 bits
        for (size_t i = 0; i < columns.size(); ++i)
            if (sections_[0].layout.fields[i].kind == Field::Kind::skip)
                add_loss(info_.losses, "columns that are left out", 1);
    }

    std::shared_ptr<const ByteSource> file_;
    Head head_;
    std::vector<Section> sections_;
    std::optional<double> unit_;  ///< that the header states, in metres
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_text(std::shared_ptr<const ByteSource> file,
                                               const ReadOptions& options) {
    auto source = std::make_unique<TextSource>(std::move(file));
    LUCARNE_TRY(source->describe(options));
    return source;
}

/// Returns whether there are no control characters except white space.
bool is_text(std::string_view head) {
    return std::all_of(head.begin(), head.end(), [](char c) {
        return static_cast<unsigned char>(c) >= ' ' || is_blank(c) || c == '\n';
    });
}

}  // namespace

const Format& text_format() {
    static constexpr Format kFormat{"XYZ", ".xyz", is_text, open_text, text::create, true};
    return kFormat;
}
// Read in the same way; written with a header.
const Format& txt_format() {
    static constexpr Format kFormat{"TXT", ".txt", is_text, open_text, text::create, true};
    return kFormat;
}
const Format& csv_format() {
    static constexpr Format kFormat{"CSV", ".csv", is_text, open_text, text::create, true};
    return kFormat;
}

}  // namespace lucarne::io
