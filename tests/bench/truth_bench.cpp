// Scans against the mesh that was scanned, as a table: the light of pictures of scans, split by why pixels
// differ, and how the scans' discs lie on the true surface. The true pictures are those of
// tests/oracles/truth_oracle.py; the engine is the reference, so that the differences are those of surfaces
// and not of light transport. `lucarne_truth [FOLDER] [--scale S] [--samples N]`: pictures go to FOLDER
// (default: a temporary one that is removed).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/compare/flip.h"
#include "gi/compare/metrics.h"
#include "gi/post/exposure.h"
#include "gi/post/tone_map.h"
#include "tests/bench/all_surfels.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/outlines.h"
#include "tests/bench/scan.h"
#include "tests/bench/true_surface.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::Cause, bench::DiscFit, bench::Scan, bench::TrueScene, bench::TrueView;
using Pixels = std::vector<glm::vec4>;

constexpr uint64_t kSamples = 256;        ///< paths a pixel of whole pictures, without --samples
constexpr uint64_t kBounceSamples = 32;   ///< of single bounces, whose means alone are compared
constexpr size_t kFittedDiscs = 100'000;  ///< discs whose rims and creases are probed
constexpr uint32_t kOutlineSide = 2880;   ///< pixels, of the picture in which outlines are measured
constexpr double kRogueMetres = .05, kRogueRadii = 3, kNoise = .01;  ///< m off the surface

void row(const std::string& what, const std::string& measure, double value, const std::string& unit,
         std::optional<double> target = {}) {
    fmt::print("{:<32} {:<36} {:>9.4g} {:<4}", what, measure, value, unit);
    if (target) fmt::print(" target {:>5.3g}  {}", *target, std::abs(value) <= *target ? "kept" : "MISSED");
    fmt::print("\n");
    std::fflush(stdout);
}

double percentile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// A scan to measure, and what its pictures should reach.
struct Case {
    std::string scene, name;
    std::string sampling;  ///< options of `lucarne generate`
    uint64_t points;
    std::vector<std::string> views;
    std::vector<std::string> parts;  ///< the true pictures that add up to bounces 0 to 3
    std::vector<int> bounces;        ///< to compare one by one
    double flip;
};

const std::vector<std::string> kBounces = {"bounce-0", "bounce-1", "bounce-2", "bounce-3"};

