// Splats in PlayCanvas' compressed layout: four words each, relative to the bounds of chunks of 256 splats.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "io/formats/common/buffered_input.h"
#include "io/formats/common/format.h"
#include "io/formats/common/pick.h"
#include "io/formats/ply/splat_points.h"
#include "io/formats/ply/splats.h"
#include "io/formats/ply/values.h"

namespace lucarne::io::ply {
namespace {

constexpr uint64_t kChunkSplats = 256;
constexpr std::array<std::string_view, 4> kWords = {"packed_position", "packed_rotation", "packed_scale",
                                                    "packed_color"};
constexpr std::array<std::string_view, 18> kBounds = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};
constexpr size_t kWithoutColors = 12;  ///< older files have no bounds of colours: these are 0 and 1

/// Returns the offset of a property in a binary record; empty if there is none of this type.
std::optional<size_t> offset_of(const Element& element, std::string_view name, ScalarType type) {
    size_t offset = 0;
    for (const Property& p : element.properties) {
        if (p.name == name) return p.type == type && !p.count ? std::optional(offset) : std::nullopt;
        offset += scalar_bytes(p.type);
    }
    return std::nullopt;
}

/// The place of everything in the file.
struct PackedLayout {
    uint64_t chunks_at = 0, splats_at = 0;
    size_t chunk_bytes = 0, splat_bytes = 0;
    uint64_t splats = 0;
    std::array<size_t, 4> words{};
    std::array<size_t, 18> bounds{};
    size_t bound_count = kWithoutColors;
};

/// The bounds of a chunk.
using Bounds = std::array<float, 18>;

Bounds bounds_of(const PackedLayout& layout, const std::byte* chunk) {
    Bounds bounds{};
    for (size_t i = 15; i < 18; ++i) bounds[i] = 1;
    for (size_t i = 0; i < layout.bound_count; ++i) bounds[i] = load<float>(chunk + layout.bounds[i]);
    return bounds;
}

/// Returns the `bits` bits of a word above `shift`, as a share of the largest value.
float share(uint32_t word, unsigned shift, unsigned bits) {
    const uint32_t most = (1u << bits) - 1;
    return static_cast<float>(word >> shift & most) / static_cast<float>(most);
}

/// Returns three numbers of 11, 10 and 11 bits between bounds number `first` and `first + 3`.
glm::vec3 between(uint32_t word, const Bounds& bounds, size_t first) {
    const std::array<float, 3> shares = {share(word, 21, 11), share(word, 11, 10), share(word, 0, 11)};
    glm::vec3 value;
    for (size_t i = 0; i < 3; ++i)
        value[static_cast<int>(i)] =
            bounds[first + i] + shares[i] * (bounds[first + 3 + i] - bounds[first + i]);
    return value;
}

/// The two highest bits tell which component is the largest; the other three follow, each times sqrt(2), from
/// -1 to 1.
glm::quat rotation_of(uint32_t word) {
    constexpr float kRange = 1.41421356f;
    const uint32_t largest = word >> 30;
    std::array<float, 4> q{};
    float squares = 0;
    unsigned shift = 20;
    for (uint32_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        q[i] = (share(word, shift, 10) - 0.5f) * kRange;
        squares += q[i] * q[i];
        shift -= 10;
    }
    q[largest] = std::sqrt(std::max(0.0f, 1 - squares));
    return {q[0], q[1], q[2], q[3]};
}

enum class Outcome { kept, transparent, no_number };

/// Writes the record of a splat.
Outcome unpack(const PackedLayout& layout, const Bounds& bounds, const std::byte* packed, std::byte* record) {
    const auto word = [&](size_t i) { return load<uint32_t>(packed + layout.words[i]); };
    const glm::vec3 position = between(word(0), bounds, 0);
    if (!usable(position.x) || !usable(position.y) || !usable(position.z)) return Outcome::no_number;
    store(record, position);
    Splat splat;
    const glm::vec3 logarithms = between(word(2), bounds, 6);
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        splat.scale[c] = std::exp(logarithms[c]);
        splat.color[c] = bounds[12 + i] + share(word(3), 24 - 8 * static_cast<unsigned>(c), 8) *
                                              (bounds[15 + i] - bounds[12 + i]);
    }
    splat.opacity = share(word(3), 0, 8);
    splat.rotation = rotation_of(word(1));
    return write_splat(splat, record + position_bytes(PositionType::f32)) ? Outcome::kept
                                                                          : Outcome::transparent;
}

