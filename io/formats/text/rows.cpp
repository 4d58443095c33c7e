#include "io/formats/text/rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "io/core/parallel.h"
#include "io/formats/text/cells.h"

namespace lucarne::io::text {
namespace {

constexpr size_t kPieces = 16, kReadBytes = size_t{256} << 10;  ///< pieces are parsed in parallel
constexpr size_t kLongestLine = size_t{1} << 20;

/// Stores `value` at `at` if it is a whole number of this type. A signed byte may also be 128 to 255, because
/// some writers mean unsigned.
template <class T>
bool store_whole(double value, std::byte* at) {
    constexpr double kLeast = std::is_signed_v<T> ? -0x1p0 * (uint64_t{1} << (8 * sizeof(T) - 1)) : 0.0;
    constexpr double kMost = sizeof(T) == 1 ? 255.0 : static_cast<double>(std::numeric_limits<T>::max());
    if (!(value >= kLeast && value <= kMost) || value != std::trunc(value)) return false;
    store(at, static_cast<T>(static_cast<int64_t>(value)));
    return true;
}

/// Returns the nearest float; infinity if the value is too large.
float nearest_float(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return std::abs(value) > kMost
               ? std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(value > 0 ? 1 : -1))
               : static_cast<float>(value);
}

bool store_value(ScalarType type, double value, std::byte* at) {
    switch (type) {
        case ScalarType::u8:
            return store_whole<uint8_t>(value, at);
        case ScalarType::i8:
            return store_whole<int8_t>(value, at);
        case ScalarType::u16:
            return store_whole<uint16_t>(value, at);
        case ScalarType::i16:
            return store_whole<int16_t>(value, at);
        case ScalarType::u32:
            return store_whole<uint32_t>(value, at);
        case ScalarType::i32:
            return store_whole<int32_t>(value, at);
        case ScalarType::f32:
            store(at, nearest_float(value));
            return true;
        case ScalarType::f64:
            store(at, value);
            return true;
        default:
            return false;  // 64-bit integers are not parsed as doubles
    }
}

template <class T>
bool store_exactly(std::string_view word, std::byte* at) {
    constexpr auto kLeast = static_cast<double>(std::numeric_limits<T>::min()),
                   kEnd = static_cast<double>(std::numeric_limits<T>::max());  // rounded up by one
    auto value = parse_number<T>(word);
    if (const auto real = value ? std::nullopt : parse_number<double>(word);  // "1.7e18"
        real && *real >= kLeast && *real < kEnd && *real == std::trunc(*real))
        value = static_cast<T>(*real);
    if (value) store(at, *value);
    return value.has_value();
}

class RowParser {
 public:
    RowParser(const RowLayout& layout, std::string_view text, Piece& piece)
        : layout_(layout), at_(text.data()), end_(text.data() + text.size()), piece_(piece) {}

    void parse() {
        const size_t stride = layout_.schema.stride;
        // Reserves no more records than the text can hold.
        const size_t row_bytes =
            least_cell_bytes(layout_.separator) * std::max<size_t>(1, layout_.fields.size());
        const size_t most = static_cast<size_t>(end_ - at_) / row_bytes + 1;
        if (piece_.records.size() < most * stride) piece_.records.resize(most * stride);
        std::byte* record = piece_.records.data();
        while (at_ < end_) {
            ++piece_.lines;
            const char* line = at_;
            skip_blanks();
            if (is_comment()) {
                next_line();
                continue;
            }
            if (*at_ == layout_.line_end) {
                ++at_;
                continue;
            }
            if (layout_.blank.empty())
                std::memset(record, 0, stride);
            else
                std::memcpy(record, layout_.blank.data(), stride);
            piece_.ends_in_point = false;
            if (!parse_row(record)) {
                failed_ = at_;
                at_ = line;
                if (!odd_row(line)) break;
                continue;
            }
            if (is_missed()) {
                ++piece_.missed;
            } else if (finish_point(record)) {
                record += stride;
                ++piece_.points;
                piece_.ends_in_point = true;
            } else {
                ++piece_.dropped;
            }
        }
    }

