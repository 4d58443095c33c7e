#include "io/formats/text/sample.h"

#include <algorithm>
#include <cmath>

#include "io/formats/common/text.h"

namespace lucarne::io::text {
namespace {

constexpr uint64_t kPlaces = 64, kPlaceBytes = uint64_t{64} << 10;
constexpr uint64_t kRowsKept = 16384;

class Sampler {
 public:
    /// The beginnings of two kept rows are at least `step` bytes apart.
    Sampler(const RowLayout& layout, size_t columns, uint64_t step) : layout_(layout), step_(step) {
        sample_.columns = columns;
    }

    /// Looks at whole lines.
    void look(std::string_view text) {
        uint64_t next = 0, at = 0;
        while (!text.empty()) {
            const size_t end = text.find(layout_.line_end);
            auto line = text.substr(0, end);
            const uint64_t begin = at;
            const size_t length = end == text.npos ? text.size() : end + 1;
            text.remove_prefix(length);
            at += length;
            while (!line.empty() && is_padding(line.front(), layout_.separator)) line.remove_prefix(1);
            if (line.empty() || is_comment(line)) continue;
            ++rows_;
            if (begin < next) continue;
            next += step_;
            auto cells = split(line, layout_.separator);
            while (!line.empty() && is_padding(line.back(), layout_.separator)) line.remove_suffix(1);
            const bool open = layout_.separator != ' ' && line.ends_with(layout_.separator);
            if (open && cells.size() + 1 == sample_.columns) cells.emplace_back();  // the last cell is empty
            keep(cells);
        }
    }

    uint64_t rows() const { return rows_; }
    Sample take() {
        const size_t columns = sample_.columns, rows = sample_.rows();
        std::vector<uint64_t> words(columns);
        for (size_t i = 0; i < words_.size(); ++i) words[i % columns] += words_[i];
        for (const uint64_t count : words) sample_.words.push_back(100 * count > rows);
        // A row with a word in a column of numbers does not show what the other rows are like.
        size_t kept = 0;
        for (size_t row = 0; row < rows; ++row) {
            bool stray = false;
            for (size_t c = 0; c < columns; ++c)
                stray = stray || (words_[row * columns + c] && !sample_.words[c]);
            if (stray) continue;
            if (kept < row)
                std::copy_n(&sample_.values[row * columns], columns, &sample_.values[kept * columns]);
            ++kept;
        }
        if (kept > 0) sample_.values.resize(kept * columns);
        return std::move(sample_);
    }

 private:
    void keep(const std::vector<std::string_view>& cells) {
        if (cells.size() != sample_.columns) {
            rows_ -= layout_.has_counts && cells.size() == 1;
            return;
        }
        for (size_t c = 0; c < cells.size(); ++c) {
            const auto value = cell_number(cells[c]);
            if (sample_.no_number.empty() && says_no_number(unquoted(cells[c]))) sample_.no_number = cells[c];
            words_.push_back(!value && !cells[c].empty());
            sample_.values.push_back(value.value_or(NAN));
        }
    }

    const RowLayout& layout_;
    uint64_t step_, rows_ = 0;
    std::vector<bool> words_;  ///< for each value: it is a word and no number
    Sample sample_;
};

}  // namespace

Result<Sampled> take_sample(const ByteSource& file, uint64_t begin, uint64_t end, const RowLayout& layout,
                            size_t columns) {
    const uint64_t bytes = end - begin;
    const bool whole = bytes <= kPlaces * kPlaceBytes;
    const uint64_t places = whole ? 1 : kPlaces, place_bytes = whole ? bytes : kPlaceBytes;
    Sampler sampler(layout, columns, whole ? 0 : places * place_bytes / kRowsKept + 1);
    std::string text;
    uint64_t looked_at = 0;
    for (uint64_t place = 0; place < places; ++place) {
        const uint64_t at = begin + (bytes / places) * place;
        text.resize(static_cast<size_t>(place_bytes));
        LUCARNE_TRY(file.read_at(at, std::as_writable_bytes(std::span(text))));
        if (layout.decimal_comma) std::ranges::replace(text, ',', '.');
        std::string_view lines = text;
        if (place > 0) lines.remove_prefix(std::min(lines.find(layout.line_end), lines.size() - 1) + 1);
        if (!whole) lines = lines.substr(0, lines.rfind(layout.line_end) + 1);
        looked_at += lines.size();
        sampler.look(lines);
    }
    Sampled sampled;
    const double share = static_cast<double>(bytes) / static_cast<double>(std::max<uint64_t>(1, looked_at));
    sampled.rows =
        whole ? sampler.rows() : static_cast<uint64_t>(static_cast<double>(sampler.rows()) * share);
    sampled.sample = sampler.take();
    sampled.sample.whole = whole;
    return sampled;
}

}  // namespace lucarne::io::text
