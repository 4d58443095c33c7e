// A vehicle that scans a town: the benchmark's cloud. Its statistics are realistic; it has no true surface.
//
// A scanner on a car's roof drives along parallel streets and turns its mirror across the direction of
// travel. It delivers one profile after another, as such scanners do. The town has streets, facades with
// recessed windows, spheres, trees through which some beams pass, and a few wild ranges. Positions are
// rounded to 1 mm. Colours have a camera's noise. The intensity is that of a ten-bit detector that sees
// speckle from a rough surface: all ten bits are noisy.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "io/core/random.h"
#include "io/synthetic/albedo.h"
#include "io/synthetic/generator.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

// All in metres.
constexpr int kStreets = 6;
constexpr double kStreetLength = 250, kStreetSpacing = 60, kHalfWidth = 9, kScannerHeight = 2.4;
constexpr double kLotLength = 22, kSidewalk = 3, kCurb = .12;
constexpr double kWindowStep = 3.2, kWindowSize = 1.4, kRecess = .25;
constexpr double kTreeStep = 14, kTreeRadius = 2.2, kTreeHeight = 5,
                 kTreePath = 1.1;  ///< mean free path inside
constexpr double kBallStep = 35, kBallRadius = .8;
constexpr double kWildShare = 2e-6, kWildRange = 1500;
constexpr double kCameraNoise = 3, kChannelNoise = 1.5;  ///< standard deviations, in 8-bit codes
constexpr double kReturning = .787;   ///< approximate share of beams that come back; gives the point count
constexpr double kProfileToBeam = 4;  ///< ratio of the distance of profiles to that of beams 10 m away
constexpr uint64_t kPieceBeams = 8192;

enum class Material { road, sidewalk, plaster, glass, ball, leaves, none };
constexpr std::array<dvec3, 6> kColors = {dvec3{96, 96, 100}, dvec3{140, 134, 128}, dvec3{188, 168, 138},
                                          dvec3{52, 62, 74},  dvec3{190, 60, 48},   dvec3{74, 104, 48}};

double gauss(Random& random) {  // Box and Muller 1958; 1 - u keeps the logarithm finite
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    return radius * std::cos(2 * M_PI * random.uniform());
}

double hash(int64_t a, int64_t b) {
    return unit_double(mix64(static_cast<uint64_t>(a), static_cast<uint64_t>(b)));
}

/// Returns waves of several lengths for worn, stained, dusty surfaces; about -1 to 1.
double stain(const dvec3& p) {
    return .5 * std::sin(1.7 * p.x + .9 * p.z + std::sin(.8 * p.y)) +
           .3 * std::sin(9.1 * p.y + 7.3 * p.x + 3 * p.z) + .2 * std::sin(31 * p.x + 27 * p.z + 23 * p.y);
}

struct Return {
    double range = 0;
    Material material = Material::none;
};

/// The profile across the street: (y, z) relative to the scanner, y towards the right facade.
class Profile {
 public:
    Profile(int street, double x) : street_(street), x_(x) {}

    Return cast(const dvec2& d, Random& random) const {
        Return best{1e9, Material::none};
        const auto nearer = [&](double range, Material material) {
            if (range > 0 && range < best.range) best = {range, material};
        };
        if (d.y < 0) {
            const double road = -kScannerHeight / d.y, side = -(kScannerHeight - kCurb) / d.y;
            const bool walk = std::abs(d.x * side) > kHalfWidth - kSidewalk;
            nearer(walk ? side : road, walk ? Material::sidewalk : Material::road);
        }
        if (d.x != 0) facade(d, nearer);
        const double side = d.x < 0 ? -1 : 1;
        const auto ball = std::llround(x_ / kBallStep);
        circle(d, {side * 4.5, kBallRadius}, static_cast<double>(ball) * kBallStep, kBallRadius,
               [&](double in, double) { nearer(in, Material::ball); });
        const auto tree = std::llround(x_ / kTreeStep);
        circle(d, {side * 6.3, kTreeHeight}, static_cast<double>(tree) * kTreeStep, kTreeRadius,
               [&](double in, double out) {
                   const double hit = in - kTreePath * std::log(1 - random.uniform());
                   if (hit < out) nearer(hit, Material::leaves);
               });
        return best;
    }

 private:
    template <class Nearer>
    void facade(const dvec2& d, const Nearer& nearer) const {
        const int side = d.x < 0 ? -1 : 1;
        const auto lot = static_cast<int64_t>(std::floor(x_ / kLotLength));
        const double setback = .6 * hash(lot, 2 * street_ + side), height = 9 + 12 * hash(lot, 77 + side);
        const double range = (kHalfWidth + setback) / std::abs(d.x), z = kScannerHeight + d.y * range;
        if (z > height) return;
        const auto in_window = [](double v) {
            return std::abs(v - kWindowStep * std::round(v / kWindowStep)) < kWindowSize / 2;
        };
        const double recessed = (kHalfWidth + setback + kRecess) / std::abs(d.x);
        const bool window =
            z > 1 && in_window(x_) && in_window(z) && in_window(kScannerHeight + d.y * recessed);
        nearer(window ? recessed : range, window ? Material::glass : Material::plaster);
    }

