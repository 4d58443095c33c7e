// PCD, binary. Source: see header.h.
#include "io/formats/pcd/writer.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/counted_writer.h"
#include "io/formats/pcd/header.h"

namespace lucarne::io::pcd {
namespace {

/// A field of the file, and where its values are in a record.
struct Output {
    enum class Kind : uint8_t {
        copy,
        axis,  ///< axis number `from` of a scaled position, as a double
        rgb,   ///< three bytes, packed
        rgba,  ///< the same, with a fourth byte at `alpha`
    };
    Kind kind = Kind::copy;
    Field field;
    uint32_t from = 0, alpha = 0;
};

char letter_of(ScalarType type) {
    const auto name = scalar_name(type);
    return name[0] == 'f' ? 'F' : name[0] == 'i' ? 'I' : 'U';
}

class OutputPlan {
 public:
    explicit OutputPlan(const Schema& schema) : schema_(schema) {}

    std::vector<Output> make() {
        const auto axis_type = schema_.position == PositionType::f32 ? ScalarType::f32 : ScalarType::f64;
        const bool scaled = schema_.position == PositionType::i32_scaled;
        for (uint32_t k = 0; k < 3; ++k)
            add(std::string(1, "xyz"[k]), axis_type, 1,
                scaled ? k : k * static_cast<uint32_t>(scalar_bytes(axis_type)),
                scaled ? Output::Kind::axis : Output::Kind::copy);
        for (const Attribute& a : schema_.attributes) attribute(a);
        return std::move(outputs_);
    }

 private:
    void attribute(const Attribute& a) {
        constexpr std::array kColor = {"red", "green", "blue"},
                             kNormal = {"normal_x", "normal_y", "normal_z"};
        const bool color = a.name == names::color && a.components == 3;
        const Attribute* alpha = schema_.find("alpha");
        const bool with_alpha = alpha && alpha->type == ScalarType::u8 && alpha->components == 1;
        const Attribute* packed = schema_.find(names::color);
        const bool packs = packed && packed->type == ScalarType::u8 && packed->components == 3;
        if (color && packs) {
            add(with_alpha ? "rgba" : "rgb", with_alpha ? ScalarType::u32 : ScalarType::f32, 1, a.offset,
                with_alpha ? Output::Kind::rgba : Output::Kind::rgb);
            if (with_alpha) outputs_.back().alpha = alpha->offset;
        } else if (color || (a.name == names::normal && a.components == 3)) {
            for (uint32_t k = 0; k < 3; ++k)
                add((color ? kColor : kNormal)[k], a.type, 1,
                    a.offset + k * static_cast<uint32_t>(scalar_bytes(a.type)));
        } else if (!(packs && with_alpha && &a == alpha)) {
            add(a.name, a.type, a.components, a.offset);
        }
    }

    void add(std::string name, ScalarType type, uint32_t count, uint32_t from,
             Output::Kind kind = Output::Kind::copy) {
        std::replace(name.begin(), name.end(), ' ', '_');  // blanks separate the fields
        std::string unique = name;
        const auto taken = [&](const Output& o) { return o.field.name == unique; };
        for (int n = 2; std::any_of(outputs_.begin(), outputs_.end(), taken); ++n)
            unique = fmt::format("{}_{}", name, n);
        outputs_.push_back({kind, {unique, type, count}, from, 0});
    }

    const Schema& schema_;
    std::vector<Output> outputs_;
};

class PcdWriter final : public CountedWriter {
 public:
    PcdWriter(OutputFile file, const Schema& schema)
        : CountedWriter(std::move(file), schema), outputs_(OutputPlan(schema_).make()) {}

    Result<void> begin(const ScanInfo& info) {
        std::string header =
            "# .PCD v0.7 - Point Cloud Data file format\n" + remark_lines(info, "# ") + "VERSION 0.7\n";
        const auto line = [&](std::string_view key, const auto& value_of) {
            header += key;
            for (const Output& o : outputs_) header += fmt::format(" {}", value_of(o.field));
            header += '\n';
        };
        line("FIELDS", [](const Field& f) { return f.name; });
        line("SIZE", [](const Field& f) { return scalar_bytes(f.type); });
        line("TYPE", [](const Field& f) { return letter_of(f.type); });
        line("COUNT", [](const Field& f) { return f.count; });
        header += "WIDTH ";
        leave_room_for_count(header);
        header += "\nHEIGHT 1\nVIEWPOINT " + viewpoint_of(info) + "\nPOINTS ";
        leave_room_for_count(header);
        header += "\nDATA binary\n";
        size_t bytes = 0;
        for (const Output& o : outputs_) bytes += o.field.bytes();
        return CountedWriter::begin(header, bytes);
    }

 private:
    /// Returns the viewpoint: that of a PCD source, otherwise the only station.
    static std::string viewpoint_of(const ScanInfo& info) {
        if (info.notes.pcd) return fmt::format("{}", fmt::join(info.notes.pcd->viewpoint, " "));
        const glm::dvec3 at = info.stations.size() == 1 ? info.stations[0].position : glm::dvec3(0.0);
        return fmt::format("{} {} {} 1 0 0 0", at.x, at.y, at.z);
    }

    void pack(const std::byte* record, std::byte* out) const override {
        for (const Output& o : outputs_) {
            const std::byte* from = record + o.from;
            switch (o.kind) {
                case Output::Kind::copy:
                    std::memcpy(out, from, o.field.bytes());
                    break;
                case Output::Kind::axis:
                    store(out, scaled_coordinate(static_cast<int>(o.from), record));
                    break;
                case Output::Kind::rgb:
                case Output::Kind::rgba:
                    for (uint32_t k = 0; k < 3; ++k) out[k] = from[2 - k];
                    out[3] = o.kind == Output::Kind::rgba ? record[o.alpha] : std::byte{0};
                    break;
            }
            out += o.field.bytes();
        }
    }

    std::vector<Output> outputs_;
};

}  // namespace

Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options) {
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, options.overwrite));
    auto writer = std::make_unique<PcdWriter>(std::move(file), schema);
    LUCARNE_TRY(writer->begin(info));
    return writer;
}

}  // namespace lucarne::io::pcd
