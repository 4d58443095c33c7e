// A terrestrial laser scanner: a mirror sweeps vertical lines while the head makes one turn.
//
// Each beam has a width. A second ray inside the beam tells whether it straddles an edge in depth. On an
// edge, most beams report the mean range of their whole footprint: the mixed pixels that real phase scanners
// leave behind edges. Beams are lost where little light comes back: on dark, far or grazing surfaces.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "io/core/random.h"
#include "io/synthetic/generator.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

constexpr uint64_t kPieceRays = 8192;
constexpr double kLowest = -62 * M_PI / 180,
                 kHighest = M_PI / 2;                       ///< elevations; the tripod hides what is lower
constexpr double kExitRadius = .003, kDivergence = .00015;  ///< radius (m), half angle (rad)
constexpr double kEdgeDepth = .02;  ///< difference of two ranges in a beam that counts as an edge, metres
constexpr int kFootprintRays = 6;
constexpr double kMixedShare = .8;      ///< share of the beams on an edge; the others report their centre
constexpr double kReferenceRange = 15;  ///< metres; beyond it the signal falls with the square of the range
constexpr double kLostBelow = .002, kKeptAbove = .02;  ///< between these signals a return may be lost
constexpr double kAlwaysLost = .002;                   ///< share that is lost for no visible reason
constexpr uint64_t kPilotRays = 1 << 14;

/// One sweep: lines of constant azimuth, with equal angular steps in both directions.
struct Sweep {
    uint64_t lines = 1, beams = 1;
    uint64_t rays() const { return lines * beams; }
    static Sweep of(double rays) {
        const double step = std::sqrt(2 * M_PI * (kHighest - kLowest) / std::max(1.0, rays));
        return {static_cast<uint64_t>(std::max(1.0, std::round(2 * M_PI / step))),
                static_cast<uint64_t>(std::max(1.0, std::round((kHighest - kLowest) / step)))};
    }
};

/// The cone of one pulse.
struct Beam {
    dvec3 origin, direction, side, up;  ///< side and up are as long as the beam's half angle, in radians

    Beam(const dvec3& from, const dvec3& towards, double range) : origin(from), direction(towards) {
        const double half_angle = kExitRadius / std::max(range, kExitRadius) + kDivergence;
        const dvec3 other = std::abs(direction.z) < .9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0);
        side = glm::normalize(cross(direction, other)) * half_angle;
        up = cross(side, direction);
    }
    /// Returns a direction inside the beam, uniform over its disc.
    dvec3 inside(Random& random) const {
        const double radius = std::sqrt(random.uniform()), angle = 2 * M_PI * random.uniform();
        return glm::normalize(direction + side * (radius * std::cos(angle)) +
                              up * (radius * std::sin(angle)));
    }
};

class Scanner final : public PieceGenerator {
 public:
    Scanner(std::shared_ptr<const SceneGeometry> geometry, const RecordPacker& packer, const ScanSetup& setup)
        : geometry_(std::move(geometry)), packer_(packer), setup_(setup) {
        const double wanted = static_cast<double>(setup.points) / static_cast<double>(setup.stations.size());
        for (size_t station = 0; station < setup.stations.size(); ++station) {
            // A coarse sweep first tells which share of the beams comes back.
            const double share =
                static_cast<double>(pilot(station)) / static_cast<double>(kPilotSweep.rays());
            sweeps_.push_back(Sweep::of(share > 0 ? wanted / share : 0));
            pieces_before_.push_back(pieces_);
            pieces_ += (sweeps_.back().rays() + kPieceRays - 1) / kPieceRays;
        }
    }
    uint64_t pieces() const override { return pieces_; }

    void generate(uint64_t piece, std::vector<std::byte>& records) const override {
        const auto after = std::upper_bound(pieces_before_.begin(), pieces_before_.end(), piece);
        const auto station = static_cast<size_t>(after - pieces_before_.begin()) - 1;
        const Sweep& sweep = sweeps_[station];
        const uint64_t first = (piece - pieces_before_[station]) * kPieceRays;
        const uint64_t last = std::min(sweep.rays(), first + kPieceRays);
        for (uint64_t ray = first; ray < last; ++ray)
            if (const auto point = shoot(station, sweep, ray)) packer_.append(*point, records);
    }