std::vector<Case> cases() {
    const auto cornell = [](const std::string& name, const std::string& sampling, uint64_t points,
                            double flip) {
        return Case{"cornell", name, sampling, points, {"front"}, kBounces, {0, 1, 2, 3}, flip};
    };
    return {cornell("cornell, even, true normals, 300k", "--even --normals", 300'000, .04),
            cornell("cornell, even, 1M", "--even", 1'000'000, .04),
            cornell("cornell, scan, 300k", "", 300'000, .06),
            cornell("cornell, scan, 1M", "", 1'000'000, .06),
            cornell("cornell, scan, 5M", "", 5'000'000, .06),
            Case{"nave",
                 "nave, scan, 5M",
                 "",
                 5'000'000,
                 {"nave", "altar"},
                 {"bounce-0", "bounces-1-to-3"},
                 {0},
                 .10}};
}

/// Sums over the pixels that differ for one reason.
struct Share {
    double pixels = 0, squared = 0, luminance = 0;
};

/// Prints how much of a picture and of its errors each cause has.
void print_causes(const std::string& what, const std::vector<Share>& shares, double pixels, double truth) {
    double squared = 0;
    for (const Share& share : shares) squared += share.squared;
    for (size_t i = 0; i < shares.size(); ++i)
        fmt::print(
            "{:<32}   {:<24} {:>6.2f} % of the pixels, {:>6.2f} % of the squared error, {:>+6.2f} % of "
            "the light\n",
            what, bench::kCauses[i].second, 100 * shares[i].pixels / pixels,
            100 * shares[i].squared / squared, 100 * shares[i].luminance / truth);
    row(what, "pixels nearer than the truth",
        100 * shares[static_cast<size_t>(Cause::nearer)].pixels / pixels, "%", 3);
}

/// Compares a picture, its two halves and its G-buffer with the truth.
Result<void> judge(const std::string& what, const Scan::Truth& picture, const Pixels& gbuffer,
                   const TrueView& view, const Pixels& truth, double flip_target) {
    LUCARNE_ASSIGN(const auto metrics, gi::compare_images(picture.whole, truth));
    row(what, "mean, bounces 0 to 3", 100 * metrics.luminance_error, "%", 2);
    const double epsilon = gi::relative_epsilon(truth);
    std::vector<Share> shares(bench::kCauses.size());
    std::vector<double> errors;
    for (size_t i = 0; i < truth.size(); ++i) {
        Share& share = shares[static_cast<size_t>(view.cause(i, gbuffer[i]))];
        // The product of two independent errors is free of the reference's noise (compare_with_halves).
        double squared = 0;
        for (glm::length_t c = 0; c < 3; ++c) {
            const double r = truth[i][c];
            squared += (picture.first[i][c] - r) * (picture.second[i][c] - r) / (r * r + epsilon) / 3;
        }
        errors.push_back(squared);
        share.pixels += 1;
        share.squared += squared;
        share.luminance += gi::luminance(picture.whole[i]) - gi::luminance(truth[i]);
    }
    const auto pixels = static_cast<double>(errors.size());
    std::sort(errors.begin(), errors.end());
    double all = 0, trimmed = 0;
    const size_t kept = errors.size() - static_cast<size_t>(gi::kTrimmed * pixels);
    for (size_t i = 0; i < errors.size(); ++i) (i < kept ? trimmed : all) += errors[i];
    row(what, "relMSE, without noise", (all + trimmed) / pixels, "");
    row(what, "relMSE without the worst .1 %", trimmed / static_cast<double>(kept), "");
    // At half the size, because FLIP counts noise that an eye would see: four times fewer paths will do.
    const double ev = gi::log_average_exposure(truth);
    const uint32_t side = bench::kTrueSide - 2 * bench::kMargin;
    const auto shown = [&](const Pixels& radiance) {
        return gi::tone_map(bench::halved(radiance, side), gi::ToneMap::filmic, {ev});
    };
    const auto mean = [](const std::vector<float>& values) {
        double sum = 0;
        for (const float value : values) sum += value;
        return sum / static_cast<double>(values.size());
    };
    const auto flip = [&](const Pixels& a, const Pixels& b) {
        return mean(gi::flip_errors(shown(a), shown(b), side / 2));
    };
    row(what, "FLIP", flip(picture.whole, truth), "", flip_target);
    // The halves differ by twice the noise of the whole.
    row(what, "FLIP of the noise, at most", flip(picture.first, picture.second), "");
    print_causes(what, shares, pixels, metrics.reference_mean_luminance * pixels);
    return {};
}

/// Measures how the scan's discs lie on the surface.
void discs(const Case& measured, const std::vector<gi::Surfel>& surfels, const io::SceneGeometry& geometry) {
    const bench::NearestSurface surface(geometry);
    std::vector<char> rogue(surfels.size());
    parallel_ranges(surfels.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const double off = surface.distance(surfels[i].position);
            rogue[i] = off > kRogueMetres || off > std::max(kNoise, kRogueRadii * surfels[i].radius);
        }
    });
    double rogues = 0, rogue_area = 0;
    for (size_t i = 0; i < surfels.size(); ++i)
        if (rogue[i]) rogues += 1, rogue_area += M_PI * surfels[i].radius * surfels[i].radius;

    const size_t step = std::max<size_t>(1, surfels.size() / kFittedDiscs);
    std::vector<DiscFit> fits((surfels.size() + step - 1) / step);
    parallel_ranges(fits.size(), 256, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const gi::Surfel& s = surfels[i * step];
            if (dot(s.normal, s.normal) > .5f) fits[i] = surface.fit(s.position, s.normal, s.radius, s.edge);
        }
    });
    std::vector<double> angles, creases, elsewhere;
    double area = 0, outside = 0;
    for (size_t i = 0; i < fits.size(); ++i) {
        const gi::Surfel& s = surfels[i * step];
        if (dot(s.normal, s.normal) < .5f) continue;
        angles.push_back(fits[i].angle);
        (fits[i].at_crease ? creases : elsewhere).push_back(fits[i].angle);
        area += s.radius * s.radius;
        outside += s.radius * s.radius * fits[i].outside;
    }
    const std::string& what = measured.name;
    row(what, "rogue discs", rogues, "", 0);
    row(what, "their area", rogue_area, "m2", 0);
    row(what, "discs' area off the surface", 100 * outside / area, "%");
    row(what, "discs at creases",
        100 * static_cast<double>(creases.size()) / static_cast<double>(angles.size()), "%");
    row(what, "normals at creases, p50", percentile(creases, .5), "deg", 5);
    row(what, "normals elsewhere, p50", percentile(elsewhere, .5), "deg");
    row(what, "normals elsewhere, p95", percentile(elsewhere, .95), "deg");
    row(what, "normals, p95", percentile(angles, .95), "deg", 12);
}

