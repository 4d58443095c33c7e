// PTX: scans as grids, each with the pose of its scanner. Source: Leica Geosystems, "Cyclone PTX format":
// number of columns, number of rows, scanner position, its three axes, a 4x4 matrix for row vectors; then a
// line for each point: x y z intensity [r g b] in the scanner's coordinates, zeros where a ray hit nothing.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/buffered_input.h"
#include "io/formats/common/format.h"
#include "io/formats/common/stations.h"
#include "io/formats/common/text.h"
#include "io/formats/common/value_range.h"
#include "io/formats/text/rows.h"
#include "io/formats/text/sample.h"

namespace lucarne::io {
namespace {

using namespace text;

struct Scan {
    uint64_t rows = 0;  ///< promised by the header
    RowLayout::Pose pose;
    glm::dvec3 station{0.0};
    uint64_t begin = 0, end = 0, first_line = 0;
    size_t values = 0;  ///< per row: 3, 4 or 7
};

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
    return next_word(line).empty() ? value : std::nullopt;
}

/// Finds the scans. It must read the whole file, because only the lines tell where the next scan begins.
class ScanFinder {
 public:
    /// With `salvage` the last scan may have fewer rows than it promises, and unreadable text after the last
    /// scan is left out.
    ScanFinder(std::shared_ptr<const ByteSource> file, char line_end, bool salvage)
        : size_(file->size()), line_end_(line_end), salvage_(salvage), input_(std::move(file), 0, size_) {}

    Result<std::vector<Scan>> find() {
        std::vector<Scan> scans;
        LUCARNE_TRY(input_.skip_mark());
        for (;;) {
            LUCARNE_ASSIGN(const bool more, skip_blank_lines());
            if (!more) return scans;
            if (scans.size() + 1 >= kMostStations) return wrong("has too many scans");
            auto scan = read_scan();
            if (!scan && salvage_ && scan.error().kind == ErrorKind::input_rejected) {
                if (cut_off_) scans.push_back(*cut_off_);
                lost_ = !cut_off_;
                if (!scans.empty()) return scans;
            }
            if (!scan) return tl::unexpected(std::move(scan).error());
            scans.push_back(*scan);
        }
    }
    bool lost_a_scan() const { return lost_; }

 private:
    tl::unexpected<Error> wrong(std::string why) const { return rejected(input_.path(), std::move(why)); }
    tl::unexpected<Error> wrong_line(std::string_view what) const {
        return wrong(fmt::format("line {} is not {}", line_, what));
    }

    Result<bool> skip_blank_lines() {
        for (;;) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(1));
            if (bytes.empty()) return false;
            const char c = static_cast<char>(bytes[0]);
            if (c != line_end_ && !is_blank(c)) return true;
            line_ += c == line_end_;
            input_.skip(1);
        }
    }

    Result<std::string_view> next_line() {
        LUCARNE_ASSIGN(const auto line, input_.line(line_end_));
        ++line_;
        if (!line) return wrong("ends within the header of a scan");
        return *line;
    }

    Result<Scan> read_scan() {
        LUCARNE_ASSIGN(Scan scan, read_header());
        auto done = pass_rows(scan);
        if (!done && input_.position() >= size_ &&
            (scan.values == 3 || scan.values == 4 || scan.values == 7)) {
            scan.end = size_;
            cut_off_ = scan;
        }
        if (!done) return tl::unexpected(std::move(done).error());
        return scan;
    }

    Result<Scan> read_header() {
        Scan scan;
        std::array<uint64_t, 2> size{};
        for (uint64_t& extent : size) {
            LUCARNE_ASSIGN(const auto line, next_line());
            const auto value = whole(line);
            if (!value) return wrong_line("the number of columns or rows of a scan");
            extent = *value;
        }
        const uint64_t most = salvage_ ? UINT32_MAX : size_;
        if (size[0] > most || size[1] > most || (size[0] > 0 && size[1] > most / size[0]))
            return wrong(fmt::format("is truncated: the scan before line {} has {} x {} points", line_,
                                     size[0], size[1]));
        scan.rows = size[0] * size[1];
        for (int i = 0; i < 4; ++i) {  // the position and three axes
            LUCARNE_ASSIGN(const auto line, next_line());
            const auto values = numbers<3>(line);
            if (!values) return wrong_line("three numbers of a scanner's pose");
            if (i == 0) scan.station = {(*values)[0], (*values)[1], (*values)[2]};
        }
        for (int i = 0; i < 4; ++i) {
            LUCARNE_ASSIGN(const auto line, next_line());
            const auto values = numbers<4>(line);
            if (!values) return wrong_line("four numbers of a scan's matrix");
            const glm::dvec3 row((*values)[0], (*values)[1], (*values)[2]);
            (i < 3 ? scan.pose.axes[i] : scan.pose.origin) = row;
        }
        // The scanner is at the origin of its own coordinates. If these are the world's already, the stated
        // position says where it stood.
        if (scan.pose.axes != glm::dmat3(1.0) || scan.pose.origin != glm::dvec3(0.0))
            scan.station = scan.pose.origin;
        return scan;
    }

    Result<void> pass_rows(Scan& scan) {
        scan.begin = input_.position();
        scan.first_line = line_ + 1;
        uint64_t left = scan.rows;
        // The first row that is a point tells how many values a row has.
        for (bool point = false; left > 0 && !point; --left) {
            LUCARNE_ASSIGN(const auto line, input_.line(line_end_));
            if (!line) return truncated(left, scan.rows);
            const auto cells = columns_of(*line);
            scan.values = std::max(scan.values, cells.count);
            point = cells.point;
            ++line_;
        }
        if (scan.rows > 0 && scan.values != 3 && scan.values != 4 && scan.values != 7)
            return wrong(fmt::format("line {} has {} values, a PTX point has 3, 4 or 7", line_, scan.values));
        line_ += left;
        while (left > 0) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(1));
            if (bytes.empty()) return truncated(left, scan.rows);
            const auto* text = reinterpret_cast<const char*>(bytes.data());
            const auto lines = static_cast<uint64_t>(std::count(text, text + bytes.size(), line_end_));
            const bool last =
                input_.position() + bytes.size() >= size_ && text[bytes.size() - 1] != line_end_;
            if (lines < left) {
                left -= lines;
                input_.skip(bytes.size());
                if (last && left == 1) break;  // the last row of the file may lack its line end
                continue;
            }
            const char* at = text;
            for (; left > 0; --left)
                at = static_cast<const char*>(
                         std::memchr(at, line_end_, static_cast<size_t>(text + bytes.size() - at))) +
                     1;
            input_.skip(static_cast<size_t>(at - text));
        }
        scan.end = input_.position();
        return {};
    }
    Result<void> truncated(uint64_t left, uint64_t rows) const {
        return wrong(fmt::format("ends early: {} of {} points of a scan are missing", left, rows));
    }

    struct Cells {
        size_t count = 0;
        bool point = false;
    };
    static Cells columns_of(std::string_view line) {
        Cells cells;
        for (auto word = next_word(line); !word.empty() && cells.count < 8; word = next_word(line)) {
            cells.point = cells.point || (cells.count < 3 && parse_number<double>(word) != 0.0);
            ++cells.count;
        }
        return cells;
    }

    uint64_t size_;
    char line_end_;
    bool salvage_, lost_ = false;
    BufferedInput input_;
    uint64_t line_ = 0;  ///< the last line that was read, from 1
    std::optional<Scan> cut_off_;
};

