// PLY: ASCII, binary little and big endian. Source: see ply_header.h.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/log.h"
#include "io/formats/buffered_input.h"
#include "io/formats/format.h"
#include "io/formats/ply_layout.h"
#include "io/formats/ply_mesh.h"
#include "io/formats/ply_values.h"
#include "io/formats/ply_writer.h"
#include "io/formats/pick.h"
#include "io/formats/text.h"

namespace lucarne::io {
namespace {

using namespace ply;

struct Salvage {
    bool wanted = false;
    bool open_end = false;  ///< the file's last line lacks its end
};

class PlyReader final : public PointReader {
 public:
    PlyReader(std::shared_ptr<const InputFile> file, const ply::Header& header, const ply::Layout& layout,
              uint64_t offset, Salvage salvage)
        : end_(file->size()),
          input_(std::move(file), offset, end_),
          header_(header),
          layout_(layout),
          salvage_(salvage),
          left_(header.vertices().count),
          packed_(layout.packed_bytes) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const size_t stride = layout_.schema.stride;
        const size_t wanted = batch_limit(layout_.schema, most);
        batch.bytes.resize(static_cast<size_t>(std::min<uint64_t>(wanted, left_)) * stride);
        batch.count = 0;
        const bool text = header_.encoding == ply::Encoding::ascii;
        while (batch.count < wanted && left_ > 0) {
            if (!text && !header_.vertices().has_list()) {
                LUCARNE_TRY(read_fixed(batch, wanted));
                continue;
            }
            const uint64_t before = input_.position();
            auto done =
                text ? parse_line()
                     : walk_entry(input_, header_.vertices(), layout_.big_endian, packed_.data());
            if (salvage_.wanted) {
                LUCARNE_ASSIGN(const bool good, salvaged(std::move(done), text, before));
                if (!good) continue;
            } else if (!done) {
                return tl::unexpected(std::move(done).error());
            }
            take_point(packed_.data(), batch);
        }
        batch.bytes.resize(batch.count * stride);
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_; }
    Losses losses() const override {
        Losses losses = PointReader::losses();
        add_losses(losses, lost_);
        return losses;
    }

 private:
    /// Whether the vertex was read; else it, or where nothing more can be read all that are left, are lost.
    Result<bool> salvaged(Result<void> done, bool text, uint64_t before) {
        if (!done && done.error().kind != ErrorKind::input_rejected)
            return tl::unexpected(std::move(done).error());
        const bool at_end = input_.position() >= end_;
        // Nobody knows how the last line went on where others are missing behind it.
        const bool cut = text && at_end && left_ > 1 && salvage_.open_end;
        if (done && !cut) return true;
        const bool only_this = text && !at_end && input_.position() > before;
        add_loss(lost_, only_this ? lost::damaged : lost::cut_off, only_this ? 1 : left_);
        left_ -= only_this ? 1 : left_;
        return false;
    }

    void take_point(const std::byte* packed, PointBatch& batch) {
        const bool good = layout_.unpack(packed, batch.bytes.data() + batch.count * layout_.schema.stride);
        batch.count += good;
        dropped_ += !good;
        --left_;
    }

    Result<void> read_fixed(PointBatch& batch, size_t wanted) {
        LUCARNE_ASSIGN(const auto bytes, input_.peek(layout_.packed_bytes));
        const auto count = static_cast<size_t>(
            std::min<uint64_t>({bytes.size() / layout_.packed_bytes, wanted - batch.count, left_}));
        if (count == 0)
            return rejected(input_.path(), fmt::format("ends early: {} points are missing", left_));
        for (size_t i = 0; i < count; ++i) take_point(bytes.data() + i * layout_.packed_bytes, batch);
        input_.skip(count * layout_.packed_bytes);
        return {};
    }

