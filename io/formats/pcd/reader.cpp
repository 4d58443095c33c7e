// PCD: ASCII, binary, binary_compressed. Source: see header.h.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/body_guess.h"
#include "io/formats/common/buffered_input.h"
#include "io/formats/common/color_depth.h"
#include "io/formats/common/format.h"
#include "io/formats/common/pick.h"
#include "io/formats/common/text.h"
#include "io/formats/pcd/header.h"
#include "io/formats/pcd/layout.h"
#include "io/formats/pcd/lzf.h"
#include "io/formats/pcd/writer.h"
#include "io/formats/text/row_fronts.h"

namespace lucarne::io {
namespace {

using namespace pcd;

/// Reads consecutive binary records.
class BinaryReader final : public PointReader {
 public:
    BinaryReader(std::shared_ptr<const ByteSource> file, const Header& header, const ply::Layout& layout)
        : input_(file, header.data_offset, file->size()), layout_(layout), left_(header.points) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const size_t stride = layout_.schema.stride, length = layout_.packed_bytes;
        const size_t wanted = batch_limit(layout_.schema, most);
        batch.bytes.resize(static_cast<size_t>(std::min<uint64_t>(wanted, left_)) * stride);
        batch.count = 0;
        while (batch.count < wanted && left_ > 0) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(length));
            const auto count =
                static_cast<size_t>(std::min<uint64_t>({bytes.size() / length, wanted - batch.count, left_}));
            if (count == 0)
                return rejected(input_.path(), fmt::format("ends early: {} points are missing", left_));
            for (size_t i = 0; i < count; ++i) {
                const bool good = layout_.unpack(&bytes[i * length], &batch.bytes[batch.count * stride]);
                batch.count += good;
                dropped_ += !good;
            }
            input_.skip(count * length);
            left_ -= count;
        }
        batch.bytes.resize(batch.count * stride);
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_; }

 private:
    BufferedInput input_;
    const ply::Layout& layout_;
    uint64_t left_, dropped_ = 0;
};

/// Where each field begins in a compressed stream, which holds all values of the first field, then all of the
/// second, and so on.
struct Compressed {
    uint64_t begin = 0, end = 0;  ///< the stream's place in the file
    std::vector<LzfInput::State> fields;
};

/// Decodes compressed fields in parallel passes.
class CompressedReader final : public PointReader {
 public:
    CompressedReader(const std::shared_ptr<const ByteSource>& file, const Header& header,
                     const ply::Layout& layout, const Compressed& compressed)
        : header_(header), layout_(layout), left_(header.points) {
        for (const auto& state : compressed.fields) {
            inputs_.emplace_back(file, compressed.begin, compressed.end);
            inputs_.back().go_to(state);
        }
    }

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const size_t stride = layout_.schema.stride, length = layout_.packed_bytes;
        const size_t wanted = batch_limit(layout_.schema, most);
        batch.bytes.clear();
        batch.count = 0;
        while (batch.count < wanted && left_ > 0) {
            const size_t room = std::max<size_t>(1, kPieceBytes / length);
            const auto count = static_cast<size_t>(std::min<uint64_t>({room, wanted - batch.count, left_}));
            LUCARNE_TRY(decode(count));
            batch.bytes.resize((batch.count + count) * stride);
            for (size_t i = 0; i < count; ++i) {
                const bool good = layout_.unpack(&packed_[i * length], &batch.bytes[batch.count * stride]);
                batch.count += good;
                dropped_ += !good;
            }
            left_ -= count;
        }
        batch.bytes.resize(batch.count * stride);
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_; }

 private:
    static constexpr size_t kPieceBytes = size_t{256} << 10;

    Result<void> decode(size_t count) {
        const size_t length = layout_.packed_bytes;
        packed_.resize(count * length);
        size_t offset = 0;
        for (size_t f = 0; f < inputs_.size(); ++f) {
            const size_t bytes = header_.fields[f].bytes();
            values_.resize(count * bytes);
            LUCARNE_TRY(inputs_[f].read(values_));
            for (size_t i = 0; i < count; ++i)
                std::memcpy(&packed_[i * length + offset], &values_[i * bytes], bytes);
            offset += bytes;
        }
        return {};
    }

    const Header& header_;
    const ply::Layout& layout_;
    std::vector<LzfInput> inputs_;
    uint64_t left_, dropped_ = 0;
    std::vector<std::byte> packed_, values_;
};