class PackedReader final : public PointReader {
 public:
    PackedReader(const std::shared_ptr<const ByteSource>& file, const PackedLayout& layout,
                 const Schema& schema)
        : layout_(layout),
          schema_(schema),
          chunks_(file, layout.chunks_at, layout.splats_at),
          splats_(file, layout.splats_at, layout.splats_at + layout.splats * layout.splat_bytes) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const size_t wanted = batch_limit(schema_, most);
        batch.bytes.resize(static_cast<size_t>(std::min<uint64_t>(wanted, layout_.splats - done_)) *
                           schema_.stride);
        batch.count = 0;
        for (; batch.count < wanted && done_ < layout_.splats; ++done_) {
            if (done_ % kChunkSplats == 0) {
                LUCARNE_ASSIGN(const std::byte* chunk, take(chunks_, layout_.chunk_bytes));
                bounds_ = bounds_of(layout_, chunk);
            }
            LUCARNE_ASSIGN(const std::byte* packed, take(splats_, layout_.splat_bytes));
            const auto outcome =
                unpack(layout_, bounds_, packed, batch.bytes.data() + batch.count * schema_.stride);
            batch.count += outcome == Outcome::kept;
            transparent_ += outcome == Outcome::transparent;
            no_number_ += outcome == Outcome::no_number;
        }
        batch.bytes.resize(batch.count * schema_.stride);
        return batch.count;
    }
    uint64_t dropped() const override { return transparent_ + no_number_; }
    Losses losses() const override {
        Losses losses;
        add_loss(losses, lost::no_number, no_number_);
        add_loss(losses, kNearlyTransparent, transparent_);
        return losses;
    }

 private:
    const PackedLayout& layout_;
    const Schema& schema_;
    BufferedInput chunks_, splats_;
    Bounds bounds_{};
    uint64_t done_ = 0, transparent_ = 0, no_number_ = 0;
};

class PackedSource final : public PointSource {
 public:
    PackedSource(std::shared_ptr<const ByteSource> file, Header header)
        : file_(std::move(file)), header_(std::move(header)) {
        schema_.position = PositionType::f32;
        schema_.stride = static_cast<uint32_t>(position_bytes(PositionType::f32));
        add_splat_attributes(schema_);
    }