 private:
    void skip_blanks() {
        while (is_padding(*at_, layout_.separator) && *at_ != layout_.line_end) ++at_;
    }
    void next_line() {
        at_ =
            static_cast<const char*>(std::memchr(at_, layout_.line_end, static_cast<size_t>(end_ - at_))) + 1;
    }
    bool is_comment() const {
        return *at_ == '#' || *at_ == '%' || (*at_ == '/' && at_ + 1 < end_ && at_[1] == '/');
    }
    bool at_separator() const { return *at_ == layout_.separator && layout_.separator != ' '; }
    bool ends_word(char c) const { return is_blank(c) || c == layout_.line_end || c == layout_.separator; }

    /// Returns the word at the cursor and moves the cursor behind it.
    std::string_view word() {
        const char* first = at_;
        at_ = behind_quotes(at_, end_, layout_.line_end);
        if (layout_.separator != ' ')
            while (*at_ != layout_.line_end && *at_ != layout_.separator) ++at_;
        else
            while (!ends_word(*at_)) ++at_;
        const char* last = at_;
        while (last > first && is_blank(last[-1])) --last;
        return {first, static_cast<size_t>(last - first)};
    }

    bool number(double& value) {
        const char* after = plain_number(at_, value);
        if (after && ends_word(*after)) {
            at_ = after;
            return true;
        }
        const char* first = at_;
        const auto parsed = cell_number(word());
        if (!parsed) at_ = first;
        value = parsed.value_or(0);
        return parsed.has_value();
    }

    /// Parses one row from the cursor and leaves the cursor behind it. Returns false with the cursor at the
    /// text that does not fit.
    bool parse_row(std::byte* record) {
        bool first = true;
        for (const Field& field : layout_.fields) {
            if (!first && layout_.separator != ' ') {
                if (!at_separator()) return false;
                ++at_;
            }
            first = false;
            skip_blanks();
            if (!parse_field(field, record)) return false;
            skip_blanks();
        }
        if (at_separator()) {  // a separator after the last value
            ++at_;
            skip_blanks();
        }
        if (*at_ != layout_.line_end) return false;
        ++at_;
        return true;
    }

    bool parse_field(const Field& field, std::byte* record) {
        const bool empty = *at_ == layout_.line_end || at_separator();
        if (empty && layout_.separator == ' ') return false;
        if (empty) return missing_value(field, record);
        double value = 0;
        const char* start = at_;
        switch (field.kind) {
            case Field::Kind::position:
                return number(position_[field.to]);
            case Field::Kind::scalar:
                if (field.type == ScalarType::u64)
                    return store_exactly<uint64_t>(unquoted(word()), record + field.to);
                if (field.type == ScalarType::i64)
                    return store_exactly<int64_t>(unquoted(word()), record + field.to);
                if (!number(value)) break;
                if (std::isnan(value)) return missing_value(field, record);
                if (store_value(field.type, value, record + field.to)) return true;
                break;
            case Field::Kind::packed:
                if (packed_color(field, record)) return true;
                break;
            case Field::Kind::skip:
                word();
                return true;
        }
        at_ = start;
        return false;
    }

    /// Handles an empty cell: a missing coordinate, NaN, or 0 for types without NaN.
    bool missing_value(const Field& field, std::byte* record) {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        if (field.kind == Field::Kind::position) position_[field.to] = kNone;
        const bool real = field.type == ScalarType::f32 || field.type == ScalarType::f64;
        if (field.kind == Field::Kind::scalar && real) store_value(field.type, kNone, record + field.to);
        return true;
    }

