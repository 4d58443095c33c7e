#include "io/formats/text/columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "io/formats/common/color_depth.h"
#include "io/formats/common/text.h"
#include "io/formats/common/units.h"

namespace lucarne::io::text {
namespace {

using Triple = std::array<std::string_view, 3>;
constexpr Triple kAxes = {"x", "y", "z"}, kColor = {"red", "green", "blue"}, kNormal = {"nx", "ny", "nz"};

struct Alias {
    std::string_view theirs, ours;
};
// In the form in which names are compared: lower case, only letters and digits.
constexpr std::array kAliases = std::to_array<Alias>({
    {"xm", "x"},
    {"ym", "y"},
    {"zm", "z"},
    {"xcoordinate", "x"},
    {"ycoordinate", "y"},
    {"zcoordinate", "z"},
    {"coordx", "x"},
    {"coordy", "y"},
    {"coordz", "z"},
    {"r", "red"},
    {"g", "green"},
    {"b", "blue"},
    {"rf", "red"},
    {"gf", "green"},
    {"bf", "blue"},
    {"colorr", "red"},
    {"colorg", "green"},
    {"colorb", "blue"},
    {"diffusered", "red"},
    {"diffusegreen", "green"},
    {"diffuseblue", "blue"},
    {"normalx", "nx"},
    {"normaly", "ny"},
    {"normalz", "nz"},
    {"rot", "red"},
    {"grn", "green"},  // Grün
    {"gruen", "green"},
    {"blau", "blue"},
    {"i", "intensity"},
    {"intensitt", "intensity"},  // Intensität
    {"intensitaet", "intensity"},
    {"scalarintensity", "intensity"},
    {"reflectance", "intensity"},
    {"amplitude", "intensity"},
    {"class", "classification"},
    {"scalarclassification", "classification"},
    {"returnnumber", "return_number"},
    {"numberofreturns", "number_of_returns"},
    {"gpstime", "gps_time"},
    {"pointsourceid", "point_source_id"},
    {"userdata", "user_data"},
    {"scandirectionflag", "scan_direction"},
    {"edgeofflightline", "edge_of_flight_line"},
    {"scananglerank", "scan_angle_rank"},
    {"infrared", "nir"},
});
// Used only for an axis that no column names directly, because these names may mean something else. Names
// that are compared have lost all non-ASCII letters: "hhe" is Höhe.
constexpr std::array kSurveyors = std::to_array<Alias>({
    {"e", "x"},          {"east", "x"},     {"easting", "x"}, {"ost", "x"},      {"ostwert", "x"},
    {"rechtswert", "x"}, {"n", "y"},        {"north", "y"},   {"northing", "y"}, {"nord", "y"},
    {"nordwert", "y"},   {"hochwert", "y"}, {"h", "z"},       {"height", "z"},   {"elevation", "z"},
    {"elev", "z"},       {"altitude", "z"}, {"hhe", "z"},     {"hoehe", "z"},
});
/// Attributes with a fixed type (io/points.h).
struct Known {
    std::string_view name;
    ScalarType type;
};
constexpr std::array kKnown = std::to_array<Known>({
    {names::classification, ScalarType::u8},
    {names::return_number, ScalarType::u8},
    {names::number_of_returns, ScalarType::u8},
    {names::scan_direction, ScalarType::u8},
    {names::edge_of_flight_line, ScalarType::u8},
    {names::class_flags, ScalarType::u8},
    {names::scanner_channel, ScalarType::u8},
    {names::user_data, ScalarType::u8},
    {names::scan_angle_rank, ScalarType::i8},
    {names::scan_angle, ScalarType::i16},
    {names::point_source_id, ScalarType::u16},
    {names::nir, ScalarType::u16},
    {names::gps_time, ScalarType::f64},
});

/// Returns a name in the form in which names are compared, without a unit in brackets.
std::string plain_name(std::string_view theirs) {
    std::string plain;
    for (const char c : theirs.substr(0, theirs.find_first_of("[("))) {
        if (c >= 'A' && c <= 'Z')
            plain += static_cast<char>(c - 'A' + 'a');
        else if ((c >= 'a' && c <= 'z') || is_digit(c))
            plain += c;
    }
    return plain;
}
/// Returns Lucarne's name; empty if there is none.
std::string_view alias_of(std::string_view theirs, std::span<const Alias> aliases) {
    const auto found = std::ranges::find(aliases, plain_name(theirs), &Alias::theirs);
    return found == aliases.end() ? std::string_view() : found->ours;
}

std::string our_name(std::string_view theirs) {
    const std::string plain = plain_name(theirs);
    if (const auto ours = alias_of(theirs, kAliases); !ours.empty()) return std::string(ours);
    for (const auto& triple : {kAxes, kColor, kNormal})
        for (const auto name : triple)
            if (plain == name) return std::string(name);
    if (plain == names::intensity || plain == names::classification || plain == names::nir) return plain;
    return printable(theirs);
}

size_t count_of(const std::vector<Column>& columns, std::string_view name) {
    return static_cast<size_t>(
        std::count_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; }));
}
size_t index_of(const std::vector<Column>& columns, std::string_view name) {
    return static_cast<size_t>(
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; }) -
        columns.begin());
}
bool has_axes(const std::vector<Column>& columns) {
    return std::all_of(kAxes.begin(), kAxes.end(),
                       [&](std::string_view axis) { return count_of(columns, axis) == 1; });
}