    Result<void> describe(const ReadOptions& options) {
        LUCARNE_TRY(find_layout());
        info_.path = file_->path().string();
        info_.format = "PLY, binary little endian, compressed Gaussian splats";
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        LUCARNE_ASSIGN(auto remarks, remarks_of(info_.path, header_.comments));
        info_.stations = std::move(remarks.stations);
        set_unit(info_, options, remarks.metres_per_unit);
        info_.notes.color_bits = info_.color_bits = 8;
        for (const Element& element : header_.elements)
            if (element.name != "vertex" && element.name != "chunk")
                add_loss(info_.losses,
                         fmt::format("entries of '{}', which are not read", printable(element.name)),
                         element.count);
        return check_size(options.salvage);
    }

    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        return std::make_unique<PackedReader>(file_, layout_, schema_);
    }
    bool seekable() const override { return true; }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        batch.bytes.resize(indices.size() * schema_.stride);
        batch.count = 0;
        std::vector<uint64_t> chunks;
        for (const uint64_t index : indices)
            if (chunks.empty() || chunks.back() != index / kChunkSplats)
                chunks.push_back(index / kChunkSplats);
        std::vector<Bounds> bounds;
        LUCARNE_TRY(for_picked(*file_, layout_.chunks_at, layout_.chunk_bytes, chunks,
                               [&](const std::byte* chunk) { bounds.push_back(bounds_of(layout_, chunk)); }));
        size_t next = 0, chunk = 0;
        return for_picked(
            *file_, layout_.splats_at, layout_.splat_bytes, indices, [&](const std::byte* packed) {
                const uint64_t own = indices[next++] / kChunkSplats;
                while (chunks[chunk] != own) ++chunk;
                batch.count += unpack(layout_, bounds[chunk], packed,
                                      &batch.bytes[batch.count * schema_.stride]) == Outcome::kept;
            });
    }

 private:
    tl::unexpected<Error> wrong(std::string why) const {
        return rejected(file_->path().string(), std::move(why));
    }

    Result<void> find_layout() {
        if (header_.encoding != Encoding::little_endian)
            return wrong("has compressed splats, but is not binary little-endian");
        uint64_t at = header_.data_offset;
        const Element *chunks = nullptr, *splats = nullptr;
        for (const Element& element : header_.elements) {
            if (splats) break;  // what follows is not read
            if (element.has_list()) return wrong("has compressed splats after lists");
            (element.name == "chunk" ? layout_.chunks_at : layout_.splats_at) = at;
            if (element.name == "chunk") chunks = &element;
            if (element.name == "vertex") splats = &element;
            const uint64_t bytes = std::max<uint64_t>(1, element.record_bytes());
            if (element.count > (UINT64_MAX / 4 - at) / bytes)
                return wrong("cannot hold what its header promises");
            at += element.count * element.record_bytes();
        }
        if (!chunks || !splats ||
            layout_.chunks_at + chunks->count * chunks->record_bytes() != layout_.splats_at)
            return wrong("has compressed splats without chunks before them");
        for (size_t i = 0; i < kWords.size(); ++i) {
            const auto offset = offset_of(*splats, kWords[i], ScalarType::u32);
            if (!offset)
                return wrong(fmt::format("has compressed splats without {} of type uint", kWords[i]));
            layout_.words[i] = *offset;
        }
        for (size_t i = 0; i < kBounds.size(); ++i) {
            const auto offset = offset_of(*chunks, kBounds[i], ScalarType::f32);
            if (!offset && i == kWithoutColors) break;
            if (!offset)
                return wrong(fmt::format("has chunks of splats without {} of type float", kBounds[i]));
            layout_.bounds[i] = *offset;
            layout_.bound_count = i + 1;
        }
        layout_.chunk_bytes = chunks->record_bytes();
        layout_.splat_bytes = splats->record_bytes();
        if (layout_.chunk_bytes > BufferedInput::kLargestPeek ||
            layout_.splat_bytes > BufferedInput::kLargestPeek)
            return wrong("has splats of too many properties");
        layout_.splats = splats->count;
        if ((splats->count + kChunkSplats - 1) / kChunkSplats > chunks->count)
            return wrong(fmt::format("has {} chunks for {} splats, {} each", chunks->count, splats->count,
                                     kChunkSplats));
        return {};
    }

    Result<void> check_size(bool salvage) {
        const uint64_t there =
            file_->size() > layout_.splats_at ? (file_->size() - layout_.splats_at) / layout_.splat_bytes : 0;
        if (layout_.splats > there) {
            if (!salvage)
                return wrong(fmt::format("is truncated: its header promises {} splats, at most {} are there",
                                         layout_.splats, there));
            add_loss(info_.losses, lost::cut_off, layout_.splats - there);
            layout_.splats = there;
        }
        info_.declared_points = layout_.splats;
        return {};
    }

    std::shared_ptr<const ByteSource> file_;
    Header header_;
    PackedLayout layout_;
    Schema schema_;
    ScanInfo info_;
};

}  // namespace

bool has_packed_splats(const Header& header) {
    return std::ranges::any_of(header.vertices().properties,
                               [](const Property& p) { return p.name == kWords[0]; });
}

Result<std::unique_ptr<PointSource>> open_packed_splats(std::shared_ptr<const ByteSource> file, Header header,
                                                        const ReadOptions& options) {
    auto source = std::make_unique<PackedSource>(std::move(file), std::move(header));
    LUCARNE_TRY(source->describe(options));
    return source;
}

}  // namespace lucarne::io::ply
