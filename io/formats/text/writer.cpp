// XYZ, TXT and CSV: rows of numbers that read back as the same bits.
#include "io/formats/text/writer.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/parallel.h"
#include "io/files/file.h"
#include "io/formats/common/decimal.h"
#include "io/formats/common/format.h"
#include "io/formats/common/remarks.h"
#include "io/formats/text/columns.h"

namespace lucarne::io::text {
namespace {

constexpr size_t kPieceRows = 4096, kPieceBytes = size_t{1} << 20, kPiecesAtOnce = 64;  ///< upper limits
constexpr size_t kLongestNumber = 32;  ///< characters, including the separator
constexpr size_t kMostStations = 500;  ///< the first row must be within the first 64 KiB of a file

struct Output {
    std::string name;
    ScalarType type = ScalarType::f64;
    uint32_t offset = 0;
    std::optional<Decimal> decimal;               ///< for a scaled coordinate
    std::optional<std::array<double, 2>> scaled;  ///< scale and offset, if these are no decimal fractions
};

/// Returns a name that may stand in a header, and between the commas of Lucarne's comment.
std::string word_of(std::string_view name) {
    std::string word(name);
    for (char& c : word)
        if (static_cast<unsigned char>(c) <= ' ' || c == 0x7f || c == ',' || c == ';' || c == '"') c = '_';
    return word.empty() ? "unnamed" : word;
}

std::vector<Output> outputs_of(const Schema& schema) {
    std::vector<Output> outputs;
    const auto add = [&](const std::string& name, ScalarType type, uint32_t offset) {
        std::string unique = word_of(name);
        const auto taken = [&](const Output& o) { return o.name == unique; };
        for (int n = 2; std::any_of(outputs.begin(), outputs.end(), taken); ++n)
            unique = fmt::format("{}_{}", word_of(name), n);
        outputs.push_back({unique, type, offset, std::nullopt, std::nullopt});
    };
    const auto axis_type = schema.position == PositionType::f32   ? ScalarType::f32
                           : schema.position == PositionType::f64 ? ScalarType::f64
                                                                  : ScalarType::i32;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        add(std::string(1, "xyz"[axis]), axis_type, axis * static_cast<uint32_t>(scalar_bytes(axis_type)));
        if (schema.position != PositionType::i32_scaled) continue;
        const int i = static_cast<int>(axis);
        outputs.back().decimal = Decimal::of(schema.scale[i], schema.offset[i]);
        outputs.back().scaled = {schema.scale[i], schema.offset[i]};
    }
    for (const Attribute& a : schema.attributes) {
        constexpr std::array kColor = {"red", "green", "blue"}, kNormal = {"nx", "ny", "nz"};
        for (uint32_t c = 0; c < a.components; ++c) {
            const std::string name = a.name == names::color && a.components == 3    ? kColor[c]
                                     : a.name == names::normal && a.components == 3 ? kNormal[c]
                                     : a.components == 1                            ? a.name
                                                         : fmt::format("{}_{}", a.name, c);
            add(name, a.type, a.offset + c * static_cast<uint32_t>(scalar_bytes(a.type)));
        }
    }
    return outputs;
}

/// Writes the shortest text that reads back as the same value.
template <class T>
char* put(const std::byte* at, char* to) {
    return std::to_chars(to, to + kLongestNumber, load<T>(at)).ptr;
}
char* put_value(ScalarType type, const std::byte* at, char* to) {
    switch (type) {
        case ScalarType::u8:
            return std::to_chars(to, to + kLongestNumber, unsigned{load<uint8_t>(at)}).ptr;
        case ScalarType::i8:
            return std::to_chars(to, to + kLongestNumber, int{load<int8_t>(at)}).ptr;
        case ScalarType::u16:
            return put<uint16_t>(at, to);
        case ScalarType::i16:
            return put<int16_t>(at, to);
        case ScalarType::u32:
            return put<uint32_t>(at, to);
        case ScalarType::i32:
            return put<int32_t>(at, to);
        case ScalarType::u64:
            return put<uint64_t>(at, to);
        case ScalarType::i64:
            return put<int64_t>(at, to);
        case ScalarType::f32:
            return put<float>(at, to);
        case ScalarType::f64:
            break;
    }
    return put<double>(at, to);
}

class TextWriter final : public PointWriter {
 public:
    TextWriter(OutputFile file, const Schema& schema, char separator)
        : file_(std::move(file)), schema_(schema), outputs_(outputs_of(schema)), separator_(separator) {
        piece_rows_ = std::clamp<size_t>(kPieceBytes / (outputs_.size() * kLongestNumber), 1, kPieceRows);
    }

    Result<void> begin(ScanInfo info) {
        if (info.stations.size() > kMostStations) {
            log::warn("its {} stations are left out: a text holds {}", info.stations.size(), kMostStations);
            info.stations.clear();
        }
        std::string header = remark_lines(info, "# ") + "# lucarne columns ", names;
        for (const Output& o : outputs_) {
            const auto type = o.scaled ? ScalarType::f64 : o.type;
            header += fmt::format("{}{}:{}", names.empty() ? "" : ",", o.name, scalar_name(type));
            if (!names.empty()) names += separator_;
            names += o.name;
        }
        return file_.append(header + '\n' + names + '\n');
    }

    Result<void> write(std::span<const std::byte> records) override {
        const size_t most = kPiecesAtOnce * piece_rows_ * schema_.stride;
        for (; !records.empty(); records = records.subspan(std::min(most, records.size())))
            LUCARNE_TRY(write_some(records.first(std::min(most, records.size()))));
        return {};
    }

    Result<void> finish() override { return file_.commit(); }

 private:
    Result<void> write_some(std::span<const std::byte> records) {
        const size_t rows = records.size() / schema_.stride;
        pieces_.resize((rows + piece_rows_ - 1) / piece_rows_);
        parallel_ranges(rows, piece_rows_, [&](size_t first, size_t last) {
            pieces_[first / piece_rows_] =
                text_of(records.subspan(first * schema_.stride, (last - first) * schema_.stride));
        });
        for (const std::string& piece : pieces_) LUCARNE_TRY(file_.append(piece));
        return {};
    }

    std::string text_of(std::span<const std::byte> records) const {
        std::string text(records.size() / schema_.stride * outputs_.size() * kLongestNumber, '\0');
        char* to = text.data();
        for (size_t at = 0; at < records.size(); at += schema_.stride) {
            for (const Output& o : outputs_) {
                to = put_output(o, &records[at + o.offset], to);
                *to++ = separator_;
            }
            to[-1] = '\n';
        }
        text.resize(static_cast<size_t>(to - text.data()));
        return text;
    }

    static char* put_output(const Output& o, const std::byte* at, char* to) {
        if (o.decimal) return o.decimal->write(load<int32_t>(at), to);
        if (!o.scaled) return put_value(o.type, at, to);
        const double value = load<int32_t>(at) * (*o.scaled)[0] + (*o.scaled)[1];
        return std::to_chars(to, to + kLongestNumber, value).ptr;
    }

    OutputFile file_;
    Schema schema_;
    std::vector<Output> outputs_;
    char separator_;
    size_t piece_rows_ = 1;
    std::vector<std::string> pieces_;
};

}  // namespace

Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options) {
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, options.overwrite));
    const std::string extension = lower_extension(path);
    auto writer = std::make_unique<TextWriter>(std::move(file), schema, extension == ".csv" ? ',' : ' ');
    if (extension != ".xyz") LUCARNE_TRY(writer->begin(info));
    return writer;
}

}  // namespace lucarne::io::text
