#include "io/files/json.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/core/terminal.h"
#include "io/files/file.h"

namespace lucarne {
namespace {

constexpr uint64_t kLargestFile = uint64_t{16} << 20;
constexpr int kDeepest = 100;  ///< objects and arrays inside each other; copies and texts of values recurse

/// Finds the place where a text stops being JSON; the library's exceptions do not always tell.
class MistakeFinder final : public nlohmann::json::json_sax_t {
 public:
    explicit MistakeFinder(std::string_view text) : text_(text) {}
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(int64_t) override { return true; }
    bool number_unsigned(uint64_t) override { return true; }
    bool number_float(double, const std::string&) override { return true; }
    bool string(std::string&) override { return true; }
    bool binary(nlohmann::json::binary_t&) override { return true; }
    bool start_object(size_t) override { return true; }
    bool key(std::string&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(size_t position, const std::string& token,
                     const nlohmann::json::exception& error) override {
        constexpr size_t kMostQuoted = 40;
        constexpr std::string_view kExpected = "; expected ";  // what the library's reason ends with
        const bool too_large = dynamic_cast<const nlohmann::json::out_of_range*>(&error) != nullptr;
        const std::string found = shown(token, kMostQuoted);
        const std::string_view reason = error.what();
        const size_t expected = reason.rfind(kExpected);
        at_ = std::min(text_.size(), position - std::min(position, too_large ? token.size() : 1));
        if (too_large)
            why_ = fmt::format("the number {} is too large", found);
        else if (position > text_.size())
            why_ = "the text ends early";
        else if (expected != reason.npos)
            why_ = fmt::format("{} is expected, not {}",
                               shown(reason.substr(expected + kExpected.size()), kMostQuoted), found);
        else
            why_ = fmt::format("{} is not JSON", found);
        return false;
    }

    std::string reason() const {
        const std::string_view before = text_.substr(0, at_);
        const size_t start = before.rfind('\n');
        return fmt::format("line {}, column {}: {}", 1 + std::ranges::count(before, '\n'),
                           before.size() - (start == before.npos ? 0 : start + 1) + 1, why_);
    }

 private:
    std::string_view text_;
    size_t at_ = 0;
    std::string why_ = "is not JSON";
};

bool too_deep(std::string_view text) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') quoted = !quoted;
        if (quoted) {
            if (c == '\\') ++i;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest) return true;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return false;
}

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text, const std::string& name) {
    if (too_deep(text)) return rejected(name, fmt::format("is nested more than {} levels deep", kDeepest));
    auto parsed = nlohmann::json::parse(text, nullptr, false);
    if (!parsed.is_discarded()) return parsed;
    MistakeFinder finder(text);
    nlohmann::json::sax_parse(text, &finder);
    return rejected(name, finder.reason(), "correct the JSON there");
}

Result<std::string> load_text(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const InputFile file, InputFile::open(path));
    if (file.size() > kLargestFile)
        return rejected(path.string(), "is larger than 16 MiB", "give a JSON file written for Lucarne");
    std::string text(file.size(), '\0');
    LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(text))));
    return text;
}

Result<nlohmann::json> load_json(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const std::string text, load_text(path));
    return parse_json(text, path.string());
}

Result<JsonObject> JsonObject::of(const nlohmann::json& value, std::string name, std::string pointer) {
    JsonObject object(value, std::move(name), std::move(pointer));
    if (!value.is_object()) return object.wrong(fmt::format("must be an object, not {}", value.type_name()));
    return object;
}

bool JsonObject::has(std::string_view key) const {
    return value_->contains(key);
}

const nlohmann::json* JsonObject::take(std::string_view key) {
    taken_.emplace_back(key);
    const auto found = value_->find(key);
    return found == value_->end() ? nullptr : &*found;
}

std::string JsonObject::pointer_to(std::string_view key) const {
    std::string pointer = pointer_ + "/";
    for (const char c : key) pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);  // RFC 6901
    return pointer;
}

tl::unexpected<Error> JsonObject::wrong(std::string why, std::string_view key) const {
    const std::string place = key.empty() ? pointer_ : pointer_to(key);
    return rejected(name_, fmt::format("{}: {}", place.empty() ? "the whole document" : place, why),
                    "see data/README.md");
}

tl::unexpected<Error> JsonObject::wrong_or_missing(std::string_view key, std::string_view expected) const {
    const auto found = value_->find(key);
    if (found == value_->end()) return wrong(fmt::format("the key '{}' is missing", key));
    return wrong(fmt::format("must be {}, not {}", expected, found->dump().substr(0, 60)), key);
}

