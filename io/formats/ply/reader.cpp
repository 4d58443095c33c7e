// PLY: ASCII, binary little and big endian. Source: see header.h.
#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/buffered_input.h"
#include "io/formats/common/color_depth.h"
#include "io/formats/common/format.h"
#include "io/formats/common/pick.h"
#include "io/formats/common/text.h"
#include "io/formats/ply/body.h"
#include "io/formats/ply/layout.h"
#include "io/formats/ply/mesh.h"
#include "io/formats/ply/splats.h"
#include "io/formats/ply/values.h"
#include "io/formats/ply/writer.h"

namespace lucarne::io {
namespace {

using namespace ply;

class PlyReader final : public PointReader {
 public:
    PlyReader(std::shared_ptr<const ByteSource> file, const ply::Header& header, const ply::Layout& layout,
              uint64_t offset, bool salvage)
        : input_(file, offset, file->size()),
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
            auto done = text ? parse_line()
                             : walk_entry(input_, header_.vertices(), layout_.big_endian, packed_.data());
            LUCARNE_ASSIGN(const auto fate, fate_of(std::move(done), input_, header_, header_.vertices(),
                                                    before, left_, salvage_));
            if (fate == Fate::kept) {
                take_point(packed_.data(), batch);
                continue;
            }
            const uint64_t lost = fate == Fate::lost ? 1 : left_;
            add_loss(lost_, fate == Fate::lost ? lost::damaged : lost::cut_off, lost);
            left_ -= lost;
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
        if (count == 0) return ends_early(input_, header_.vertices(), header_.vertices().count - left_ + 1);
        for (size_t i = 0; i < count; ++i) take_point(bytes.data() + i * layout_.packed_bytes, batch);
        input_.skip(count * layout_.packed_bytes);
        return {};
    }

    Result<void> parse_line() {
        const auto& vertices = header_.vertices();
        const uint64_t number = vertices.count - left_ + 1;
        LUCARNE_ASSIGN(std::string_view line, text_line(input_, header_, vertices, number));
        std::byte* at = packed_.data();
        for (const auto& p : vertices.properties) {
            const auto word = next_word(line);
            if (p.count) {
                const auto length = parse_number<uint32_t>(word);
                if (!length) return bad_word(input_, vertices, number, p.name, word);
                for (uint32_t i = 0; i < *length && !line.empty(); ++i) next_word(line);
                continue;
            }
            if (!parse_scalar(p.type, word, at)) return bad_word(input_, vertices, number, p.name, word);
            at += scalar_bytes(p.type);
        }
        if (!next_word(line).empty())
            return rejected(input_.path(),
                            fmt::format("vertex {} has more values than the header names", number));
        return {};
    }

    BufferedInput input_;
    const ply::Header& header_;
    const ply::Layout& layout_;
    bool salvage_;
    uint64_t left_, dropped_ = 0;
    Losses lost_;
    std::vector<std::byte> packed_;  ///< a vertex packed from words or from between lists
};

class PlySource final : public PointSource {
 public:
    PlySource(std::shared_ptr<const ByteSource> file, ply::Header header, bool salvage, bool faces_known)
        : file_(std::move(file)),
          header_(std::move(header)),
          salvage_(salvage),
          faces_known_(faces_known),
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
        set_unit(info_, options, remarks.metres_per_unit);
        LUCARNE_ASSIGN(const uint32_t color_bits, find_color_bits());
        info_.color_bits = remarks.color_bits.value_or(color_bits);
        if (layout_.flat) log::warn("{}: its vertices have no z, it is taken as 0", name);
        info_.notes.ply = ply::notes_of(header_);
        info_.notes.color_bits = info_.color_bits;
        return {};
    }

    const Schema& schema() const override { return layout_.schema; }
    const ScanInfo& info() const override { return info_; }
    /// Records the faces' losses when the vertices replace a mesh without any face left.
    void stand_in(const Losses& faces) {
        add_losses(info_.losses, faces);
        add_loss(info_.losses, lost::cut_off, cut_off_);
    }
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

    /// Skips the elements before the vertices, and checks that the vertices can be there.
    Result<void> find_vertices() {
        BufferedInput input(file_, header_.data_offset, file_->size());
        for (size_t e = 0; e < header_.vertex; ++e)
            LUCARNE_TRY(skip_element(input, header_, header_.elements[e]));
        vertices_offset_ = input.position();
        const auto& vertices = header_.vertices();
        // A word of text takes two bytes with its separator, except for the very last.
        const uint64_t least =
            header_.encoding == ply::Encoding::ascii ? 2 * vertices.properties.size() : layout_.packed_bytes;
        const uint64_t there =
            (file_->size() - vertices_offset_ + (header_.encoding == ply::Encoding::ascii)) / least;
        if (salvage_) {
            // For text one more, so that rows are known to be missing after the last line.
            clamp_vertices(there + (header_.encoding == ply::Encoding::ascii));
            return {};
        }
        if (vertices.count > there)
            return rejected(file_->path().string(),
                            fmt::format("is truncated: its header promises {} points, at most {} are there",
                                        vertices.count, there));
        return {};
    }

    void clamp_vertices(uint64_t there) {
        uint64_t& count = header_.elements[header_.vertex].count;
        if (count <= there) return;
        cut_off_ = count - there;
        if (!faces_known_) add_loss(info_.losses, lost::cut_off, cut_off_);
        count = there;
    }