 private:
    inline static const Sweep kPilotSweep = Sweep::of(static_cast<double>(kPilotRays));

    uint64_t pilot(size_t station) const {
        std::atomic<uint64_t> returned{0};
        parallel_ranges(kPilotSweep.rays(), 1024, [&](size_t first, size_t last) {
            uint64_t here = 0;
            for (size_t ray = first; ray < last; ++ray)
                here += shoot(station, kPilotSweep, ray).has_value() ? 1 : 0;
            returned += here;
        });
        return returned;
    }

    std::optional<RecordPacker::Point> shoot(size_t station, const Sweep& sweep, uint64_t ray) const {
        Random random(mix64(setup_.seed, station), ray);
        const dvec3& origin = setup_.stations[station];
        const auto step = [&](uint64_t index,
                              uint64_t count) {  // the encoders' jitter is a quarter of a step
            return (static_cast<double>(index) + .5 + .25 * (2 * random.uniform() - 1)) /
                   static_cast<double>(count);
        };
        const double azimuth = 2 * M_PI * step(ray / sweep.beams, sweep.lines);
        const double elevation = kLowest + (kHighest - kLowest) * step(ray % sweep.beams, sweep.beams);
        const dvec3 direction(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const auto hit = geometry_->cast(origin, direction);
        if (!hit) return std::nullopt;

        const dvec3 albedo = hit->albedo();
        const double facing = std::abs(dot(hit->normal, direction));
        const double signal =
            (albedo.x + albedo.y + albedo.z) / 3 * facing *
            std::min(1.0, kReferenceRange * kReferenceRange / (hit->distance * hit->distance));
        const double kept = std::clamp((signal - kLostBelow) / (kKeptAbove - kLostBelow), 0.0, 1.0);
        if (random.uniform() >= kept * (1 - kAlwaysLost)) return std::nullopt;

        RecordPacker::Point point{{}, hit->normal, albedo, signal, static_cast<uint16_t>(station + 1)};
        if (dot(hit->normal, direction) > 0) point.normal = -point.normal;
        double range = hit->distance;
        const Beam beam(origin, direction, range);
        if (straddles_edge(beam, *hit, random) && random.uniform() < kMixedShare)
            mix_footprint(beam, random, range, point.albedo);
        // Box and Muller 1958; 1 - u keeps the logarithm finite.
        range += setup_.noise * std::sqrt(-2 * std::log(1 - random.uniform())) *
                 std::cos(2 * M_PI * random.uniform());
        point.position = origin + direction * range;
        return point;
    }

    bool straddles_edge(const Beam& beam, const SurfaceHit& hit, Random& random) const {
        const dvec3 probe = beam.inside(random);
        const auto other = geometry_->cast(beam.origin, probe);
        if (!other) return false;  // nothing comes back from beyond: the centre's range holds
        // A slanted surface is no edge: compare with the range at which the probe meets the hit's own plane.
        const double slope = dot(hit.normal, probe);
        const double expected =
            std::abs(slope) > 1e-3 ? dot(hit.position - beam.origin, hit.normal) / slope : hit.distance;
        return std::abs(other->distance - expected) > kEdgeDepth &&
               std::abs(other->distance - hit.distance) > kEdgeDepth;
    }

    void mix_footprint(const Beam& beam, Random& random, double& range, dvec3& albedo) const {
        double count = 1;
        for (int i = 0; i < kFootprintRays; ++i)
            if (const auto hit = geometry_->cast(beam.origin, beam.inside(random))) {
                range += hit->distance;
                albedo += hit->albedo();
                count += 1;
            }
        range /= count;
        albedo /= count;
    }

    std::shared_ptr<const SceneGeometry> geometry_;
    RecordPacker packer_;
    ScanSetup setup_;
    std::vector<Sweep> sweeps_;
    std::vector<uint64_t> pieces_before_;
    uint64_t pieces_ = 0;
};

}  // namespace

std::unique_ptr<PieceGenerator> make_scanner(std::shared_ptr<const SceneGeometry> geometry,
                                             const RecordPacker& packer, const ScanSetup& setup) {
    return std::make_unique<Scanner>(std::move(geometry), packer, setup);
}

}  // namespace lucarne::io
