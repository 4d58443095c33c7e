#include "io/formats/pcd/header.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/formats/common/buffered_input.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::pcd {
namespace {

constexpr uint64_t kMostHeader = uint64_t{1} << 20;
constexpr size_t kMostFields = 256;
constexpr uint64_t kMostValues = 4096;  ///< in one point

std::optional<ScalarType> type_of(char letter, uint32_t size) {
    switch (letter << 8 | static_cast<int>(size)) {
        case 'U' << 8 | 1:
            return ScalarType::u8;
        case 'U' << 8 | 2:
            return ScalarType::u16;
        case 'U' << 8 | 4:
            return ScalarType::u32;
        case 'U' << 8 | 8:
            return ScalarType::u64;
        case 'I' << 8 | 1:
            return ScalarType::i8;
        case 'I' << 8 | 2:
            return ScalarType::i16;
        case 'I' << 8 | 4:
            return ScalarType::i32;
        case 'I' << 8 | 8:
            return ScalarType::i64;
        case 'F' << 8 | 4:
            return ScalarType::f32;
        case 'F' << 8 | 8:
            return ScalarType::f64;
        default:
            return std::nullopt;
    }
}

/// Converts to upper case, which the format requires for entries and types; some writers use lower case.
std::string upper(std::string_view word) {
    std::string result(word);
    for (char& c : result)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return result;
}

class HeaderParser {
 public:
    explicit HeaderParser(const std::shared_ptr<const ByteSource>& file)
        : input_(file, 0, std::min(file->size(), kMostHeader)) {}

    Result<Header> parse() {
        LUCARNE_TRY(input_.skip_mark());
        while (!encoding_) {
            LUCARNE_ASSIGN(const auto line, input_.line('\n'));
            if (!line) return wrong("ends without a DATA line");
            ++header_.data_line;
            std::string_view rest = *line;
            if (header_.data_line > 2) line_feed_first_ = line_feed_first_ && rest.starts_with('\r');
            while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
            if (rest.starts_with('#')) {
                rest.remove_prefix(std::min(rest.find_first_not_of("# "), rest.size()));
                while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
                header_.comments.emplace_back(rest);
                continue;
            }
            const std::string key = upper(next_word(rest));
            if (key.empty()) continue;
            LUCARNE_TRY(entry(key, rest));
        }
        // Where lines end in LF CR, the last CR is not part of the body.
        LUCARNE_ASSIGN(const auto next, input_.peek(1));
        if (line_feed_first_ && !next.empty() && next[0] == std::byte{'\r'}) input_.skip(1);
        header_.data_offset = input_.position();
        LUCARNE_TRY(make_fields());
        LUCARNE_TRY(check_counts());
        return std::move(header_);
    }

 private:
    tl::unexpected<Error> wrong(std::string why) const {
        return rejected(input_.path(), "its PCD header " + std::move(why));
    }

    static std::vector<std::string_view> words_of(std::string_view rest) {
        std::vector<std::string_view> words;
        for (auto word = next_word(rest); !word.empty() && words.size() <= kMostFields;
             word = next_word(rest))
            words.push_back(word);
        return words;
    }