class PcdSource final : public PointSource {
 public:
    PcdSource(std::shared_ptr<const ByteSource> file, Header header, bool salvage)
        : file_(std::move(file)),
          header_(std::move(header)),
          salvage_(salvage),
          layout_(pcd::make_layout(header_)) {}

    Result<void> describe(const ReadOptions& options) {
        const bool organised = header_.height > 1;
        LUCARNE_TRY(check_size());
        if (header_.encoding == Encoding::compressed) LUCARNE_TRY(find_fields());
        if (header_.encoding == Encoding::ascii) {
            layout_.rows.salvage = salvage_;
            sections_.push_back(
                {header_.data_offset, file_->size(), layout_.rows, header_.points, header_.data_line});
        }
        constexpr std::array kEncodings = {"ascii", "binary", "binary_compressed"};
        info_.path = file_->path().string();
        info_.format = fmt::format("PCD, {}", kEncodings[static_cast<size_t>(header_.encoding)]);
        info_.declared_points = header_.points;
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        LUCARNE_ASSIGN(auto remarks, remarks_of(info_.path, header_.comments));
        info_.stations = std::move(remarks.stations);
        set_unit(info_, options, remarks.metres_per_unit);
        info_.color_bits = remarks.color_bits ? *remarks.color_bits : sampled_color_bits(*this);
        const auto& v = header_.viewpoint;
        const glm::dvec3 viewpoint(v[0], v[1], v[2]);
        // Writers of clouds without a grid often leave the viewpoint at its default.
        if (info_.stations.empty() && (organised || viewpoint != glm::dvec3(0.0)))
            info_.stations.push_back({1, viewpoint});
        info_.notes.pcd = {header_.width, header_.height, header_.viewpoint};
        info_.notes.color_bits = info_.color_bits;
        return {};
    }

    const Schema& schema() const override { return layout_.binary.schema; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        switch (header_.encoding) {
            case Encoding::ascii:
                return text::read_rows(file_, sections_);
            case Encoding::binary:
                return std::make_unique<BinaryReader>(file_, header_, layout_.binary);
            case Encoding::compressed:
                break;
        }
        return std::make_unique<CompressedReader>(file_, header_, layout_.binary, compressed_);
    }
    size_t parts() const override {
        return header_.encoding == Encoding::ascii ? text::row_parts(sections_) : 1;
    }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        if (header_.encoding != Encoding::ascii) return PointSource::front(part, most, batch);
        return text::read_row_front(*file_, sections_, part, most, batch);
    }
    bool seekable() const override { return header_.encoding == Encoding::binary; }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        if (!seekable()) return PointSource::pick(indices, batch);
        const size_t stride = schema().stride;
        batch.bytes.resize(indices.size() * stride);
        batch.count = 0;
        return for_picked(*file_, header_.data_offset, layout_.binary.packed_bytes, indices,
                          [&](const std::byte* at) {
                              batch.count += layout_.binary.unpack(at, &batch.bytes[batch.count * stride]);
                          });
    }

 private:
    /// Checks that the file can hold what its header promises.
    Result<void> check_size() {
        const uint64_t there = file_->size() - header_.data_offset;
        uint64_t most = there / layout_.binary.packed_bytes;
        // A value of text takes two bytes with its separator, except for the very last. Three bytes of LZF
        // become at most 264.
        if (header_.encoding == Encoding::ascii) most = (there + 1) / (2 * layout_.rows.fields.size());
        if (header_.encoding == Encoding::compressed) most = there * 88 / layout_.binary.packed_bytes;
        if (header_.points <= most || (salvage_ && header_.encoding != Encoding::binary)) return {};
        if (salvage_) {
            keep_first(most);
            return {};
        }
        return rejected(file_->path().string(),
                        fmt::format("is truncated: its header promises {} points, at most {} are there",
                                    header_.points, most));
    }

    /// Keeps the first `points` points; the others count as cut off.
    void keep_first(uint64_t points) {
        add_loss(info_.losses, lost::cut_off, header_.points - points);
        header_.points = header_.width = points;
        header_.height = 1;
    }

    /// Decodes everything once, to know that it is complete and where each field begins.
    Result<void> find_fields() {
        if (header_.points == 0) return {};
        std::array<std::byte, 8> sizes{};
        LUCARNE_TRY(file_->read_at(header_.data_offset, sizes));
        const auto packed = load<uint32_t>(sizes.data()), unpacked = load<uint32_t>(sizes.data() + 4);
        compressed_.begin = header_.data_offset + sizes.size();
        compressed_.end = compressed_.begin + packed;
        if (salvage_) compressed_.end = std::min(compressed_.end, file_->size());
        if (compressed_.end > file_->size())
            return rejected(file_->path().string(),
                            fmt::format("is truncated: it promises {} compressed bytes, {} are there", packed,
                                        file_->size() - compressed_.begin));
        if (header_.points > UINT32_MAX || unpacked != header_.points * layout_.binary.packed_bytes)
            return rejected(file_->path().string(),
                            fmt::format("its {} points take {} bytes, {} are compressed", header_.points,
                                        header_.points * layout_.binary.packed_bytes, unpacked));
        LzfInput input(file_, compressed_.begin, compressed_.end);
        std::vector<std::byte> passed(size_t{64} << 10);
        for (const Field& field : header_.fields) {
            compressed_.fields.push_back(input.state());
            for (uint64_t left = header_.points * field.bytes(); left > 0;) {
                const auto bytes = static_cast<size_t>(std::min<uint64_t>(left, passed.size()));
                auto done = input.read(std::span(passed).first(bytes));
                if (!done && salvage_ && done.error().kind == ErrorKind::input_rejected) {
                    // Only the last field is incomplete, so the points up to its end are whole.
                    const uint64_t before = header_.points * (layout_.binary.packed_bytes - field.bytes());
                    const bool last = &field == &header_.fields.back();
                    keep_first(last ? (input.state().decoded - before) / field.bytes() : 0);
                    return {};
                }
                LUCARNE_TRY(std::move(done));
                left -= bytes;
            }
        }
        return {};
    }

    std::shared_ptr<const ByteSource> file_;
    Header header_;
    bool salvage_;
    Layout layout_;
    std::vector<text::Section> sections_;
    Compressed compressed_;
    ScanInfo info_;
};

