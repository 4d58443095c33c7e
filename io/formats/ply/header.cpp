#include "io/formats/ply/header.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/buffered_input.h"
#include "io/formats/common/format.h"
#include "io/formats/common/stations.h"
#include "io/formats/common/text.h"

namespace lucarne::io::ply {
namespace {

constexpr size_t kMostHeaderBytes = size_t{1} << 20;
constexpr size_t kMostElements = 256, kMostProperties = 1024;

struct TypeWords {
    ScalarType type;
    std::string_view word, sized;
};
constexpr std::array<TypeWords, 8> kTypes = {{{ScalarType::i8, "char", "int8"},
                                              {ScalarType::u8, "uchar", "uint8"},
                                              {ScalarType::i16, "short", "int16"},
                                              {ScalarType::u16, "ushort", "uint16"},
                                              {ScalarType::i32, "int", "int32"},
                                              {ScalarType::u32, "uint", "uint32"},
                                              {ScalarType::f32, "float", "float32"},
                                              {ScalarType::f64, "double", "float64"}}};

class HeaderParser {
 public:
    HeaderParser(const std::shared_ptr<const ByteSource>& file, bool salvage)
        : name_(file->path().string()),
          salvage_(salvage),
          size_(file->size()),
          input_(file, 0, std::min<uint64_t>(size_, kMostHeaderBytes)) {}

    Result<Header> parse() {
        LUCARNE_TRY(find_line_end());
        bool format_known = false;
        for (size_t number = 1;; ++number) {
            LUCARNE_ASSIGN(auto line, input_.line(header_.line_end));
            if (!line) return rejected(name_, "ends inside its PLY header, or the header is over 1 MiB");
            std::string_view rest = *line;
            if (number > 1) line_feed_first_ = line_feed_first_ && rest.starts_with('\r');
            const std::string word = lower(next_word(rest));
            if (number == 1 || word.empty()) continue;  // "ply", checked before
            if (word == "end_header") break;
            if (word == "comment" || word == "obj_info") {
                (word == "comment" ? header_.comments : header_.infos).push_back(std::string(trimmed(rest)));
                continue;
            }
            Result<void> understood;
            if (word == "format") {
                understood = format(rest);
                format_known = true;
            } else if (word == "element") {
                understood = element(rest);
            } else if (word == "property") {
                understood = property(rest);
            } else {
                understood = wrong(fmt::format("the word '{}' is not known", printable(word)));
            }
            if (!understood)
                return rejected(name_,
                                fmt::format("line {} of its PLY header: {}", number, understood.error().why));
        }
        if (!format_known) return rejected(name_, "has a PLY header without a format line");
        LUCARNE_TRY(end_last_line());
        header_.data_offset = input_.position();
        LUCARNE_TRY(find_vertex());
        return std::move(header_);
    }

 private:
    static tl::unexpected<Error> wrong(std::string why) { return rejected("", std::move(why)); }
    Result<void> find_line_end() {
        LUCARNE_ASSIGN(const auto head, input_.peek(64));
        const auto at = std::find_if(head.begin(), head.end(), [](std::byte b) {
            return b == std::byte{'\n'} || b == std::byte{'\r'};
        });
        const bool carriage_only =
            at != head.end() && *at == std::byte{'\r'} && (at + 1 == head.end() || at[1] != std::byte{'\n'});
        header_.line_end = carriage_only ? '\r' : '\n';
        return {};
    }

    /// Where lines end in LF CR, the last CR is not part of the body.
    Result<void> end_last_line() {
        LUCARNE_ASSIGN(const auto next, input_.peek(1));
        if (line_feed_first_ && header_.line_end == '\n' && !next.empty() && next[0] == std::byte{'\r'})
            input_.skip(1);
        return {};
    }

    Result<void> format(std::string_view rest) {
        const std::string word = lower(next_word(rest));
        const auto version = next_word(rest);
        if (word == "ascii")
            header_.encoding = Encoding::ascii;
        else if (word == "binary_little_endian")
            header_.encoding = Encoding::little_endian;
        else if (word == "binary_big_endian")
            header_.encoding = Encoding::big_endian;
        else
            return wrong(fmt::format("the format '{}' is not known", word));
        if (version != "1.0") return wrong(fmt::format("version '{}' is not known", version));
        return {};
    }

