#include "io/formats/ply/values.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "io/core/counted.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::ply {
namespace {

double native_value(ScalarType type, const std::byte* at, bool big_endian) {
    const size_t bytes = scalar_bytes(type);
    std::array<std::byte, 8> native{};
    for (size_t i = 0; i < bytes; ++i) native[i] = at[big_endian ? bytes - 1 - i : i];
    return scalar_at(type, native.data());
}

/// Reads the length of a list, 0 or more.
Result<uint64_t> list_length(BufferedInput& input, ScalarType type, bool big_endian) {
    LUCARNE_ASSIGN(const std::byte* at, take(input, scalar_bytes(type)));
    const double length = native_value(type, at, big_endian);
    if (length < 0) return rejected(input.path(), "has a list of negative length");
    return static_cast<uint64_t>(length);
}

Result<void> read_binary(BufferedInput& input, const Element& element, bool big_endian, uint64_t number,
                         Entry& entry) {
    for (const auto& p : element.properties) {
        uint64_t count = 1;
        if (p.count) {
            auto length = list_length(input, *p.count, big_endian);
            if (!length && input.at_end()) return ends_early(input, element, number);
            LUCARNE_ASSIGN(count, std::move(length));
            if (count > kMostListed)
                return rejected(input.path(), fmt::format("has a list of {} values", count));
        }
        for (uint64_t i = 0; i < count; ++i) {
            auto got = take(input, scalar_bytes(p.type));
            if (!got && input.at_end()) return ends_early(input, element, number);
            LUCARNE_ASSIGN(const std::byte* at, std::move(got));
            entry.values.push_back(native_value(p.type, at, big_endian));
        }
        entry.begin.push_back(entry.values.size());
    }
    return {};
}

Result<void> read_words(BufferedInput& input, const Header& header, const Element& element, uint64_t number,
                        Entry& entry) {
    LUCARNE_ASSIGN(std::string_view line, text_line(input, header, element, number));
    const auto value = [&](ScalarType type, const Property& p) -> Result<double> {
        const auto word = next_word(line);
        std::array<std::byte, 8> native{};
        if (!parse_scalar(type, word, native.data())) return bad_word(input, element, number, p.name, word);
        return scalar_at(type, native.data());
    };
    for (const auto& p : element.properties) {
        double count = 1;
        if (p.count) {
            LUCARNE_ASSIGN(count, value(*p.count, p));
        }
        // The line may end before the list has as many values as it promises.
        for (double i = 0; i < count; ++i) {
            LUCARNE_ASSIGN(const double v, value(p.type, p));
            entry.values.push_back(v);
        }
        entry.begin.push_back(entry.values.size());
    }
    if (!next_word(line).empty())
        return rejected(input.path(), fmt::format("{} {} has more values than the header names",
                                                  printable(element.name), number));
    return {};
}

bool promises_behind(const Header& header, const Element& element) {
    const auto& all = header.elements;
    return std::any_of(all.begin() + (&element - all.data()) + 1, all.end(),
                       [](const Element& e) { return e.count > 0 && !e.properties.empty(); });
}

}  // namespace

Result<const std::byte*> take(BufferedInput& input, size_t bytes) {
    LUCARNE_ASSIGN(const auto got, input.peek(bytes));
    input.skip(std::min(bytes, got.size()));
    if (got.size() < bytes)
        return rejected(input.path(), fmt::format("ends early, at {} bytes", input.position()));
    return got.data();
}

Result<void> walk_entry(BufferedInput& input, const Element& element, bool big_endian, std::byte* packed) {
    for (const auto& p : element.properties) {
        if (p.count) {
            LUCARNE_ASSIGN(const uint64_t length, list_length(input, *p.count, big_endian));
            LUCARNE_TRY(input.skip_far(length * scalar_bytes(p.type)));
            continue;
        }
        LUCARNE_ASSIGN(const std::byte* at, take(input, scalar_bytes(p.type)));
        if (!packed) continue;
        std::memcpy(packed, at, scalar_bytes(p.type));
        packed += scalar_bytes(p.type);
    }
    return {};
}