/// What the numbers of a column have in common.
struct Look {
    bool numbers = false;
    bool integers = true;  ///< every number is whole
    bool whole = true;     ///< the same, and every cell holds a number
    double least = INFINITY, most = -INFINITY;
};
Look look_at(const Sample& sample, size_t column) {
    Look look;
    if (column >= sample.columns || sample.words[column]) return look;
    for (size_t row = 0; row < sample.rows(); ++row) {
        const double value = sample.at(row, column);
        if (std::isnan(value)) {
            look.whole = false;
            continue;
        }
        look.numbers = true;
        look.integers = look.integers && value == std::trunc(value);
        look.whole = look.whole && look.integers;
        look.least = std::min(look.least, value);
        look.most = std::max(look.most, value);
    }
    return look;
}

bool looks_like_normals(const Sample& sample, size_t column) {
    if (column + 3 > sample.columns) return false;
    size_t units = 0;
    for (size_t row = 0; row < sample.rows(); ++row) {
        double square = 0;
        for (size_t c = column; c < column + 3; ++c) square += sample.at(row, c) * sample.at(row, c);
        if (std::isnan(square) || (square != 0 && std::abs(square - 1) > 0.05)) return false;
        units += square != 0;
    }
    return units > 0;
}

bool looks_like_color(const Sample& sample, size_t column) {
    if (column + 3 > sample.columns) return false;
    bool whole = true;
    double most = 0;
    for (size_t c = column; c < column + 3; ++c) {
        const Look look = look_at(sample, c);
        if (!look.numbers || look.least < 0 || look.most > 65535) return false;
        whole = whole && look.whole;
        most = std::max(most, look.most);
    }
    return whole || most <= 1;
}

/// Returns whether three columns hold whole numbers from 0 to 255.
bool looks_like_bytes(const Sample& sample, size_t column) {
    for (size_t c = column; c < column + 3; ++c)
        if (const Look look = look_at(sample, c); !look.whole || look.least < 0 || look.most > 255)
            return false;
    return true;
}

/// Returns whether a column counts up, as numbers of points do.
bool counts_up(const Sample& sample, size_t column) {
    for (size_t row = 1; row < sample.rows(); ++row)
        if (!(sample.at(row, column) > sample.at(row - 1, column))) return false;
    return sample.rows() > 1 && look_at(sample, column).whole;
}