    Result<void> element(std::string_view rest) {
        Element e;
        e.name = std::string(next_word(rest));
        for (const std::string_view known : {"vertex", "face"})
            if (same_letters(e.name, known)) e.name = known;
        const auto count = parse_number<uint64_t>(next_word(rest));
        if (e.name.empty() || !count) return wrong("an element needs a name and a count");
        if (header_.elements.size() == kMostElements) return wrong("there are too many elements");
        // Every entry has at least one byte.
        if (*count > size_ && !salvage_)
            return wrong(
                fmt::format("{} entries of '{}' are promised in a file of {} bytes", *count, e.name, size_));
        e.count = *count;
        header_.elements.push_back(std::move(e));
        return {};
    }

    Result<void> property(std::string_view rest) {
        if (header_.elements.empty()) return wrong("a property stands before the first element");
        auto& properties = header_.elements.back().properties;
        if (properties.size() == kMostProperties) return wrong("the element has too many properties");
        Property p;
        std::string word = lower(next_word(rest));
        if (word == "list") {
            p.count = type_of(lower(next_word(rest)));
            if (!p.count || *p.count == ScalarType::f32 || *p.count == ScalarType::f64)
                return wrong("a list needs an integer type for its length");
            word = lower(next_word(rest));
        }
        const auto type = type_of(word);
        if (!type) return wrong(fmt::format("the type '{}' is not known", word));
        p.type = *type;
        p.name = std::string(next_word(rest));
        if (p.name.empty()) return wrong("a property needs a name");
        if (std::any_of(properties.begin(), properties.end(),
                        [&](const Property& other) { return other.name == p.name; }))
            return wrong(fmt::format("the property '{}' is named twice", p.name));
        properties.push_back(std::move(p));
        return {};
    }

    Result<void> find_vertex() {
        const auto is_vertex = [](const Element& e) { return e.name == "vertex"; };
        const auto& all = header_.elements;
        const auto count = std::count_if(all.begin(), all.end(), is_vertex);
        if (count != 1)
            return rejected(
                name_, count == 0 ? "has no vertex element, so no points" : "has several vertex elements");
        const auto found = std::find_if(all.begin(), all.end(), is_vertex);
        header_.vertex = static_cast<size_t>(found - all.begin());
        const bool packed = std::ranges::any_of(
            found->properties, [](const Property& p) { return p.name == "packed_position"; });
        for (const std::string_view axis : {"x", "y"})
            if (!packed &&
                std::none_of(found->properties.begin(), found->properties.end(),
                             [&](const Property& p) { return same_letters(p.name, axis) && !p.count; }))
                return rejected(name_, fmt::format("has vertices without a property {}", axis));
        return {};
    }

    std::string name_;
    bool salvage_;
    uint64_t size_;
    BufferedInput input_;
    bool line_feed_first_ = true;  ///< every line but the first begins with the CR of the line before
    Header header_;
};

}  // namespace

bool Element::has_list() const {
    return std::any_of(properties.begin(), properties.end(),
                       [](const Property& p) { return p.count.has_value(); });
}

uint64_t Element::record_bytes() const {
    uint64_t bytes = 0;
    for (const Property& p : properties) bytes += scalar_bytes(p.type);
    return bytes;
}

Result<Header> read_header(const std::shared_ptr<const ByteSource>& file, bool salvage) {
    return HeaderParser(file, salvage).parse();
}

std::optional<ScalarType> type_of(std::string_view word) {
    for (const auto& t : kTypes)
        if (word == t.word || word == t.sized) return t.type;
    return std::nullopt;
}

std::string_view word_of(ScalarType type) {
    for (const auto& t : kTypes)
        if (type == t.type) return t.word;
    return {};
}

PlyNotes notes_of(const Header& header) {
    PlyNotes notes{{}, header.comments, header.infos};
    for (const Property& p : header.vertices().properties)
        if (!p.count && !p.name.empty()) notes.properties.push_back({p.name, p.type});
    return notes;
}

}  // namespace lucarne::io::ply