    /// Finds where the beam passes through a sphere with its centre at `center` across and at `along` on the
    /// street.
    template <class Use>
    void circle(const dvec2& d, const dvec2& center, double along, double radius, const Use& use) const {
        const double squared = radius * radius - (x_ - along) * (x_ - along);
        const dvec2 c = center - dvec2(0, kScannerHeight);
        const double middle = dot(c, d), inside = squared - (dot(c, c) - middle * middle);
        if (squared > 0 && inside > 0) use(middle - std::sqrt(inside), middle + std::sqrt(inside));
    }
    static double dot(const dvec2& a, const dvec2& b) { return a.x * b.x + a.y * b.y; }

    int street_;
    double x_;
};

class Survey final : public PieceGenerator {
 public:
    Survey(const Schema& schema, const SyntheticOptions& options) : schema_(schema), options_(options) {
        // Beams per turn and profiles per street, so that their distances have the given ratio.
        const double beams = static_cast<double>(options.points) / kReturning / kStreets;
        const double turn = std::sqrt(beams * kProfileToBeam * 2 * M_PI * 10 / kStreetLength);
        beams_ = static_cast<uint64_t>(std::max(1.0, std::round(turn)));
        profiles_ = static_cast<uint64_t>(std::max(1.0, std::round(beams / turn)));
    }
    uint64_t pieces() const override { return (total() + kPieceBeams - 1) / kPieceBeams; }

    void generate(uint64_t piece, std::vector<std::byte>& records) const override {
        const uint64_t first = piece * kPieceBeams, last = std::min(total(), first + kPieceBeams);
        for (uint64_t beam = first; beam < last; ++beam) shoot(beam, records);
    }

 private:
    uint64_t total() const { return kStreets * profiles_ * beams_; }

    void shoot(uint64_t beam, std::vector<std::byte>& records) const {
        Random random(options_.seed, beam);
        const auto street = static_cast<int>(beam / (profiles_ * beams_));
        const uint64_t profile = beam / beams_ % profiles_, step = beam % beams_;
        // The car's speed varies, and it returns on every other street.
        const double way =
            (static_cast<double>(profile) + static_cast<double>(step) / static_cast<double>(beams_) +
             .2 * hash(static_cast<int64_t>(profile), street)) /
            static_cast<double>(profiles_);
        const double x = kStreetLength * (street % 2 ? 1 - way : way);
        const double angle =
            2 * M_PI * (static_cast<double>(step) + .1 * random.uniform()) / static_cast<double>(beams_);
        const dvec2 direction(std::sin(angle), -std::cos(angle));
        Return hit = Profile(street, x).cast(direction, random);
        if (random.uniform() < kWildShare) hit = {20 + kWildRange * random.uniform(), Material::leaves};
        if (hit.material == Material::none) return;
        const double range = hit.range + options_.noise * gauss(random);
        const dvec3 p(x + .3 * options_.noise * gauss(random), street * kStreetSpacing + direction.x * range,
                      kScannerHeight + direction.y * range);
        put(p, hit.material, random, records);
    }

    void put(const dvec3& p, Material material, Random& random, std::vector<std::byte>& records) const {
        const size_t begin = records.size();
        records.resize(begin + schema_.stride);
        std::byte* at = &records[begin];
        for (int axis = 0; axis < 3; ++axis)
            store(at + 4 * axis, static_cast<int32_t>(std::llround(p[axis] / schema_.scale[axis])));
        store(at + 12, static_cast<uint16_t>(random.next() >> 54));  // ten bits of speckle
        const double shade = 1 + .12 * stain(p), light = kCameraNoise * gauss(random);
        for (int channel = 0; channel < 3; ++channel) {
            const double code = kColors[static_cast<size_t>(material)][channel] * shade + light +
                                kChannelNoise * gauss(random);
            at[14 + channel] = static_cast<std::byte>(std::lround(std::clamp(code, 0.0, 255.0)));
        }
    }

    Schema schema_;
    SyntheticOptions options_;
    uint64_t beams_ = 1, profiles_ = 1;
};

}  // namespace

Schema survey_schema() {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.scale = dvec3(1e-3);
    schema.stride = position_bytes(schema.position);
    schema.add(std::string(names::intensity), ScalarType::u16);
    schema.add(std::string(names::color), ScalarType::u8, 3);
    return schema;
}

std::unique_ptr<PieceGenerator> make_survey(const SyntheticOptions& options) {
    return std::make_unique<Survey>(survey_schema(), options);
}

}  // namespace lucarne::io