/// Returns the columns of x, y and z. A single line of words does not make its column a column of words, and
/// a column without any number is not a column of numbers.
std::optional<std::array<size_t, 3>> guess_axes(const Sample& sample) {
    std::vector<size_t> numbers;
    for (size_t column = 0; column < sample.columns && numbers.size() < 4; ++column) {
        size_t count = 0;
        for (size_t row = 0; row < sample.rows(); ++row) count += !std::isnan(sample.at(row, column));
        if (count > 0 && (!sample.words[column] || 2 * count >= sample.rows())) numbers.push_back(column);
    }
    if (numbers.size() < 3) return std::nullopt;
    const auto fractions = [&](size_t column) { return !look_at(sample, column).whole; };
    const auto is_name = [&] {
        return sample.words[0] && std::none_of(numbers.begin() + 1, numbers.end(),
                                               [&](size_t column) { return sample.words[column]; });
    };
    const size_t first = numbers.size() == 4 && numbers[0] == 0 && (counts_up(sample, 0) || is_name()) &&
                         std::all_of(numbers.begin() + 1, numbers.end(), fractions);
    return std::array{numbers[first], numbers[first + 1], numbers[first + 2]};
}

ScalarType guessed_type(std::string_view name, const Look& look, bool whole_file) {
    const auto fits = [&](ScalarType type) {
        if (type == ScalarType::f64 || !look.numbers) return true;
        const double range = std::ldexp(1.0, static_cast<int>(8 * scalar_bytes(type)));
        const bool is_signed = type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32;
        return look.integers && look.least >= (is_signed ? -range / 2 : 0) &&
               look.most < (is_signed ? range / 2 : range);
    };
    for (const Known& known : kKnown)
        if (name == known.name && fits(known.type)) return known.type;
    // Times in nanoseconds and similar numbers, which a double would round.
    if (look.whole && look.least > 0x1p53 && look.most < 0x1p63) return ScalarType::i64;
    return look.numbers && look.whole && whole_file && fits(ScalarType::i32) ? ScalarType::i32
                                                                             : ScalarType::f64;
}

/// Lays out fields and attributes.
class LayoutMaker {
 public:
    LayoutMaker(const std::vector<Column>& columns, const Sample& sample)
        : columns_(columns), sample_(sample) {
        layout_.fields.resize(columns.size());
    }

    RowLayout make() {
        if (std::all_of(kAxes.begin(), kAxes.end(), [&](std::string_view axis) {
                return columns_[index_of(columns_, axis)].type == ScalarType::f32;
            })) {
            layout_.schema.position = PositionType::f32;
            layout_.schema.stride = static_cast<uint32_t>(position_bytes(PositionType::f32));
        }
        for (size_t i = 0; i < columns_.size(); ++i) {
            Field& field = layout_.fields[i];
            field.name = columns_[i].name;
            const auto axis = std::find(kAxes.begin(), kAxes.end(), columns_[i].name);
            if (axis != kAxes.end()) {
                field.kind = Field::Kind::position;
                field.to = static_cast<uint32_t>(axis - kAxes.begin());
            } else if (group(i, kColor, names::color) || group(i, kNormal, names::normal)) {
                continue;
            } else if (columns_[i].name != "-" && (columns_[i].type || !holds_words(i))) {
                scalar(i);
            }
        }
        return std::move(layout_);
    }

 private:
    bool holds_words(size_t column) const { return column < sample_.columns && sample_.words[column]; }

