#include "io/formats/ply/splats.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/formats/common/format.h"
#include "io/formats/common/text.h"
#include "io/formats/ply/splat_points.h"

namespace lucarne::io::ply {
namespace {

constexpr std::array<std::string_view, 3> kColors = {"f_dc_0", "f_dc_1", "f_dc_2"},
                                          kScales = {"scale_0", "scale_1", "scale_2"};
constexpr std::array<std::string_view, 4> kRotations = {"rot_0", "rot_1", "rot_2", "rot_3"};
constexpr std::string_view kOpacity = "opacity";
/// The constant spherical harmonic, 1 / (2 sqrt(pi)).
constexpr float kHarmonic0 = 0.28209479f;

bool has_number(const Element& vertices, std::string_view name) {
    return std::ranges::any_of(vertices.properties, [&](const Property& p) {
        return p.name == name && !p.count && (p.type == ScalarType::f32 || p.type == ScalarType::f64);
    });
}

/// Reads the properties of a splat from the record that plain vertices have.
class SplatDecoder {
 public:
    explicit SplatDecoder(const Schema& from) : from_(from) {
        for (size_t c = 0; c < 3; ++c) color_[c] = from.find(kColors[c]), scale_[c] = from.find(kScales[c]);
        for (size_t c = 0; c < 4; ++c) rotation_[c] = from.find(kRotations[c]);
        opacity_ = from.find(kOpacity);
    }
    Splat of(const std::byte* record) const {
        const auto value = [&](const Attribute* a) {
            return static_cast<float>(scalar_at(a->type, record + a->offset));
        };
        Splat splat;
        for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<size_t>(c);
            splat.color[c] = 0.5f + kHarmonic0 * value(color_[i]);
            splat.scale[c] = scale_[i] ? std::exp(value(scale_[i])) : 0.0f;  // 2D splats have no third
        }
        splat.opacity = 1 / (1 + std::exp(-value(opacity_)));
        splat.rotation = {value(rotation_[0]), value(rotation_[1]), value(rotation_[2]), value(rotation_[3])};
        return splat;
    }
    size_t stride() const { return from_.stride; }

 private:
    const Schema& from_;
    std::array<const Attribute*, 3> color_{}, scale_{};
    std::array<const Attribute*, 4> rotation_{};
    const Attribute* opacity_ = nullptr;
};

/// Replaces the records of plain vertices by those of splats. Returns how many are left out.
uint64_t convert(const SplatDecoder& decoder, const Schema& to, const PointBatch& from, PointBatch& batch) {
    const size_t position = position_bytes(to.position);
    batch.bytes.resize(from.count * to.stride);
    batch.count = 0;
    for (size_t i = 0; i < from.count; ++i) {
        const std::byte* in = &from.bytes[i * decoder.stride()];
        std::byte* out = batch.bytes.data() + batch.count * to.stride;
        std::memcpy(out, in, position);
        batch.count += write_splat(decoder.of(in), out + position);
    }
    batch.bytes.resize(batch.count * to.stride);
    return from.count - batch.count;
}

class SplatReader final : public PointReader {
 public:
    SplatReader(std::unique_ptr<PointReader> vertices, const SplatDecoder& decoder, const Schema& schema)
        : vertices_(std::move(vertices)), decoder_(decoder), schema_(schema) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        for (;;) {  // a whole batch may be transparent
            LUCARNE_ASSIGN(const size_t count, vertices_->read(raw_, most));
            transparent_ += convert(decoder_, schema_, raw_, batch);
            if (count == 0 || batch.count > 0) return batch.count;
        }
    }
    uint64_t dropped() const override { return vertices_->dropped() + transparent_; }
    Losses losses() const override {
        Losses losses = vertices_->losses();
        add_loss(losses, kNearlyTransparent, transparent_);
        return losses;
    }

 private:
    std::unique_ptr<PointReader> vertices_;
    const SplatDecoder& decoder_;
    const Schema& schema_;
    PointBatch raw_;
    uint64_t transparent_ = 0;
};

class SplatSource final : public PointSource {
 public:
    explicit SplatSource(std::unique_ptr<PointSource> vertices)
        : vertices_(std::move(vertices)), decoder_(vertices_->schema()), info_(vertices_->info()) {
        schema_.position = vertices_->schema().position;
        schema_.stride = static_cast<uint32_t>(position_bytes(schema_.position));
        add_splat_attributes(schema_);
        info_.format += ", Gaussian splats";
        info_.notes.color_bits = info_.color_bits = 8;
    }
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        LUCARNE_ASSIGN(auto reader, vertices_->open());
        return std::make_unique<SplatReader>(std::move(reader), decoder_, schema_);
    }
    bool seekable() const override { return vertices_->seekable(); }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        PointBatch raw;
        LUCARNE_TRY(vertices_->pick(indices, raw));
        raw.bytes.resize(raw.count * decoder_.stride());
        convert(decoder_, schema_, raw, batch);
        return {};
    }

 private:
    std::unique_ptr<PointSource> vertices_;
    SplatDecoder decoder_;
    Schema schema_;
    ScanInfo info_;
};

}  // namespace

bool has_splats(const Header& header) {
    const Element& vertices = header.vertices();
    const auto all = [&](std::span<const std::string_view> names) {
        return std::ranges::all_of(names, [&](auto name) { return has_number(vertices, name); });
    };
    return all(kColors) && all(std::span(kScales).first(2)) && all(kRotations) &&
           has_number(vertices, kOpacity);
}

void leave_out_harmonics(Header& header) {
    constexpr std::array<std::string_view, 3> kZeros = {"nx", "ny", "nz"};
    for (Property& p : header.elements[header.vertex].properties)
        if (!p.count && (p.name.starts_with("f_rest_") || std::ranges::find(kZeros, p.name) != kZeros.end()))
            p.name.clear();
}

std::unique_ptr<PointSource> open_splats(std::unique_ptr<PointSource> vertices) {
    return std::make_unique<SplatSource>(std::move(vertices));
}

}  // namespace lucarne::io::ply