Result<std::string_view> text_line(BufferedInput& input, const Header& header, const Element& element,
                                   uint64_t number) {
    for (;;) {
        LUCARNE_ASSIGN(const auto line, input.line(header.line_end));
        if (!line) return ends_early(input, element, number);
        if (!std::all_of(line->begin(), line->end(), is_blank)) return *line;
    }
}

Result<void> skip_element(BufferedInput& input, const Header& header, const Element& element) {
    if (element.properties.empty()) return {};
    if (header.encoding != Encoding::ascii && !element.has_list()) {
        if (element.count > (uint64_t{1} << 63) / element.record_bytes())
            return rejected(input.path(),
                            fmt::format("cannot hold its {} entries of '{}'", element.count, element.name));
        return input.skip_far(element.count * element.record_bytes());
    }
    for (uint64_t i = 0; i < element.count; ++i) {
        if (header.encoding == Encoding::ascii)
            LUCARNE_TRY(text_line(input, header, element, i + 1));
        else
            LUCARNE_TRY(walk_entry(input, element, header.encoding == Encoding::big_endian, nullptr));
    }
    return {};
}

bool parse_scalar(ScalarType type, std::string_view word, std::byte* at) {
    const auto put = [&]<class T>(std::optional<T> value) {
        if (value) store(at, *value);
        return value.has_value();
    };
    switch (type) {
        case ScalarType::f32:
            return put(parse_number<float>(word));
        case ScalarType::f64:
            return put(parse_number<double>(word));
        default:
            break;
    }
    // Whole numbers are sometimes written as 255.0. All PLY integers are exact in a double.
    const auto value = parse_number<double>(word);
    if (!value || !(std::abs(*value) < 0x1p33) || *value != std::trunc(*value)) return false;
    const auto whole = static_cast<int64_t>(*value);
    const int64_t range = int64_t{1} << (8 * scalar_bytes(type));
    const bool is_signed = type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32;
    if (whole >= (type == ScalarType::i8 || !is_signed ? range : range / 2) ||
        whole < (is_signed ? -range / 2 : 0))
        return false;
    std::memcpy(at, &whole, scalar_bytes(type));  // little-endian: the low bytes come first
    return true;
}

Result<void> read_entry(BufferedInput& input, const Header& header, const Element& element, uint64_t number,
                        Entry& entry) {
    entry.values.clear();
    entry.begin.assign(1, 0);
    if (header.encoding == Encoding::ascii) return read_words(input, header, element, number, entry);
    return read_binary(input, element, header.encoding == Encoding::big_endian, number, entry);
}

tl::unexpected<Error> ends_early(const BufferedInput& input, const Element& element, uint64_t number) {
    const std::string name = printable(element.name);
    const std::string promised = name == "vertex" ? "points"
                                 : name == "face" ? "faces"
                                                  : fmt::format("entries of '{}'", name);
    return rejected(input.path(),
                    fmt::format("ends early: its header promises {}, {} {} there",
                                counted(element.count, promised), number - 1, number == 2 ? "is" : "are"));
}

tl::unexpected<Error> bad_word(const BufferedInput& input, const Element& element, uint64_t number,
                               std::string_view property, std::string_view word) {
    if (input.open_line()) return ends_early(input, element, number);
    const std::string entry = fmt::format("{} {}", printable(element.name), number), of = printable(property);
    if (word.empty())
        return rejected(input.path(), fmt::format("{} has no value for its property {}", entry, of));
    return rejected(input.path(), fmt::format("{} has '{}' for its property {}", entry, printable(word), of));
}

Result<Fate> fate_of(Result<void> done, const BufferedInput& input, const Header& header,
                     const Element& element, uint64_t begin, uint64_t left, bool salvage) {
    if (!done && (!salvage || done.error().kind != ErrorKind::input_rejected))
        return tl::unexpected(std::move(done).error());
    const bool text = header.encoding == Encoding::ascii;
    // If entries are missing after an unfinished last line, that line may be cut off within its last number.
    const bool cut = salvage && text && input.open_line() && (left > 1 || promises_behind(header, element));
    if (done && !cut) return Fate::kept;
    return text && !input.at_end() && input.position() > begin ? Fate::lost : Fate::rest_lost;
}

}  // namespace lucarne::io::ply