    bool group(size_t column, const Triple& triple, std::string_view name) {
        const auto self = std::find(triple.begin(), triple.end(), columns_[column].name);
        if (self == triple.end()) return false;
        for (const auto member : triple)
            if (count_of(columns_, member) != 1) return false;
        if (!layout_.schema.find(name))
            layout_.schema.add(std::string(name), name == names::normal ? normal_type() : color_type(), 3);
        const Attribute* attribute = layout_.schema.find(name);
        const auto component = static_cast<uint32_t>(self - triple.begin());
        put(column, attribute->type,
            attribute->offset + component * static_cast<uint32_t>(scalar_bytes(attribute->type)));
        return true;
    }
    std::optional<ScalarType> stated(const Triple& triple) const {
        for (const auto member : triple)
            if (const auto type = columns_[index_of(columns_, member)].type) return type;
        return std::nullopt;
    }
    ScalarType normal_type() const {
        return stated(kNormal) == ScalarType::f64 ? ScalarType::f64 : ScalarType::f32;
    }
    ScalarType color_type() const {
        const auto given = stated(kColor);
        if (given == ScalarType::u8 || given == ScalarType::u16 || given == ScalarType::f32 ||
            given == ScalarType::f64)
            return *given;
        for (const auto member : kColor)
            if (const Look look = look_at(sample_, index_of(columns_, member)); look.numbers && !look.whole)
                return ScalarType::f32;
        return sample_.whole && color_bits(columns_, sample_) == 8 ? ScalarType::u8 : ScalarType::u16;
    }

    void scalar(size_t column) {
        const Column& c = columns_[column];
        std::string name = c.name;
        // These names imply a shape that a single column does not have.
        for (const auto reserved : {names::color, names::normal, names::normal_oct, names::area})
            if (name == reserved) name.insert(0, "text_");
        const auto type = c.type.value_or(guessed_type(name, look_at(sample_, column), sample_.whole));
        layout_.schema.add(unique_name(layout_.schema, name), type);
        put(column, type, layout_.schema.attributes.back().offset);
    }
    void put(size_t column, ScalarType type, uint32_t to) {
        layout_.fields[column].kind = Field::Kind::scalar;
        layout_.fields[column].type = type;
        layout_.fields[column].to = to;
    }

    const std::vector<Column>& columns_;
    const Sample& sample_;
    RowLayout layout_;
};

}  // namespace

Result<std::vector<Column>> parse_columns(std::string_view text) {
    const auto wrong = [](std::string why) {
        return bad_arguments("--columns", std::move(why), "write them as x,y,z,-,intensity:f32,r,g,b");
    };
    std::vector<Column> columns;
    for (const auto cell : split(text, ',')) {
        const size_t colon = cell.find(':');
        Column column{cell.substr(0, colon) == "-" ? "-" : our_name(cell.substr(0, colon)), std::nullopt};
        if (cell.empty()) return wrong("a name is missing");
        if (colon != cell.npos) {
            column.type = scalar_type(cell.substr(colon + 1));
            if (!column.type) return wrong(fmt::format("'{}' is no type", printable(cell.substr(colon + 1))));
        }
        columns.push_back(std::move(column));
    }
    if (!has_axes(columns)) return wrong("x, y and z have to be among them, each once");
    return columns;
}

std::optional<std::vector<Column>> written_columns(std::string_view text) {
    std::vector<Column> columns;
    for (const auto cell : split(text, ',')) {
        const size_t colon = cell.rfind(':');  // names may contain a colon
        const auto type = colon == cell.npos ? std::nullopt : scalar_type(cell.substr(colon + 1));
        if (!type || colon == 0) return std::nullopt;
        columns.push_back({printable(cell.substr(0, colon)), type});
    }
    if (!has_axes(columns)) return std::nullopt;
    return columns;
}

std::optional<std::vector<Column>> named_columns(const std::vector<std::string_view>& words) {
    std::vector<Column> columns;
    for (const auto word : words) columns.push_back({our_name(unquoted(word)), std::nullopt});
    for (const auto axis : kAxes) {
        if (count_of(columns, axis) > 0) continue;
        for (size_t i = 0; i < columns.size(); ++i)
            if (alias_of(unquoted(words[i]), kSurveyors) == axis) columns[i].name = axis;
    }
    if (!has_axes(columns)) return std::nullopt;
    return columns;
}