    void note_what_is_not_read() {
        for (size_t e = 0; e < header_.elements.size(); ++e) {
            const auto& element = header_.elements[e];
            if (faces_known_ && element.name == "face") continue;
            if (e != header_.vertex) {
                add_loss(info_.losses,
                         fmt::format("entries of '{}', which are not read", printable(element.name)),
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

    /// Returns the earliest place where lines that are no vertices may begin: the next element, or the end.
    uint64_t end_of_lines() const {
        const auto& vertices = header_.vertices();
        const auto next = header_.elements.begin() + static_cast<std::ptrdiff_t>(header_.vertex) + 1;
        const bool last = std::all_of(next, header_.elements.end(),
                                      [](const Element& element) { return element.count == 0; });
        // A value takes two bytes with its separator.
        const uint64_t least = 2 * vertices.properties.size() * std::min(vertices.count, file_->size());
        return last ? file_->size() : std::min(file_->size(), vertices_offset_ + least);
    }

    /// Returns offsets. kBlockPoints vertices from each form a sample of all. With binary lists, which have
    /// any length, only a pass can tell where a vertex begins, so only the first offset is returned.
    Result<std::vector<uint64_t>> sample_places() const {
        std::vector<uint64_t> places = {vertices_offset_};
        const uint64_t count = header_.vertices().count;
        if (count <= kBlocks * kBlockPoints) return places;
        if (header_.encoding != ply::Encoding::ascii) return places;
        std::array<std::byte, size_t{1} << 16> bytes{};
        for (uint64_t block = 1; block < kBlocks; ++block) {
            const uint64_t at =
                vertices_offset_ + (end_of_lines() - vertices_offset_) / (kBlocks + 1) * block;
            LUCARNE_ASSIGN(const size_t got, file_->read_some(at, bytes));
            const auto* line_end = std::memchr(bytes.data(), header_.line_end, got);
            if (line_end)
                places.push_back(
                    at + 1 + static_cast<uint64_t>(static_cast<const std::byte*>(line_end) - bytes.data()));
        }
        return places;
    }

    /// Returns the colour bits that a sample needs.
    Result<uint32_t> find_color_bits() const {
        ColorDepth depth(layout_.schema);
        if (!depth.open()) return depth.bits();
        if (fixed()) return sampled_color_bits(*this);
        LUCARNE_ASSIGN(const auto places, sample_places());
        for (const uint64_t place : places) {
            PlyReader reader(file_, header_, layout_, place, {});
            PointBatch batch;
            // The real pass will report errors further inside.
            (void)reader.read(batch, places.size() > 1 ? kBlockPoints : kBlocks * kBlockPoints);
            depth.add(std::span(batch.bytes).first(batch.count * layout_.schema.stride));
        }
        return depth.bits();
    }

    static constexpr uint64_t kBlocks = 64, kBlockPoints = 256;  ///< of a sample

    std::shared_ptr<const ByteSource> file_;
    ply::Header header_;
    bool salvage_;
    bool faces_known_;  ///< someone else reads the mesh and reports its losses
    ply::Layout layout_;
    uint64_t vertices_offset_ = 0, cut_off_ = 0;
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_ply(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    LUCARNE_ASSIGN(auto header, ply::read_header(file, options.salvage));
    if (ply::has_packed_splats(header))
        return ply::open_packed_splats(std::move(file), std::move(header), options);
    LUCARNE_TRY(ply::fit_body(*file, header, options.salvage));
    if (ply::has_splats(header)) {
        ply::leave_out_harmonics(header);
        auto splats = std::make_unique<PlySource>(std::move(file), std::move(header), options.salvage, false);
        LUCARNE_TRY(splats->describe(options));
        return ply::open_splats(std::move(splats));
    }
    const bool mesh = ply::has_faces(header) && !options.mesh.vertices;
    auto vertices = std::make_unique<PlySource>(file, header, options.salvage, mesh);
    LUCARNE_TRY(vertices->describe(options));
    if (mesh) {
        LUCARNE_ASSIGN(auto faces, ply::open_mesh(file, header, vertices->info(), options));
        if (faces.mesh) return std::move(faces.mesh);
        vertices->stand_in(faces.losses);
    }
    return vertices;
}

/// Returns the triangles of a file; none if it has only vertices or splats.
Result<mesh::Mesh> load_ply(std::shared_ptr<const ByteSource> file, const ReadOptions& options) {
    LUCARNE_ASSIGN(auto header, ply::read_header(file, options.salvage));
    if (ply::has_packed_splats(header) || ply::has_splats(header) || !ply::has_faces(header))
        return mesh::Mesh{};
    LUCARNE_TRY(ply::fit_body(*file, header, options.salvage));
    PlySource vertices(file, header, options.salvage, true);
    LUCARNE_TRY(vertices.describe(options));
    return ply::load_mesh(file, header, vertices.info().color_bits, options.salvage);
}

bool is_ply(std::string_view head) {
    head = without_mark(head);
    return head.size() > 3 && same_letters(head.substr(0, 3), "ply") &&
           (is_blank(head[3]) || head[3] == '\n');
}

}  // namespace

const Format& ply_format() {
    static constexpr Format kFormat{"PLY", ".ply", is_ply, open_ply, ply::create, false, load_ply};
    return kFormat;
}

}  // namespace lucarne::io
