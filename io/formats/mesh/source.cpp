#include "io/formats/mesh/source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "io/formats/common/format.h"
#include "io/formats/mesh/sampler.h"
#include "io/formats/mesh/surface.h"

namespace lucarne::io::mesh {
namespace {

/// No spacing may be smaller than this share of the box's diagonal, because cells are counted in 32 bits.
constexpr double kLeastShare = 1e-6;

class SampleReader final : public PointReader {
 public:
    SampleReader(std::shared_ptr<const Mesh> mesh, const Schema& schema, double spacing)
        : mesh_(std::move(mesh)), schema_(schema), sampler_(*mesh_, spacing), surface_(*mesh_, spacing) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        if (given_ == samples_.size()) {
            given_ = 0;
            sampler_.next(samples_);
        }
        const size_t count = std::min(batch_limit(schema_, most), samples_.size() - given_);
        batch.count = count;
        batch.bytes.resize(count * schema_.stride);
        parallel_ranges(count, 4096, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i)
                fill(samples_[given_ + i], &batch.bytes[i * schema_.stride]);
        });
        given_ += count;
        return count;
    }
    uint64_t dropped() const override { return 0; }

 private:
    void fill(const Sample& sample, std::byte* record) const {
        // Far from the origin, coordinates may be coarser than the whole mesh, and thus than 2^31 steps.
        constexpr double kLeast = std::numeric_limits<int32_t>::min(),
                         kMost = std::numeric_limits<int32_t>::max();
        const glm::dvec3 steps =
            glm::clamp(glm::round((sample.position - schema_.offset) / schema_.scale), kLeast, kMost);
        for (int k = 0; k < 3; ++k) store(record + 4 * k, static_cast<int32_t>(steps[k]));
        const glm::vec3 normal = surface_.normal(sample);
        for (int k = 0; k < 3; ++k) store(record + 12 + 4 * k, normal[k]);
        if (schema_.attributes.size() == 1) return;
        const Color8 color = surface_.color(sample);
        for (size_t k = 0; k < 3; ++k) store(record + 24 + k, color[k]);
    }

    std::shared_ptr<const Mesh> mesh_;
    Schema schema_;
    Sampler sampler_;
    Surface surface_;
    std::vector<Sample> samples_;
    size_t given_ = 0;
};

class VertexReader final : public PointReader {
 public:
    VertexReader(std::shared_ptr<const Mesh> mesh, const Schema& schema)
        : mesh_(std::move(mesh)), schema_(schema) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const size_t stride = schema_.stride;
        batch.bytes.resize(std::min(batch_limit(schema_, most), mesh_->positions.size() - next_) * stride);
        batch.count = 0;
        for (; next_ < mesh_->positions.size() && (batch.count + 1) * stride <= batch.bytes.size(); ++next_) {
            const glm::dvec3& at = mesh_->positions[next_];
            const bool fine = usable(at.x) && usable(at.y) && usable(at.z);
            dropped_ += !fine;
            if (!fine) continue;
            std::byte* record = &batch.bytes[batch.count++ * stride];
            for (int k = 0; k < 3; ++k) store(record + 8 * k, at[k]);
            if (!mesh_->colors.empty())
                for (size_t k = 0; k < 3; ++k) store(record + 24 + k, mesh_->colors[next_][k]);
        }
        // All of these vertices may have been dropped although more follow.
        if (batch.count == 0 && next_ < mesh_->positions.size()) return read(batch, most);
        batch.bytes.resize(batch.count * stride);
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_; }

 private:
    std::shared_ptr<const Mesh> mesh_;
    Schema schema_;
    size_t next_ = 0;
    uint64_t dropped_ = 0;
};

class MeshSource final : public PointSource {
 public:
    MeshSource(Mesh mesh, Schema schema, ScanInfo info, double spacing)
        : mesh_(std::make_shared<const Mesh>(std::move(mesh))),
          schema_(std::move(schema)),
          info_(std::move(info)),
          spacing_(spacing) {}
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        if (spacing_ == 0) return std::make_unique<VertexReader>(mesh_, schema_);
        return std::make_unique<SampleReader>(mesh_, schema_, spacing_);
    }

 private:
    std::shared_ptr<const Mesh> mesh_;
    Schema schema_;
    ScanInfo info_;
    double spacing_;  ///< in the file's unit; 0 if there are only vertices
};