class PtxSource final : public PointSource {
 public:
    PtxSource(std::shared_ptr<const ByteSource> file, const std::vector<Scan>& scans, char line_end,
              const ReadOptions& options, bool lost_a_scan)
        : file_(std::move(file)), salvage_(options.salvage) {
        add_loss(info_.losses, lost::cut_scan, lost_a_scan);
        info_.path = file_->path().string();
        info_.format = fmt::format("PTX, {} {}", scans.size(), scans.size() == 1 ? "scan" : "scans");
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        set_unit(info_, options, 1.0);  // the format is in metres
        info_.notes.color_bits = info_.color_bits;
        info_.notes.intensity_limits = {0, 1, true};
        size_t values = 3;
        for (const Scan& scan : scans) values = std::max(values, scan.values);
        if (values >= 4) schema_.add(std::string(names::intensity), ScalarType::f32);
        if (values == 7) schema_.add(std::string(names::color), ScalarType::u8, 3);
        if (scans.size() > 1) schema_.add(std::string(names::point_source_id), ScalarType::u16);
        for (const Scan& scan : scans) {
            const auto id = static_cast<uint32_t>(info_.stations.size() + 1);
            info_.stations.push_back({id, scan.station});
            info_.declared_points += scan.rows;
            if (scan.rows > 0) sections_.push_back(section_of(scan, id, line_end));
        }
    }

    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return read_rows(file_, sections_); }

 private:
    Section section_of(const Scan& scan, uint32_t id, char line_end) const {
        RowLayout layout;
        layout.schema = schema_;
        layout.line_end = line_end;
        layout.zero_is_missed = true;
        layout.salvage = salvage_;
        layout.pose = scan.pose;
        layout.blank.resize(schema_.stride);
        if (const Attribute* source = schema_.find(names::point_source_id))
            store(&layout.blank[source->offset], static_cast<uint16_t>(id));
        constexpr std::array kNames = {"x", "y", "z", "intensity", "red", "green", "blue"};
        for (uint32_t i = 0; i < scan.values; ++i) {
            Field field{Field::Kind::scalar, ScalarType::u8, i, kNames[i]};
            if (i < 3) {
                field.kind = Field::Kind::position;
                field.type = ScalarType::f64;
            } else if (i == 3) {
                field.type = ScalarType::f32;
                field.to = schema_.find(names::intensity)->offset;
            } else {
                field.to = schema_.find(names::color)->offset + i - 4;
            }
            layout.fields.push_back(field);
        }
        return {scan.begin, scan.end, std::move(layout), scan.rows, scan.first_line};
    }

    std::shared_ptr<const ByteSource> file_;
    bool salvage_;
    Schema schema_;
    std::vector<Section> sections_;
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_ptx(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    std::array<std::byte, 4096> bytes{};
    LUCARNE_ASSIGN(const size_t got, file->read_some(0, bytes));
    const char line_end = line_end_of({reinterpret_cast<const char*>(bytes.data()), got});
    ScanFinder finder(file, line_end, options.salvage);
    LUCARNE_ASSIGN(const auto scans, finder.find());
    return std::make_unique<PtxSource>(std::move(file), scans, line_end, options, finder.lost_a_scan());
}

/// Returns whether the text begins with two counts and three numbers.
bool is_ptx(std::string_view head) {
    head = without_mark(head);
    const char line_end = line_end_of(head);
    for (int i = 0; i < 3; ++i) {
        const size_t end = head.find(line_end);
        if (end == head.npos && i < 2) return false;
        const auto line = head.substr(0, end);
        if (i < 2 ? !whole(line) : !numbers<3>(line)) return false;
        if (i < 2) head.remove_prefix(end + 1);
    }
    return true;
}

}  // namespace

const Format& ptx_format() {
    static constexpr Format kFormat{"PTX", ".ptx", is_ptx, open_ptx, nullptr, true};
    return kFormat;
}

}  // namespace lucarne::io