/// Measures how much of the outlines lies where it should, in a larger picture.
Result<void> outlines(const BenchRun& run, const std::string& what, const Scan& scan, const TrueScene& truth,
                      const bench::SpacingMap& spacings) {
    const uint32_t side = run.trial() ? kOutlineSide / 4 : kOutlineSide;
    const std::string gbuffer = run.folder / "outlines.exr";
    LUCARNE_TRY(scan.render("outlines-unlit.exr",
                            fmt::format("--engine unlit --camera {} --size {}x{} --preset high --gbuffer {}",
                                        truth.view, side, side, gbuffer)));
    LUCARNE_ASSIGN(const io::Image seen, io::read_exr(gbuffer));
    const TrueView view(*truth.geometry, truth.camera, {side, side}, 0);
    const gi::CameraView camera = gi::camera_view(truth.camera, {side, side}, {});
    const double pixel_size = 2 * glm::length(glm::dvec3(camera.up)) / side;
    const auto place = [&](size_t pixel) {
        return glm::dvec3(camera.origin) + view.ray(pixel) * view.pixels()[pixel].depth;
    };
    const auto spacing = [&](size_t pixel) {
        const double depth = view.pixels()[pixel].depth;
        return depth > 0 ? spacings.at(place(pixel)) / (pixel_size * depth) : 0;
    };
    const auto scanned = [&](size_t pixel, double reach) {
        const TrueView::Pixel& true_surface = view.pixels()[pixel];
        return spacings.has_point(place(pixel), true_surface.normal, reach * pixel_size * true_surface.depth);
    };
    const bench::Outlines found =
        bench::OutlineJudge(view.pixels(), seen.pixels, side, pixel_size, spacing, scanned).judge();
    const auto print = [&](const std::string& measure, const bench::OutlineLength& length, double target) {
        if (!(length.all > 0)) return;
        const double share = 100 * length.kept / length.all;
        fmt::print("{:<32} {:<36} {:>9.4g} %    target {:>5.3g}  {} ({:.0f} pixels long)\n", what, measure,
                   share, target, share >= target ? "kept" : "MISSED", length.all);
    };
    print("creases within 1/4 spacing", found.creases, 90);
    print("steps of depth within 1/2 spacing", found.steps, 80);
    return {};
}

Result<void> pictures(const BenchRun& run, const Case& measured, const Scan& scan, const std::string& camera,
                      const bench::SpacingMap& spacings) {
    LUCARNE_ASSIGN(const TrueScene truth, TrueScene::open(measured.scene, camera));
    const std::string what = measured.name + (measured.views.size() > 1 ? ", " + camera : "");
    LUCARNE_TRY(outlines(run, what, scan, truth, spacings));
    const std::string common = fmt::format("--camera {} --size {}x{} --preset {} ", camera, bench::kTrueSide,
                                           bench::kTrueSide, run.trial() ? "preview" : "high");
    for (const int bounce : run.cases(measured.bounces)) {
        const uint64_t paths = bounce > 0 ? run.count(kBounceSamples) : 1;  // direct light has no noise
        LUCARNE_ASSIGN(
            const auto picture,
            scan.picture("bounce", common + fmt::format("--engine reference --only-bounce {} --samples {}",
                                                        bounce, paths)));
        LUCARNE_ASSIGN(const auto expected, truth.picture({kBounces[static_cast<size_t>(bounce)]}));
        row(what, fmt::format("mean, bounce {}", bounce),
            100 *
                (gi::mean_luminance(bench::inner(picture, bench::kTrueSide)) / gi::mean_luminance(expected) -
                 1),
            "%", bounce > 0 ? 5 : 2);
    }
    const std::string gbuffer = run.folder / "gbuffer.exr";
    const auto full = static_cast<uint64_t>(run.option("samples", kSamples));
    const uint64_t paths = std::max<uint64_t>(run.count(full), 2);  // one for each half
    LUCARNE_ASSIGN(
        Scan::Truth picture,
        scan.truth("whole", common + fmt::format("--bounces 3 --samples {} --gbuffer {}", paths, gbuffer)));
    for (Pixels* pixels : {&picture.whole, &picture.first, &picture.second})
        *pixels = bench::inner(*pixels, bench::kTrueSide);
    LUCARNE_ASSIGN(const io::Image seen, io::read_exr(gbuffer));
    LUCARNE_ASSIGN(const auto expected, truth.picture(measured.parts));
    return judge(what, picture, bench::inner(seen.pixels, bench::kTrueSide),
                 TrueView(*truth.geometry, truth.camera, {bench::kTrueSide, bench::kTrueSide}), expected,
                 measured.flip);
}

Result<void> measure(const BenchRun& run) {
    for (const Case& measured : run.cases(cases())) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(measured.scene, run.points(measured.points), run.folder,
                                                     measured.sampling));
        LUCARNE_ASSIGN(const auto geometry, io::SceneGeometry::create(measured.scene));
        std::vector<gi::Surfel> surfels;
        {
            LUCARNE_ASSIGN(const auto device, gi::Device::headless());
            LUCARNE_ASSIGN(surfels, bench::all_surfels(*device, scan.cache()));
        }
        discs(measured, surfels, *geometry);
        const bench::SpacingMap spacings(surfels);
        for (const std::string& camera : run.cases(measured.views))
            LUCARNE_TRY(pictures(run, measured, scan, camera, spacings));
    }
    return {};
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure, {.options = {"samples"}});
}