    bool packed_color(const Field& field, std::byte* record) {
        uint32_t bits = 0;
        const auto text = word();
        if (field.type == ScalarType::f32) {
            constexpr uint32_t kNoColor = 0xffbcbcbc;  // the sRGB grey of an albedo of .5
            const auto value = parse_number<float>(text);
            if (!value) return false;
            std::memcpy(&bits, &*value, sizeof bits);
            // A NaN loses its bits when it is written as text.
            if (!std::isfinite(*value)) bits = kNoColor;
        } else {
            const auto value = parse_number<int64_t>(text);
            if (!value || *value < std::numeric_limits<int32_t>::min() ||
                *value > std::numeric_limits<uint32_t>::max())
                return false;
            bits = static_cast<uint32_t>(*value);
        }
        for (uint32_t k = 0; k < 3; ++k)
            store(record + field.to + k, static_cast<uint8_t>(bits >> (16 - 8 * k)));
        if (field.alpha) store(record + *field.alpha, static_cast<uint8_t>(bits >> 24));
        return true;
    }

    bool is_missed() const { return layout_.zero_is_missed && position_ == std::array<double, 3>{}; }

    bool finish_point(std::byte* record) {
        glm::dvec3 p(position_[0], position_[1], position_[2]);
        if (layout_.pose) p = layout_.pose->axes * p + layout_.pose->origin;
        for (int axis = 0; axis < 3; ++axis) {
            if (!usable(p[axis])) return false;
            if (layout_.schema.position == PositionType::f64)
                store(record + 8 * axis, p[axis]);
            else
                store(record + 4 * axis, static_cast<float>(p[axis]));
        }
        return true;
    }

    /// Handles a line that is no row: a count, a ray that hit nothing and lacks its other values, or an
    /// error.
    bool odd_row(const char* line) {
        const char* last =
            static_cast<const char*>(std::memchr(line, layout_.line_end, static_cast<size_t>(end_ - line)));
        std::string_view rest(line, static_cast<size_t>(last - line));
        const auto first = next_word(rest);
        auto others = rest;
        const bool alone = next_word(others).empty();
        if (const auto count = parse_number<uint64_t>(first); layout_.has_counts && alone && count) {
            if (*count > std::numeric_limits<uint64_t>::max() - piece_.promised) {
                piece_.problem = fmt::format("the count {} is too large", first);
                return false;  // an error even with `salvage`
            }
            piece_.promised += *count;
            at_ = last + 1;
            return true;
        }
        if (layout_.zero_is_missed && parse_number<double>(first) == 0.0 &&
            parse_number<double>(next_word(rest)) == 0.0 && parse_number<double>(next_word(rest)) == 0.0) {
            ++piece_.missed;
            at_ = last + 1;
            return true;
        }
        if (layout_.salvage) {
            ++piece_.bad;
            at_ = last + 1;
            return true;
        }
        explain(line, last);
        return false;
    }

    void explain(const char* line, const char* last) {
        // Finds the field at which the row failed.
        at_ = line;
        size_t done = 0;
        skip_blanks();
        for (; done < layout_.fields.size(); ++done) {
            if (done > 0 && layout_.separator != ' ') {
                if (!at_separator()) break;
                ++at_;
            }
            skip_blanks();
            if (at_ >= failed_ || *at_ == layout_.line_end) break;
            word();
            skip_blanks();
        }
        if (failed_ >= last)
            piece_.problem = fmt::format("it has {} values instead of {}", done, layout_.fields.size());
        else if (done >= layout_.fields.size())
            piece_.problem = fmt::format("it has more than the {} values of a row", layout_.fields.size());
        else
            piece_.problem =
                fmt::format("'{}' is no value for {} ({})",
                            printable(std::string_view(
                                failed_, std::min<size_t>(40, static_cast<size_t>(last - failed_)))),
                            layout_.fields[done].name, scalar_name(layout_.fields[done].type));
    }