    Result<void> parse_line() {
        auto got = text_line(input_, header_);
        const auto& vertices = header_.vertices();
        const uint64_t number = vertices.count - left_ + 1;
        if (!got && input_.position() >= end_)
            return rejected(input_.path(), fmt::format("ends early: {} points are missing", left_));
        LUCARNE_ASSIGN(std::string_view line, std::move(got));
        std::byte* at = packed_.data();
        for (const auto& p : vertices.properties) {
            const auto word = next_word(line);
            if (p.count) {
                const auto length = parse_number<uint32_t>(word);
                if (!length) return bad_value(number, p.name, word);
                for (uint32_t i = 0; i < *length && !line.empty(); ++i) next_word(line);
                continue;
            }
            if (!parse_scalar(p.type, word, at)) return bad_value(number, p.name, word);
            at += scalar_bytes(p.type);
        }
        if (!next_word(line).empty())
            return rejected(input_.path(),
                            fmt::format("vertex {} has more values than the header names", number));
        return {};
    }
    Result<void> bad_value(uint64_t number, const std::string& property, std::string_view word) const {
        return rejected(input_.path(), fmt::format("vertex {} has '{}' for its property {}", number,
                                                   word.substr(0, 40), property));
    }

    uint64_t end_;
    BufferedInput input_;
    const ply::Header& header_;
    const ply::Layout& layout_;
    Salvage salvage_;
    uint64_t left_, dropped_ = 0;
    Losses lost_;
    std::vector<std::byte> packed_;  ///< a vertex put together from words or around lists
};

class PlySource final : public PointSource {
 public:
    PlySource(std::shared_ptr<const InputFile> file, ply::Header header, bool salvage, bool mesh)
        : file_(std::move(file)),
          header_(std::move(header)),
          salvage_{salvage, false},
          mesh_(mesh),
          layout_(ply::make_layout(header_.vertices().properties, header_.encoding)) {}

    Result<void> describe(const ReadOptions& options) {
        const std::string name = file_->path().string();
        LUCARNE_TRY(find_vertices());
        note_what_is_not_read();
        constexpr std::array kEncodings = {"ASCII", "binary little endian", "binary big endian"};
        info_.path = name;
        info_.format = fmt::format("PLY, {}", kEncodings[static_cast<size_t>(header_.encoding)]);
        info_.declared_points = header_.vertices().count;
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        LUCARNE_ASSIGN(auto remarks, remarks_of(name, header_.comments));
        info_.stations = std::move(remarks.stations);
        info_.metres_per_unit = options.metres_per_unit.value_or(remarks.metres_per_unit.value_or(1.0));
        LUCARNE_ASSIGN(info_.color_bits, find_color_bits(remarks.color_bits));
        if (layout_.flat) log::warn("{}: its vertices have no z, it is taken as 0", name);
        nlohmann::json details = ply::to_details(header_);
        details["color_bits"] = info_.color_bits;
        info_.details = details.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        return {};
    }

    const Schema& schema() const override { return layout_.schema; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        return std::make_unique<PlyReader>(file_, header_, layout_, vertices_offset_, salvage_);
    }
    bool seekable() const override { return fixed(); }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        if (!fixed()) return PointSource::pick(indices, batch);
        const size_t stride = layout_.schema.stride;
        batch.bytes.resize(indices.size() * stride);
        batch.count = 0;
        return for_picked(*file_, vertices_offset_, layout_.packed_bytes, indices, [&](const std::byte* at) {
            batch.count += layout_.unpack(at, &batch.bytes[batch.count * stride]);
        });
    }

 private:
    bool fixed() const { return header_.encoding != ply::Encoding::ascii && !header_.vertices().has_list(); }

    /// Passes over the elements before the vertices, and checks that these can be there.
    Result<void> find_vertices() {
        BufferedInput input(file_, header_.data_offset, file_->size());
        for (size_t e = 0; e < header_.vertex; ++e)
            LUCARNE_TRY(skip_element(input, header_, header_.elements[e]));
        vertices_offset_ = input.position();
        const auto& vertices = header_.vertices();
        // A word of text takes two bytes with what separates it, but for the very last.
        const uint64_t least =
            header_.encoding == ply::Encoding::ascii ? 2 * vertices.properties.size() : layout_.packed_bytes;
        const uint64_t there =
            (file_->size() - vertices_offset_ + (header_.encoding == ply::Encoding::ascii)) / least;
        if (salvage_.wanted) return clamp_vertices(there);
        if (vertices.count > there)
            return rejected(file_->path().string(),
                            fmt::format("is truncated: its header promises {} points, at most {} are there",
                                        vertices.count, there));
        return {};
    }