/// Compares a binary body with what its header promises; see guess_body.
Result<void> fit_body(const ByteSource& file, Header& header, bool salvage) {
    if (header.encoding != Encoding::binary) return {};
    std::vector<ScalarType> types;
    StatedBody body{header.data_offset, file.size() - header.data_offset, header.points, {}};
    for (const Field& field : header.fields) {
        for (const auto& [axis, name] : {std::pair{0, "x"}, {1, "y"}, {2, "z"}})
            if (index_of_name(header.fields, name, &Field::name) ==
                static_cast<size_t>(&field - header.fields.data()))
                body.axes[static_cast<size_t>(axis)] = types.size();
        types.insert(types.end(), field.count, field.type);
    }
    body.types = types;
    LUCARNE_ASSIGN(const BodyGuess guess, io::fit_body(file, body, salvage));
    if (guess.more > 0) {
        header.points = header.width = header.points + guess.more;
        header.height = 1;
    }
    for (Field& field : header.fields)
        if (guess.doubles && field.type == ScalarType::f32) field.type = ScalarType::f64;
    if (guess.padding > 0)
        header.fields.push_back({"_", ScalarType::u8, static_cast<uint32_t>(guess.padding)});
    return {};
}

Result<std::unique_ptr<PointSource>> open_pcd(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    LUCARNE_ASSIGN(auto header, pcd::read_header(file));
    LUCARNE_TRY(fit_body(*file, header, options.salvage));
    auto source = std::make_unique<PcdSource>(std::move(file), std::move(header), options.salvage);
    LUCARNE_TRY(source->describe(options));
    return source;
}

bool is_pcd(std::string_view head) {
    auto line = first_statement(head);
    const auto word = next_word(line);
    return same_letters(word, "VERSION") || same_letters(word, "FIELDS") ||
           without_mark(head).starts_with("# .PCD");
}

}  // namespace

const Format& pcd_format() {
    static constexpr Format kFormat{"PCD", ".pcd", is_pcd, open_pcd, pcd::create, true};
    return kFormat;
}

}  // namespace lucarne::io