AxisUnit axis_unit(const std::vector<std::string_view>& words, const std::vector<Column>& columns) {
    std::array<std::optional<double>, 3> metres;
    for (size_t axis = 0; axis < 3; ++axis) {
        std::string_view text = words[index_of(columns, kAxes[axis])];
        const size_t open = text.find_first_of("[(");
        if (open == text.npos) continue;
        text = text.substr(open + 1, text.find_first_of("])", open) - open - 1);
        metres[axis] = metres_of_name(text);
        if (lower(text).starts_with("deg") || text == "\u00b0")
            return {std::nullopt, "its coordinates are degrees, not lengths; project them to metres first"};
        if (!metres[axis])
            return {std::nullopt,
                    fmt::format("its header names the unit '{}', which is not known; --unit says "
                                "what it is",
                                printable(text))};
    }
    AxisUnit unit{metres[0] ? metres[0] : metres[1], {}};
    if (unit.metres && metres[2] && *metres[2] != *unit.metres)
        unit.problem = "its heights are in another unit than the other coordinates; they are not converted";
    if (!unit.metres) unit.metres = metres[2];
    return unit;
}

std::optional<std::vector<Column>> guess_columns(const Sample& sample, bool pts) {
    const auto axes = guess_axes(sample);
    if (!axes) return std::nullopt;
    std::vector<Column> columns((*axes)[2] + 1, Column{"-", std::nullopt});
    for (size_t i = 0; i < 3; ++i) columns[(*axes)[i]].name = kAxes[i];
    if ((*axes)[0] > 0 && !sample.words[0] && look_at(sample, 0).numbers) columns[0].name = "id";
    const auto add = [&](const Triple& triple) {
        for (const auto name : triple) columns.push_back({std::string(name), std::nullopt});
    };
    bool color = false, normal = false, intensity = false;
    while (columns.size() < sample.columns) {
        const size_t at = columns.size(), left = sample.columns - at;
        const bool four = left % 3 == 1 && !intensity && !sample.words[at];
        bool color_next = four && !color && looks_like_color(sample, at + 1);
        if (color_next && looks_like_color(sample, at)) {
            const bool here = looks_like_bytes(sample, at), next = looks_like_bytes(sample, at + 1);
            color_next = next == here ? pts : next;
        }
        if (sample.words[at]) {
            columns.push_back({"-", std::nullopt});
        } else if (!normal && looks_like_normals(sample, at)) {
            add(kNormal);
            normal = true;
        } else if (!color && !color_next && looks_like_color(sample, at)) {
            add(kColor);
            color = true;
        } else if (!intensity) {
            columns.push_back({std::string(names::intensity), std::nullopt});
            intensity = true;
        } else {
            columns.push_back({fmt::format("column_{}", at + 1), std::nullopt});
        }
    }
    return columns;
}

RowLayout make_layout(const std::vector<Column>& columns, const Sample& sample) {
    return LayoutMaker(columns, sample).make();
}

std::string columns_text(const std::vector<Column>& columns) {
    constexpr size_t kShown = 40;
    std::string text;
    for (const Column& c : std::span(columns).first(std::min(columns.size(), kShown))) {
        if (!text.empty()) text += ' ';
        text += c.name;
        if (c.type) text += fmt::format(":{}", scalar_name(*c.type));
    }
    if (columns.size() > kShown) text += fmt::format(" and {} more", columns.size() - kShown);
    return text;
}

uint32_t color_bits(const std::vector<Column>& columns, const Sample& sample) {
    double most = 0;
    bool whole = true;
    for (const auto name : kColor) {
        const Look look = look_at(sample, index_of(columns, name));
        whole = whole && (look.whole || !look.numbers);
        if (look.numbers) most = std::max(most, look.most);
    }
    return color_bits_of(most, whole);
}

}  // namespace lucarne::io::text