    Result<void> clamp_vertices(uint64_t there) {
        uint64_t& count = header_.elements[header_.vertex].count;
        if (count > there) {
            add_loss(info_.losses, lost::cut_off, count - there);
            count = there;
        }
        std::array<std::byte, 1> last{};
        LUCARNE_TRY(file_->read_at(file_->size() - 1, last));
        salvage_.open_end = static_cast<char>(last[0]) != header_.line_end;
        return {};
    }

    void note_what_is_not_read() {
        for (size_t e = 0; e < header_.elements.size(); ++e) {
            const auto& element = header_.elements[e];
            if (mesh_ && element.name == "face") continue;
            if (e != header_.vertex) {
                add_loss(info_.losses, fmt::format("entries of '{}', which are not read", printable(element.name)),
                         element.count);
                continue;
            }
            for (const auto& p : element.properties)
                if (p.count)
                    add_loss(info_.losses,
                             fmt::format("lists '{}' of points, which are not read", printable(p.name)),
                             element.count);
        }
    }

    /// Full intensity is told by the largest component of a sample: spread over the file where vertices can
    /// be addressed, else from its beginning. Nothing is converted, so a wrong guess loses nothing.
    Result<uint32_t> find_color_bits(std::optional<uint32_t> stated) const {
        const Attribute* color = layout_.schema.find(names::color);
        if (!color || color->type == ScalarType::u8) return 8u;
        if (stated) return *stated;
        constexpr uint64_t kBlocks = 64, kBlockPoints = 256;
        const uint64_t count = header_.vertices().count;
        const uint64_t step =
            fixed() ? std::max<uint64_t>(kBlockPoints, count / kBlocks) : std::max<uint64_t>(count, 1);
        double largest = 0;
        for (uint64_t first = 0; first < count; first += step) {
            PlyReader reader(file_, header_, layout_,
                             vertices_offset_ + (fixed() ? first * layout_.packed_bytes : 0), salvage_);
            PointBatch batch;
            const auto points =
                static_cast<size_t>(fixed() ? std::min(kBlockPoints, count - first) : kBlocks * kBlockPoints);
            // What is wrong further inside is for the real pass to report.
            if (!reader.read(batch, points)) break;
            for (size_t i = 0; i < batch.count * 3; ++i) {
                const std::byte* record = batch.bytes.data() + i / 3 * layout_.schema.stride;
                largest = std::max(largest, scalar_at(color->type, record + color->offset +
                                                                       i % 3 * scalar_bytes(color->type)));
            }
        }
        if (color->type == ScalarType::u16) return largest > 255 ? 16u : 8u;
        return largest > 255 ? 16u : largest > 1 ? 8u : 0u;
    }

    std::shared_ptr<const InputFile> file_;
    ply::Header header_;
    Salvage salvage_;
    bool mesh_;  ///< faces are read as well
    ply::Layout layout_;
    uint64_t vertices_offset_ = 0;
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_mesh(const std::shared_ptr<const InputFile>& file,
                                               const ply::Header& header, const ReadOptions& options) {
    auto vertices = std::make_unique<PlySource>(file, header, false, true);
    LUCARNE_TRY(vertices->describe(options));
    return ply::open_mesh(file, header, std::move(vertices), options);
}

Result<std::unique_ptr<PointSource>> open_ply(std::shared_ptr<const InputFile> file, const ReadOptions& options) {
    auto header = ply::read_header(file);
    if (header && ply::has_faces(*header) && !options.mesh.vertices) {
        auto mesh = open_mesh(file, *header, options);
        if (mesh || !options.salvage || mesh.error().kind != ErrorKind::input_rejected) return mesh;
    }
    // Of a damaged mesh the vertices.
    if (options.salvage) header = ply::read_header(file, true);
    if (!header) return tl::unexpected(std::move(header).error());
    auto source = std::make_unique<PlySource>(std::move(file), std::move(*header), options.salvage, false);
    LUCARNE_TRY(source->describe(options));
    return source;
}

bool is_ply(std::string_view head) {
    return head.starts_with("ply") && head.size() > 3 && (is_blank(head[3]) || head[3] == '\n');
}

}  // namespace

const Format& ply_format() {
    static constexpr Format kFormat{"PLY", ".ply", is_ply, open_ply, ply::create};
    return kFormat;
}

}  // namespace lucarne::io
