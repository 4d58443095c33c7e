// PLY, binary little-endian. Source: see header.h.
#include "io/formats/ply/writer.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/counted_writer.h"
#include "io/formats/ply/layout.h"

namespace lucarne::io::ply {
namespace {

/// A property of the file, and where its value is in a record.
struct Output {
    std::string name;
    ScalarType from = ScalarType::u8, to = ScalarType::u8;
    uint32_t offset = 0;
};

/// Returns the columns of the source; none if it was not PLY.
std::vector<Layout::Column> source_columns(const FormatNotes& notes) {
    if (!notes.ply) return {};
    std::vector<Property> properties;
    for (const auto& p : notes.ply->properties) properties.push_back({p.name, p.type, std::nullopt});
    return make_layout(properties, Encoding::little_endian).columns;
}

class OutputPlan {
 public:
    explicit OutputPlan(const Schema& schema) : schema_(schema) {}

    std::vector<Output> make(const std::vector<Layout::Column>& columns) {
        for (const Layout::Column& column : columns) {
            const auto value = find(column.attribute, column.component);
            // Keeps the source's own type if the attribute still holds its values.
            if (value)
                add(column.attribute, column.component, column.property.name, *value,
                    keeps_type(column, value->type) ? column.property.type : value->type);
        }
        for (uint32_t axis = 0; axis < 3; ++axis) add_new("", axis, std::string(1, "xyz"[axis]));
        for (const Attribute& a : schema_.attributes)
            for (uint32_t c = 0; c < a.components; ++c) add_new(a.name, c, property_name(a, c));
        return std::move(outputs_);
    }

 private:
    struct Value {
        ScalarType type;
        uint32_t offset;
    };
    std::optional<Value> find(std::string_view attribute, uint32_t component) const {
        if (attribute.empty()) {
            const auto type = schema_.position == PositionType::f32   ? ScalarType::f32
                              : schema_.position == PositionType::f64 ? ScalarType::f64
                                                                      : ScalarType::i32;
            return Value{type, component * static_cast<uint32_t>(scalar_bytes(type))};
        }
        const Attribute* a = schema_.find(attribute);
        if (!a || component >= a->components) return std::nullopt;
        return Value{a->type, a->offset + component * static_cast<uint32_t>(scalar_bytes(a->type))};
    }
    /// Returns whether the reader turned this source type into `held`: the same type, bytes called char,
    /// integers as coordinates, or wide integers as colours.
    static bool keeps_type(const Layout::Column& column, ScalarType held) {
        const ScalarType source = column.property.type;
        const bool wide = source == ScalarType::i32 || source == ScalarType::u32;
        return source == held || (scalar_bytes(source) == 1 && scalar_bytes(held) == 1) ||  // char for uchar
               (column.attribute.empty() && held == ScalarType::f64) ||  // whole coordinates
               (column.attribute == names::color && wide && held == ScalarType::u16);
    }
    static std::string property_name(const Attribute& a, uint32_t component) {
        constexpr std::array<std::string_view, 3> kColor = {"red", "green", "blue"},
                                                  kNormal = {"nx", "ny", "nz"};
        if (a.name == names::color && a.components == 3) return std::string(kColor[component]);
        if (a.name == names::normal && a.components == 3) return std::string(kNormal[component]);
        return a.components == 1 ? a.name : fmt::format("{}_{}", a.name, component);
    }
    void add_new(const std::string& attribute, uint32_t component, const std::string& name) {
        if (std::find(done_.begin(), done_.end(), std::pair(attribute, component)) != done_.end()) return;
        const auto value = find(attribute, component);
        if (attribute.empty())
            return add(attribute, component, name, *value,
                       value->type == ScalarType::i32 ? ScalarType::f64 : value->type);
        if (scalar_bytes(value->type) < 8 || value->type == ScalarType::f64)
            return add(attribute, component, name, *value, value->type);
        // PLY has no 64-bit integers.
        const auto high = value->type == ScalarType::i64 ? ScalarType::i32 : ScalarType::u32;
        add(attribute, component, name + "_low", {ScalarType::u32, value->offset}, ScalarType::u32);
        add(attribute, component, name + "_high", {high, value->offset + 4}, high);
    }
    void add(const std::string& attribute, uint32_t component, const std::string& name, Value value,
             ScalarType to) {
        std::string word = name;  // blanks separate the properties
        std::replace(word.begin(), word.end(), ' ', '_');
        std::string unique = word;
        const auto taken = [&](const Output& o) { return o.name == unique; };
        for (int n = 2; std::any_of(outputs_.begin(), outputs_.end(), taken); ++n)
            unique = fmt::format("{}_{}", word, n);
        outputs_.push_back({unique, value.type, to, value.offset});
        done_.emplace_back(attribute, component);
    }

    const Schema& schema_;
    std::vector<Output> outputs_;
    std::vector<std::pair<std::string, uint32_t>> done_;  ///< attribute and component
};

class PlyWriter final : public CountedWriter {
 public:
    PlyWriter(OutputFile file, const Schema& schema, std::vector<Output> outputs)
        : CountedWriter(std::move(file), schema), outputs_(std::move(outputs)) {}

    Result<void> begin(const ScanInfo& info) {
        std::string header = "ply\nformat binary_little_endian 1.0\n";
        header += kept_lines(info) + remark_lines(info, "comment ") + "element vertex ";
        leave_room_for_count(header);
        header += '\n';
        size_t bytes = 0;
        for (const Output& o : outputs_) {
            header += fmt::format("property {} {}\n", word_of(o.to), o.name);
            bytes += scalar_bytes(o.to);
        }
        return CountedWriter::begin(header + "end_header\n", bytes);
    }

 private:
    /// Returns the comments of a PLY source, except those that are written again.
    static std::string kept_lines(const ScanInfo& info) {
        if (!info.notes.ply) return {};
        std::string lines;
        const auto add = [&](std::string_view word, const std::vector<std::string>& texts) {
            for (const std::string& text : texts)
                if (!text.starts_with("lucarne ") && text.find_first_of("\r\n") == text.npos)
                    lines += fmt::format("{} {}\n", word, text);
        };
        add("comment", info.notes.ply->comments);
        add("obj_info", info.notes.ply->infos);
        return lines;
    }

    void pack(const std::byte* record, std::byte* out) const override {
        const bool scaled = schema_.position == PositionType::i32_scaled;
        for (const Output& o : outputs_) {
            if (scaled && o.offset < 12) {
                store_scalar(o.to, out, scaled_coordinate(static_cast<int>(o.offset / 4), record));
            } else if (o.from == o.to || scalar_bytes(o.from) == 1) {
                std::memcpy(out, record + o.offset, scalar_bytes(o.to));
            } else {
                store_scalar(o.to, out, scalar_at(o.from, record + o.offset));
            }
            out += scalar_bytes(o.to);
        }
    }

    std::vector<Output> outputs_;
};

}  // namespace

Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options) {
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, options.overwrite));
    auto writer = std::make_unique<PlyWriter>(std::move(file), schema,
                                              OutputPlan(schema).make(source_columns(info.notes)));
    LUCARNE_TRY(writer->begin(info));
    return writer;
}

}  // namespace lucarne::io::ply