    const RowLayout& layout_;
    const char *at_, *end_, *failed_ = nullptr;
    Piece& piece_;
    std::array<double, 3> position_{};
};

class RowReader final : public PointReader {
 public:
    RowReader(std::shared_ptr<const ByteSource> file, const std::vector<Section>& sections)
        : file_(std::move(file)), sections_(sections), pieces_(kPieces), next_(kPieces) {
        if (!sections_.empty()) begin_section();
    }

    Result<size_t> read(PointBatch& batch, size_t most) override {
        if (sections_.empty()) return size_t{0};
        const size_t stride = sections_[0].layout.schema.stride;
        const size_t wanted = batch_limit(sections_[0].layout.schema, most);
        batch.bytes.clear();
        batch.count = 0;
        while (batch.count < wanted) {
            if (next_ == kPieces) {
                if (batch.count > 0) break;  // an error must not hide the points before it
                LUCARNE_ASSIGN(const bool more, parse_window());
                if (!more) break;
            }
            const Piece& piece = pieces_[next_];
            const auto count =
                static_cast<size_t>(std::min<uint64_t>(piece.points - taken_, wanted - batch.count));
            const auto* from = piece.records.data() + taken_ * stride;
            batch.bytes.insert(batch.bytes.end(), from, from + count * stride);
            batch.count += count;
            taken_ += count;
            if (taken_ < piece.points) continue;
            // Returns the good points before a bad row first.
            if (!piece.problem.empty() && batch.count > 0) break;
            LUCARNE_TRY(finish_piece(piece));
        }
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_ + missed_; }
    Losses losses() const override {
        Losses losses;
        add_loss(losses, "rays that met nothing", missed_);
        add_loss(losses, lost::no_number, dropped_);
        add_loss(losses, lost::damaged, bad_);
        add_loss(losses, lost::cut_off, cut_off_);
        return losses;
    }

 private:
    void begin_section() {
        at_ = sections_[section_].begin;
        line_ = sections_[section_].first_line;
        rows_ = promised_ = carried_ = 0;
    }

    Result<void> finish_piece(const Piece& piece) {
        line_ += piece.lines;
        if (!piece.problem.empty())
            return rejected(file_->path().string(),
                            fmt::format("cannot be read from line {} on: {}", line_ - 1, piece.problem));
        rows_ += rows_of(piece);
        dropped_ += piece.dropped;
        missed_ += piece.missed;
        bad_ += piece.bad;
        if (piece.promised > std::numeric_limits<uint64_t>::max() - promised_)
            return rejected(file_->path().string(), "its counts of points are too large");
        promised_ += piece.promised;
        taken_ = 0;
        ++next_;
        return {};
    }

    static uint64_t rows_of(const Piece& piece) {
        return piece.points + piece.dropped + piece.missed + piece.bad;
    }

    /// Checks the number of rows. Fewer rows than promised are an error; more than a count states are not.
    Result<void> end_section() {
        const auto& rows = sections_[section_].rows;
        const uint64_t promised = rows.value_or(promised_);
        if (sections_[section_].layout.salvage) {
            cut_off_ += promised > rows_ ? promised - rows_ : 0;
            return {};
        }
        if (rows && rows_ > *rows)
            return rejected(file_->path().string(),
                            fmt::format("has {} rows, its header promises {} points", rows_, *rows));
        if (rows_ >= promised) return {};
        return rejected(file_->path().string(),
                        fmt::format("ends early: {} of {} points are missing", promised - rows_, promised));
    }