Result<double> JsonObject::number(std::string_view key, JsonRange range, std::optional<double> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    if (value && value->is_number()) {
        const double number = value->get<double>();
        if (std::isfinite(number) && number >= range.least && number <= range.most) return number;
    }
    return wrong_or_missing(key, range.least > -1e300 || range.most < 1e300
                                     ? fmt::format("a number from {} to {}", range.least, range.most)
                                     : "a number");
}

Result<int64_t> JsonObject::integer(std::string_view key, int64_t least, int64_t most,
                                    std::optional<int64_t> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    const bool fits = value && value->is_number_integer() &&
                      (!value->is_number_unsigned() || value->get<uint64_t>() <= uint64_t{INT64_MAX});
    if (fits && value->get<int64_t>() >= least && value->get<int64_t>() <= most) return value->get<int64_t>();
    return wrong_or_missing(key, fmt::format("an integer from {} to {}", least, most));
}

Result<std::string> JsonObject::text(std::string_view key, std::optional<std::string> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    if (value && value->is_string()) return value->get<std::string>();
    return wrong_or_missing(key, "a text");
}

Result<bool> JsonObject::boolean(std::string_view key, std::optional<bool> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    if (value && value->is_boolean()) return value->get<bool>();
    return wrong_or_missing(key, "true or false");
}

Result<glm::dvec3> JsonObject::vector(std::string_view key, JsonRange range,
                                      std::optional<glm::dvec3> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    if (!value || !value->is_array() || value->size() != 3)
        return wrong_or_missing(key, "three numbers [x, y, z]");
    glm::dvec3 vector(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const nlohmann::json& component = (*value)[static_cast<size_t>(axis)];
        const double number = component.is_number() ? component.get<double>() : NAN;
        if (!(number >= range.least && number <= range.most))
            return wrong_or_missing(key,
                                    range.least > -1e300 || range.most < 1e300
                                        ? fmt::format("three numbers from {} to {}", range.least, range.most)
                                        : "three numbers [x, y, z]");
        vector[axis] = number;
    }
    return vector;
}

Result<size_t> JsonObject::choice(std::string_view key, const std::vector<std::string_view>& choices,
                                  std::optional<size_t> otherwise) {
    const nlohmann::json* value = take(key);
    if (!value && otherwise) return *otherwise;
    if (value && value->is_string())
        for (size_t i = 0; i < choices.size(); ++i)
            if (choices[i] == value->get_ref<const std::string&>()) return i;
    return wrong_or_missing(key, fmt::format("one of {}", fmt::join(choices, ", ")));
}

Result<std::vector<int64_t>> JsonObject::integers(std::string_view key, int64_t least, int64_t most,
                                                  size_t most_of_them) {
    std::vector<int64_t> numbers;
    const nlohmann::json* value = take(key);
    if (!value) return numbers;
    if (!value->is_array() || value->size() > most_of_them)
        return wrong(fmt::format("must be an array of at most {} integers", most_of_them), key);
    for (const nlohmann::json& element : *value) {
        // The parser turns whole numbers beyond 64 bits into floats.
        const bool whole = element.is_number_integer();
        const auto number = whole ? element.get<int64_t>() : int64_t{0};
        if (!whole || number < least || number > most)
            return wrong(fmt::format("must hold integers from {} to {}", least, most), key);
        numbers.push_back(number);
    }
    return numbers;
}

Result<std::vector<JsonObject>> JsonObject::objects(std::string_view key, size_t most) {
    std::vector<JsonObject> objects;
    const nlohmann::json* value = take(key);
    if (!value) return objects;
    if (!value->is_array() || value->size() > most)
        return wrong(fmt::format("must be an array of at most {} objects", most), key);
    for (size_t i = 0; i < value->size(); ++i) {
        LUCARNE_ASSIGN(JsonObject object, of((*value)[i], name_, fmt::format("{}/{}", pointer_to(key), i)));
        objects.push_back(std::move(object));
    }
    return objects;
}

Result<std::optional<JsonObject>> JsonObject::object(std::string_view key) {
    const nlohmann::json* value = take(key);
    if (!value) return std::nullopt;
    LUCARNE_ASSIGN(JsonObject object, of(*value, name_, pointer_to(key)));
    return std::optional(std::move(object));
}

Result<void> JsonObject::finish() const {
    for (const auto& [key, value] : value_->items())
        if (std::ranges::find(taken_, key) == taken_.end())
            return wrong(fmt::format("is not a known key; known here are: {}", fmt::join(taken_, ", ")), key);
    return {};
}

}  // namespace lucarne