/// Returns the requested spacing, or a default, in the file's unit.
Result<double> spacing_of(const Mesh& mesh, const ScanInfo& info, const ReadOptions& options) {
    const double area = mesh.area(), diagonal = glm::length(mesh.high - mesh.low);
    const auto of_count = [&](uint64_t count) { return std::sqrt(area / static_cast<double>(count)); };
    const double least = std::max(of_count(kMostSamples), kLeastShare * diagonal);
    double spacing = 0;
    if (options.mesh.spacing > 0)
        spacing = options.mesh.spacing / info.metres_per_unit;
    else if (options.mesh.samples > 0)
        spacing = of_count(options.mesh.samples);
    if (spacing == 0) {
        spacing = std::min(diagonal / 1000, of_count(std::max<size_t>(1, mesh.positions.size())));
        return std::max({spacing, of_count(kMostDefaultSamples), least});
    }
    if (spacing >= least * (1 - 1e-9)) return spacing;
    return bad_arguments(
        options.mesh.spacing > 0 ? "--spacing" : "--mesh-points",
        fmt::format("{} would be sampled every {:.3g} m, at most {} samples and {:.3g} m are possible",
                    info.path, spacing * info.metres_per_unit, kMostSamples, least * info.metres_per_unit),
        "ask for fewer");
}

/// Positions in steps of a power of ten, as fine as 32 bits allow.
Schema sample_schema(const Mesh& mesh) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.stride = position_bytes(schema.position);
    const glm::dvec3 size = mesh.high - mesh.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double step = std::pow(10.0, std::clamp(std::ceil(std::log10(longest / 4e9)), -30.0, 30.0));
    schema.scale = glm::dvec3(step);
    const glm::dvec3 middle = (mesh.low + mesh.high) * 0.5;
    // A whole multiple of a million steps, so that coordinates are decimal fractions as well.
    schema.offset = glm::round(middle / (step * 1e6)) * (step * 1e6);
    schema.add(std::string(names::normal), ScalarType::f32, 3);
    if (mesh.colored()) schema.add(std::string(names::color), ScalarType::u8, 3);
    return schema;
}

/// Completes the notes that the reader of the file has made.
MeshNotes& note(const Mesh& mesh, ScanInfo& info) {
    info.notes.color_bits = info.color_bits = 8;
    if (!info.notes.mesh) info.notes.mesh.emplace();
    MeshNotes& notes = *info.notes.mesh;
    notes.vertices = mesh.positions.size();
    notes.triangles = mesh.triangles.size();
    notes.textures = mesh.textures.size();
    notes.without_area = mesh.without_area;
    notes.not_finite = mesh.not_finite;
    return notes;
}

}  // namespace

bool is_sampled(const ScanInfo& info) {
    return info.notes.mesh && info.notes.mesh->samples;
}

Result<std::unique_ptr<PointSource>> sampled(Mesh mesh, ScanInfo info, uint64_t state,
                                             const ReadOptions& options) {
    LUCARNE_ASSIGN(const double spacing, spacing_of(mesh, info, options));
    if (mesh.not_finite > 0)
        log::warn("{}: {} with a coordinate that is not finite: left out", info.path,
                  counted(mesh.not_finite, "triangles"));
    if (mesh.fanned > 0)
        log::warn("{}: {} with over 256 corners: cut as fans, which is wrong if they are not convex",
                  info.path, counted(mesh.fanned, "polygons"));
    const double metres = info.metres_per_unit;
    info.declared_points = static_cast<uint64_t>(mesh.area() / (spacing * spacing));
    if (!options.quiet)
        log::info(
            "{}: a mesh of {:.6g} m2, sampled every {:.3g} m: about {}; --spacing or --mesh-points can say "
            "otherwise",
            info.path, mesh.area() * metres * metres, spacing * metres,
            counted(info.declared_points, "points"));
    note(mesh, info).samples = {mesh.area() * metres * metres, spacing * metres, info.declared_points,
                                mesh.low, mesh.high};
    // A change of any of these makes a cache of these samples out of date.
    info.modified = static_cast<int64_t>(
        mix64(mix64(static_cast<uint64_t>(info.modified), std::bit_cast<uint64_t>(spacing)), state));
    Schema schema = sample_schema(mesh);
    return std::make_unique<MeshSource>(std::move(mesh), std::move(schema), std::move(info), spacing);
}

Result<std::unique_ptr<PointSource>> vertices_only(Mesh mesh, ScanInfo info) {
    Schema schema;
    if (!mesh.colors.empty()) schema.add(std::string(names::color), ScalarType::u8, 3);
    info.declared_points = mesh.positions.size();
    note(mesh, info);
    return std::make_unique<MeshSource>(std::move(mesh), std::move(schema), std::move(info), 0.0);
}

}  // namespace lucarne::io::mesh