    /// Reads the next lines and parses them on all cores. Returns false at the end of the last section.
    Result<bool> parse_window() {
        while (at_ >= sections_[section_].end && carried_ == 0) {
            LUCARNE_TRY(end_section());
            if (section_ + 1 == sections_.size()) return false;
            ++section_;
            begin_section();
        }
        LUCARNE_TRY(fill_window());
        const RowLayout& layout = sections_[section_].layout;
        std::array<size_t, kPieces + 1> cuts{};
        for (size_t i = 1; i < kPieces; ++i) {
            const size_t from = std::max(cuts[i - 1], lines_bytes_ / kPieces * i);
            const auto* end = static_cast<const char*>(
                std::memchr(text_.data() + from, layout.line_end, lines_bytes_ - from));
            cuts[i] = end ? static_cast<size_t>(end - text_.data()) + 1 : lines_bytes_;
        }
        cuts[kPieces] = lines_bytes_;
        parallel_ranges(kPieces, 1, [&](size_t i, size_t) {
            Piece& piece = pieces_[i];
            piece.points = piece.dropped = piece.lines = piece.promised = piece.missed = piece.bad = 0;
            piece.ends_in_point = false;
            piece.problem.clear();
            if (cuts[i] == cuts[i + 1]) return;
            const std::span<char> text(&text_[cuts[i]], cuts[i + 1] - cuts[i]);
            if (layout.decimal_comma) std::ranges::replace(text, ',', '.');
            parse_rows(layout, {text.data(), text.size()}, piece);
        });
        next_ = taken_ = 0;
        if (layout.salvage && open_end_) distrust_last();
        return true;
    }

    /// Called when the file ends within a line. If rows are missing after it, drops its point, because its
    /// last number may be cut off.
    void distrust_last() {
        uint64_t rows = rows_, promised = promised_;
        Piece* last = nullptr;
        for (Piece& piece : pieces_) {
            rows += rows_of(piece);
            promised += std::min(piece.promised, std::numeric_limits<uint64_t>::max() - promised);
            if (piece.lines > 0) last = &piece;
        }
        if (last && last->ends_in_point && rows < sections_[section_].rows.value_or(promised)) --last->points;
    }

    /// Fills text_ with whole lines, `lines_bytes_` bytes in all; the unfinished rest after them is carried
    /// over.
    Result<void> fill_window() {
        const Section& section = sections_[section_];
        text_.erase(0, lines_bytes_);
        if (text_.size() != carried_) text_.resize(carried_);
        const auto wanted = static_cast<size_t>(std::min<uint64_t>(kPieces * kReadBytes, section.end - at_));
        text_.resize(carried_ + wanted);
        LUCARNE_ASSIGN(
            const size_t got,
            file_->read_some(at_, std::as_writable_bytes(std::span(text_)).subspan(carried_, wanted)));
        if (got < wanted) return failed(file_->path().string(), "became shorter while it was read");
        at_ += got;
        open_end_ = at_ >= section.end && text_.back() != section.layout.line_end;
        if (open_end_) text_ += section.layout.line_end;
        const size_t last = text_.rfind(section.layout.line_end);
        lines_bytes_ = last == std::string::npos ? 0 : last + 1;
        carried_ = text_.size() - lines_bytes_;
        if (carried_ > kLongestLine) return rejected(file_->path().string(), "has a line of more than 1 MiB");
        return {};
    }

    std::shared_ptr<const ByteSource> file_;
    const std::vector<Section>& sections_;
    size_t section_ = 0;
    uint64_t at_ = 0;  ///< in the file: what is read next
    uint64_t line_ = 1, rows_ = 0, promised_ = 0;
    uint64_t dropped_ = 0, missed_ = 0, bad_ = 0, cut_off_ = 0;
    bool open_end_ = false;  ///< the last line has no end
    std::string text_;
    size_t lines_bytes_ = 0, carried_ = 0;
    std::vector<Piece> pieces_;
    size_t next_;       ///< the piece to return next
    size_t taken_ = 0;  ///< number of its points already returned
};

}  // namespace

void parse_rows(const RowLayout& layout, std::string_view text, Piece& piece) {
    RowParser(layout, text, piece).parse();
}

std::unique_ptr<PointReader> read_rows(std::shared_ptr<const ByteSource> file,
                                       const std::vector<Section>& sections) {
    return std::make_unique<RowReader>(std::move(file), sections);
}

}  // namespace lucarne::io::text