    Result<void> entry(std::string_view key, std::string_view rest) {
        const auto words = words_of(rest);
        if (key == "FIELDS" || key == "COLUMNS") {
            names_.assign(words.begin(), words.end());
        } else if (key == "TYPE") {
            letters_.clear();
            for (const auto word : words) letters_ += word.size() == 1 ? upper(word)[0] : '?';
        } else if (key == "SIZE" || key == "COUNT") {
            auto& numbers = key == "SIZE" ? sizes_ : counts_;
            numbers.clear();
            for (const auto word : words) {
                const auto number = parse_number<uint32_t>(word);
                if (!number) return wrong(fmt::format("has '{}' for a {}", printable(word), key));
                numbers.push_back(*number);
            }
        } else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
            const auto number = words.size() == 1 ? parse_number<uint64_t>(words[0]) : std::nullopt;
            if (!number) return wrong(fmt::format("has no whole number for {}", key));
            (key == "WIDTH" ? width_ : key == "HEIGHT" ? height_ : points_) = *number;
        } else if (key == "VIEWPOINT") {
            if (words.size() != 7) return wrong("has a VIEWPOINT without seven numbers");
            for (size_t i = 0; i < 7; ++i) {
                const auto number = parse_number<double>(words[i]);
                if (!number || !usable(*number)) return wrong("has a VIEWPOINT without seven numbers");
                header_.viewpoint[i] = *number;
            }
        } else if (key == "DATA") {
            const auto word = words.size() == 1 ? words[0] : std::string_view();
            if (same_letters(word, "ascii")) encoding_ = Encoding::ascii;
            if (same_letters(word, "binary")) encoding_ = Encoding::binary;
            if (same_letters(word, "binary_compressed")) encoding_ = Encoding::compressed;
            if (!encoding_) return wrong(fmt::format("has unknown DATA '{}'", printable(word)));
        } else if (key != "VERSION") {
            return wrong(fmt::format("has an unknown entry '{}'", printable(key)));
        }
        return {};
    }

    Result<void> make_fields() {
        header_.encoding = *encoding_;
        if (names_.empty()) return wrong("names no FIELDS");
        if (names_.size() > kMostFields) return wrong(fmt::format("has more than {} fields", kMostFields));
        if (sizes_.size() != names_.size() || letters_.size() != names_.size() ||
            (!counts_.empty() && counts_.size() != names_.size()))
            return wrong("has FIELDS, SIZE, TYPE and COUNT of different lengths");
        uint64_t values = 0;
        for (size_t i = 0; i < names_.size(); ++i) {
            const auto type = type_of(letters_[i], sizes_[i]);
            const uint32_t count = counts_.empty() ? 1 : counts_[i];
            if (!type)
                return wrong(fmt::format("has a field {} of type {} and size {}", printable(names_[i]),
                                         letters_[i], sizes_[i]));
            values += count;
            if (values > kMostValues)
                return wrong(fmt::format("has more than {} values a point", kMostValues));
            header_.fields.push_back({names_[i], *type, count});
        }
        for (const std::string_view axis : {"x", "y", "z"}) {
            const size_t found = index_of_name(header_.fields, axis, &Field::name);
            if (found == header_.fields.size() || header_.fields[found].count != 1 ||
                std::ranges::count(header_.fields, header_.fields[found].name, &Field::name) != 1)
                return wrong(fmt::format("does not have one field {}", axis));
        }
        return {};
    }

    Result<void> check_counts() {
        if (!width_ && !points_) return wrong("says neither WIDTH nor POINTS");
        header_.height = height_.value_or(1);
        header_.width = width_ ? *width_ : *points_;
        const bool overflow = header_.height > 0 && header_.width > UINT64_MAX / header_.height;
        if (overflow || (width_ && points_ && header_.width * header_.height != *points_))
            return wrong(fmt::format("promises {} x {} points, and {}", header_.width, header_.height,
                                     points_.value_or(0)));
        header_.points = points_.value_or(header_.width * header_.height);
        return {};
    }

    BufferedInput input_;
    Header header_;
    std::optional<Encoding> encoding_;
    bool line_feed_first_ = true;  ///< every line but the first begins with the CR of the line before
    std::vector<std::string> names_;
    std::string letters_;
    std::vector<uint32_t> sizes_, counts_;
    std::optional<uint64_t> width_, height_, points_;
};

}  // namespace

uint64_t Header::record_bytes() const {
    uint64_t bytes = 0;
    for (const Field& field : fields) bytes += field.bytes();
    return bytes;
}

Result<Header> read_header(const std::shared_ptr<const ByteSource>& file) {
    return HeaderParser(file).parse();
}

}  // namespace lucarne::io::pcd
