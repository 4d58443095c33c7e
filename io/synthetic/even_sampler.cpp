// Samples a surface evenly by area, point by point.
//
// Each patch gets its share of the points and is cut into rows as high as those of a hexagonal lattice of
// that density. Each row gets its share of the patch by the area below it. Its points stand at equal steps of
// area, and every other row is shifted by half a step. Each point is then moved at random by up to kJitter of
// its cell in both directions. Equal steps of area keep the density uniform on curved and tapering patches,
// and jittered strata have no clumps and no holes (stratified sampling on a surface, as in: Turk, Generating
// random points in triangles, 1990; Cook, Stochastic sampling in computer graphics, 1986). A point follows
// from its number alone; nothing is stored.
#include <algorithm>
#include <cmath>

#include "io/core/random.h"
#include "io/synthetic/generator.h"

namespace lucarne::io {
namespace {

constexpr uint64_t kPiecePoints = 16384;
constexpr double kJitter = .3;  ///< share of the cell to either side; .5 would be plain jittered strata

/// A place in a patch: its band, and the fraction of that band's height.
struct Level {
    const PatchBand* band;
    double s;
};

/// The points of one patch: their number, the number of rows, and the place of each point.
class PatchRows {
 public:
    PatchRows(const PatchMesh& mesh, const Patch& patch, uint64_t points, double row_height)
        : mesh_(&mesh),
          patch_(&patch),
          points_(points),
          rows_(std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(patch.height / row_height)))) {}

    uint64_t first_of_row(uint64_t row) const {
        if (row >= rows_) return points_;
        const double height = patch_->height * static_cast<double>(row) / static_cast<double>(rows_);
        return static_cast<uint64_t>(
            std::llround(static_cast<double>(points_) * (area_below(height) / patch_->area)));
    }
    uint64_t row_of(uint64_t point) const {
        const double area = (static_cast<double>(point) + .5) / static_cast<double>(points_) * patch_->area;
        const Level level = level_at(area);
        const double height = level.band->height_before + level.s * level.band->height;
        auto row =
            std::min(rows_ - 1, static_cast<uint64_t>(height / patch_->height * static_cast<double>(rows_)));
        while (first_of_row(row) > point) --row;
        while (first_of_row(row + 1) <= point) ++row;
        return row;
    }
    /// Returns the level below which this much of the patch's area lies.
    Level level_at(double area) const {
        const PatchBand* first = &mesh_->bands[patch_->first_band];
        const PatchBand* band =
            std::upper_bound(first + 1, first + patch_->bands, area,
                             [](double a, const PatchBand& b) { return a < b.area_before; }) -
            1;
        // Solves low s + (high - low) s^2 / 2 = rest without cancellation.
        const double rest = std::clamp(area - band->area_before, 0.0, band->area());
        const double root =
            std::sqrt(std::max(0.0, band->low * band->low + 2 * (band->high - band->low) * rest));
        return {band, rest > 0 ? std::min(1.0, 2 * rest / (band->low + root)) : 0.0};
    }
    const Patch& patch() const { return *patch_; }
    uint64_t points() const { return points_; }

 private:
    double area_below(double height) const {
        const PatchBand* first = &mesh_->bands[patch_->first_band];
        const PatchBand* band =
            std::upper_bound(first + 1, first + patch_->bands, height,
                             [](double h, const PatchBand& b) { return h < b.height_before; }) -
            1;
        const double s = std::clamp((height - band->height_before) / band->height, 0.0, 1.0);
        return band->area_before + band->low * s + (band->high - band->low) * s * s / 2;
    }

    const PatchMesh* mesh_;
    const Patch* patch_;
    uint64_t points_, rows_;
};

class EvenSampler final : public PieceGenerator {
 public:
    EvenSampler(std::shared_ptr<const SceneGeometry> geometry, const RecordPacker& packer, uint64_t points,
                uint64_t seed)
        : geometry_(std::move(geometry)), packer_(packer), points_(points), seed_(mix64(seed)) {
        // In a hexagonal lattice whose cells have the area a, the rows are sqrt(a sqrt(3) / 2) apart.
        const double cell = geometry_->area() / static_cast<double>(points);
        row_height_ = std::sqrt(cell * std::sqrt(3.0) / 2);
    }
    uint64_t pieces() const override { return (points_ + kPiecePoints - 1) / kPiecePoints; }

    void generate(uint64_t piece, std::vector<std::byte>& records) const override {
        const auto& patches = mesh().patches;
        uint64_t index = piece * kPiecePoints;
        const uint64_t last = std::min(points_, index + kPiecePoints);
        records.reserve(static_cast<size_t>(last - index) * packer_.schema().stride);
        // Finds the last patch that starts at or before the index. A patch without points starts where the
        // next one does.
        size_t at = 0;
        for (size_t low = 0, high = patches.size(); low < high;) {
            const size_t middle = (low + high) / 2;
            if (first_of_patch(middle) <= index)
                at = middle, low = middle + 1;
            else
                high = middle;
        }
        for (; index < last; ++at) {
            const uint64_t first = first_of_patch(at), end = first_of_patch(at + 1);
            if (end <= index) continue;
            const PatchRows rows(mesh(), patches[at], end - first, row_height_);
            const uint64_t stop = std::min(end, last);
            for (uint64_t row = rows.row_of(index - first); index < stop; ++row)
                index = add_row(rows, row, first, index, stop, records);
        }
    }

 private:
    const PatchMesh& mesh() const { return geometry_->mesh(); }

    uint64_t first_of_patch(size_t patch) const {
        if (patch >= mesh().patches.size()) return points_;
        const double share = mesh().patches[patch].area_before / mesh().area();
        return static_cast<uint64_t>(std::llround(static_cast<double>(points_) * share));
    }

    /// Adds the points of a row from number `index` up to `stop`. Returns the number after the last.
    uint64_t add_row(const PatchRows& rows, uint64_t row, uint64_t first, uint64_t index, uint64_t stop,
                     std::vector<std::byte>& records) const {
        const uint64_t begin = rows.first_of_row(row), count = rows.first_of_row(row + 1) - begin;
        const uint64_t end = std::min(stop, first + begin + count);
        const double shift = (row & 1) != 0 ? .75 : .25;
        for (; index < end; ++index) {
            const uint64_t random = mix64(seed_ ^ index);
            const double jitter_t = kJitter * (static_cast<double>(random >> 32) * 0x1p-31 - 1);
            const double jitter_s = kJitter * (static_cast<double>(random & 0xffffffffu) * 0x1p-31 - 1);
            const auto step = static_cast<double>(index - first - begin);
            double t = (step + shift + jitter_t) / static_cast<double>(count);
            t -= std::floor(t);
            const double share = (static_cast<double>(begin) + static_cast<double>(count) * (.5 + jitter_s)) /
                                 static_cast<double>(rows.points());
            add_point(rows.level_at(share * rows.patch().area), t, rows.patch().finish, records);
        }
        return index;
    }

    /// Adds the point at the share t of the row's area at a level.
    void add_point(const Level& level, double t, Finish finish, std::vector<std::byte>& records) const {
        const PatchBand& band = *level.band;
        const auto before = [&](size_t quad) {
            return mesh().low_before[quad] * (1 - level.s) + mesh().high_before[quad] * level.s;
        };
        const double whole = band.low * (1 - level.s) + band.high * level.s;
        size_t quad = band.first_quad, end = quad + band.quads;
        while (end - quad > 1) {
            const size_t middle = (quad + end) / 2;
            (before(middle) <= t * whole ? quad : end) = middle;
        }
        const double start = before(quad),
                     stop = quad + 1 < band.first_quad + band.quads ? before(quad + 1) : whole;
        const double in_quad = stop > start ? std::clamp((t * whole - start) / (stop - start), 0.0, 1.0) : .5;
        RecordPacker::Point point;
        point.position = mesh().position(quad, in_quad, level.s);
        point.normal = mesh().normal(quad, in_quad, level.s);
        point.albedo = albedo_at(finish, point.position, point.normal);
        point.signal = (point.albedo.x + point.albedo.y + point.albedo.z) / 3;
        packer_.append(point, records);
    }

    std::shared_ptr<const SceneGeometry> geometry_;
    RecordPacker packer_;
    uint64_t points_, seed_;
    double row_height_;
};

}  // namespace

std::unique_ptr<PieceGenerator> make_even_sampler(std::shared_ptr<const SceneGeometry> geometry,
                                                  const RecordPacker& packer, uint64_t points,
                                                  uint64_t seed) {
    return std::make_unique<EvenSampler>(std::move(geometry), packer, points, seed);
}

}  // namespace lucarne::io
