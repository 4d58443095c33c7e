// The accuracy of the engines that gather light, `micro` and `environment`, against the reference and beside
// `vpl`: figures and targets of every picture. The reference always shows the points of the same preset.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/bounce_options.h"
#include "gi/compare/edges.h"
#include "gi/compare/flip.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/post/exposure.h"
#include "gi/post/tone_map.h"
#include "tests/bench/accuracy.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

/// Largest errors that a picture should have; 0: no target.
struct ErrorTargets {
    double energy = 0, rel_mse = 0;
    double trimmed = 0;  ///< of the relMSE without the worst .1 % of the pixels
};

/// How a picture differs from the reference in the pixels that show a point: others would hide errors in open
/// scenes.
struct PictureErrors {
    double energy = 0;          ///< of the mean luminance
    double rel_mse = 0;         ///< free of the reference's noise
    double standard_error = 0;  ///< of rel_mse
    double trimmed = 0;         ///< rel_mse without the worst .1 % of the pixels
    double off_edges = 0;       ///< rel_mse without edges of depth and normal
    double flip = 0;            ///< mean; counts the reference's noise
};

/// A view whose pictures are compared with the reference.
class Judge {
 public:
    /// `gbuffer`: of the pictures.
    Judge(const Scan::Truth& truth, const io::Image& gbuffer) : truth_(truth), width_(gbuffer.width) {
        for (const glm::vec4& pixel : gbuffer.pixels) shown_.push_back(pixel.w > 0);
        const auto edges = gi::gbuffer_edges(gbuffer);
        for (size_t i = 0; i < edges.size(); ++i)
            if (shown_[i]) inner_.push_back(!edges[i]);
    }

    Result<PictureErrors> errors(const std::vector<glm::vec4>& picture) const {
        const auto own = shown(picture), first = shown(truth_.first), second = shown(truth_.second);
        LUCARNE_ASSIGN(const gi::ImageMetrics metrics, gi::compare_images(own, shown(truth_.whole)));
        LUCARNE_ASSIGN(const gi::HalvesError all, gi::compare_with_halves(own, first, second));
        PictureErrors errors{.energy = metrics.luminance_error,
                             .rel_mse = all.rel_mse,
                             .standard_error = all.standard_error,
                             .trimmed = all.rel_mse_trimmed,
                             .off_edges = std::numeric_limits<double>::quiet_NaN()};
        if (std::ranges::find(inner_, 1) != inner_.end()) {
            LUCARNE_ASSIGN(const auto inner, gi::compare_with_halves(own, first, second, inner_));
            errors.off_edges = inner.rel_mse;
        }
        const double ev = gi::log_average_exposure(truth_.whole);
        const auto on_screen = [&](const std::vector<glm::vec4>& radiance) {
            return gi::tone_map(radiance, gi::ToneMap::filmic, {ev});
        };
        for (const float flip : shown(gi::flip_errors(on_screen(picture), on_screen(truth_.whole), width_)))
            errors.flip += flip / static_cast<double>(own.size());
        return errors;
    }
    /// Returns the relMSE of a picture against another one instead of the reference.
    Result<double> difference(const std::vector<glm::vec4>& picture,
                              const std::vector<glm::vec4>& other) const {
        LUCARNE_ASSIGN(const gi::ImageMetrics metrics, gi::compare_images(shown(picture), shown(other)));
        return metrics.rel_mse;
    }

 private:
    /// Returns the pixels that show a point.
    template <class Value>
    std::vector<Value> shown(const std::vector<Value>& pixels) const {
        std::vector<Value> kept;
        for (size_t i = 0; i < pixels.size(); ++i)
            if (shown_[i]) kept.push_back(pixels[i]);
        return kept;
    }

    const Scan::Truth& truth_;
    uint32_t width_;
    std::vector<uint8_t> shown_;  ///< of all pixels
    std::vector<uint8_t> inner_;  ///< of the pixels shown: whether they are not at an edge
};

inline std::string target_text(double value, double target, double scale) {
    if (!(target > 0)) return "";
    return fmt::format("<= {:.4g} {}", scale * target, std::abs(value) <= target ? "kept" : "MISSED");
}

inline void print_errors(const std::string& what, const std::string& engine, const PictureErrors& errors,
                         const ErrorTargets& targets, const Stage::Picture& picture) {
    fmt::print(
        "{:<38} {:<13} {:>+7.2f} {:<14} {:>8.2g} {:>8.1g} {:<16} {:>8.2g} {:<14} {:>8.2g} {:>6.3f} {:>7.2f} "
        "{:>7.2f}\n",
        what, engine, 100 * errors.energy, target_text(errors.energy, targets.energy, 100), errors.rel_mse,
        errors.standard_error, target_text(errors.rel_mse, targets.rel_mse, 1), errors.trimmed,
        target_text(errors.trimmed, targets.trimmed, 1), errors.off_edges, errors.flip, picture.seconds,
        picture.cpu_seconds);
    std::fflush(stdout);
}

/// The pictures of one engine and of `vpl`, with the headings of their table.
class AccuracyTable {
 public:
    AccuracyTable(gi::Device& device, const BenchRun& run, std::string engine)
        : device_(device), run_(run), engine_(std::move(engine)) {
        fmt::print("{:<38} {:<13} {:>8} {:<13} {:>9} {:>8} {:<16} {:>8} {:<14} {:>8} {:>6} {:>7} {:>7}\n",
                   "picture", "engine", "energy %", "", "relMSE", "+-", "", "trimmed", "", "no edges", "FLIP",
                   "s", "CPU-s");
    }

    struct Row {
        std::string name;
        int only_bounce = -1;  ///< -1: bounces 0 to `bounces`
        uint32_t bounces = 3;
        uint64_t samples = 256;              ///< paths a pixel of the reference
        std::vector<uint64_t> frames = {1};  ///< pictures: averages of so many frames
        std::vector<ErrorTargets> targets;   ///< of each
        bool brute_force = false;            ///< also compares with `environment` without its shortcuts
    };
    /// Measures pictures of a stage that is open.
    Result<void> row(Stage& stage, const Row& row) {
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kOnlyBounce, row.only_bounce);
        settings.set(gi::kBounces, row.bounces);
        LUCARNE_ASSIGN(const Scan::Truth truth,
                       stage.truth(settings, std::max<uint64_t>(run_.count(row.samples), 2)));
        const Judge judge(truth, stage.gbuffer());
        for (size_t i = 0; i < row.frames.size(); ++i) {
            const uint64_t frames = run_.trial() ? 1 : row.frames[i];
            const std::string name =
                row.name +
                (row.frames.size() > 1 ? fmt::format(", {} frame{}", frames, frames > 1 ? "s" : "") : "");
            for (const std::string& engine : {engine_, std::string("vpl")}) {
                LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture(engine, settings, frames));
                LUCARNE_ASSIGN(const PictureErrors errors, judge.errors(picture.pixels));
                const bool own = engine == engine_;
                print_errors(own ? name : "", engine, errors, own ? row.targets[i] : ErrorTargets{}, picture);
                if (own && row.brute_force) LUCARNE_TRY(brute_force(stage, settings, judge, picture));
            }
        }
        return {};
    }

    gi::Device& device() const { return device_; }
    const BenchRun& run() const { return run_; }
    /// Returns the view of a scene file that all rows use.
    Stage::View view(const std::string& scene, const std::string& camera = "") const {
        return {.scene = scene,
                .size = run_.size({128, 80}),
                .preset = run_.trial() ? "preview" : "high",
                .camera = camera};
    }

 private:
    /// Compares a picture of `environment` with one for which it gathers at all points.
    Result<void> brute_force(Stage& stage, gi::EngineSettings settings, const Judge& judge,
                             const Stage::Picture& picture) {
        const auto stat = [&](std::string_view name) { return statistic(picture.last, name); };
        settings.set(gi::environment::kBruteForce, true);
        LUCARNE_ASSIGN(const Stage::Picture all, stage.picture(engine_, settings));
        LUCARNE_ASSIGN(const double difference, judge.difference(picture.pixels, all.pixels));
        LUCARNE_ASSIGN(const PictureErrors errors, judge.errors(all.pixels));
        print_errors("", "--brute-force", errors, {}, all);
        fmt::print("{:<38} relMSE against --brute-force {:.2g} {}\n", "", difference,
                   target_text(difference, .001, 1));
        const double share = (stat("after_down") + stat("primary_points")) / stat("surfels");
        fmt::print("{:<38} {:.0f} primary and {:.0f} secondary points gather, {:.2f} % of all surfels {}\n",
                   "", stat("primary_points"), stat("after_down"), 100 * share,
                   target_text(share, .062, 100));
        return {};
    }

    gi::Device& device_;
    const BenchRun& run_;
    std::string engine_;
};

/// Writes a scene that only its sky lights, and returns the file.
inline std::filesystem::path sky_alone(const BenchRun& run, const std::string& scene) {
    std::ifstream file(scene_file(scene));
    auto json = nlohmann::json::parse(file);
    json["lights"] = nlohmann::json::array();
    const std::filesystem::path written = run.folder / (scene + "-alone.json");
    std::ofstream(written) << json;
    return written;
}

/// Measures daylight through windows, with the sun and without. With it the few pixels at the borders of its
/// spots decide the error, and they are those of `direct`.
inline Result<void> nave_sky(AccuracyTable& table, const Scan& nave, double one_frame) {
    Stage stage(table.device(), nave);
    LUCARNE_TRY(stage.open(table.view(sky_alone(table.run(), "nave-sky"), "nave")));
    const AccuracyTable::Row row{.name = "nave-sky, no sun, bounce 0",
                                 .only_bounce = 0,
                                 .frames = {1, 16},
                                 .targets = {{0, one_frame}, {0, .01}}};
    LUCARNE_TRY(table.row(stage, row));
    LUCARNE_TRY(stage.open(table.view(scene_file("nave-sky"), "nave")));
    return table.row(stage, {.name = "nave-sky, bounce 0", .only_bounce = 0, .targets = {{0, one_frame}}});
}

inline Result<void> accuracy_of_micro(gi::Device& device, const BenchRun& run) {
    AccuracyTable table(device, run, "micro");
    using Sampling = std::pair<std::string, std::string>;
    for (const auto& [name, sampling] :
         run.cases<Sampling>({{"cornell, even", "--even --normals"}, {"cornell, scan", ""}})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(300'000), run.folder, sampling));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open(table.view(scene_file("cornell"))));
        for (const int bounce : run.cases<int>({1, 2, 3, 4}))
            LUCARNE_TRY(
                table.row(stage, {.name = fmt::format("{}, bounce {}", name, bounce),
                                  .only_bounce = bounce,
                                  .targets = {bounce == 1 ? ErrorTargets{.01, .002} : ErrorTargets{.02}}}));
    }
    LUCARNE_ASSIGN(const Scan box, Scan::create("cornell", run.points(300'000), run.folder));
    struct Glossy {
        int exponent;
        uint64_t paths;
        double rel_mse;
    };
    for (const Glossy& glossy : run.cases<Glossy>({{10, 1024, .01}, {100, 2048, .02}, {1000, 4096, .05}})) {
        Stage stage(device, box);
        Stage::View view = table.view(shiny_scene(run, glossy.exponent));
        view.size = run.size({64, 40});  // a path tracer hits lobes by chance and needs many paths
        LUCARNE_TRY(stage.open(view));
        LUCARNE_TRY(table.row(stage, {.name = fmt::format("cornell, shininess {}, bounce 1", glossy.exponent),
                                      .only_bounce = 1,
                                      .samples = glossy.paths,
                                      .targets = {{0, glossy.rel_mse}}}));
    }
    LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(300'000), run.folder));
    for (const std::string& camera : run.cases<std::string>({"nave", "carpet", "aisle", "altar", "vault"})) {
        Stage stage(device, nave);
        LUCARNE_TRY(stage.open(table.view(scene_file("nave"), camera)));
        LUCARNE_TRY(
            table.row(stage, {.name = "nave, " + camera + ", bounces 0 to 3", .targets = {{.02, .01}}}));
    }
    LUCARNE_TRY(nave_sky(table, nave, .05));
    return furnace(device, run, "micro", .005, .005);
}

inline Result<void> accuracy_of_environment(gi::Device& device, const BenchRun& run) {
    AccuracyTable table(device, run, "environment");
    struct Open {
        std::string scan, sampling;
        uint64_t points;
    };
    for (const Open& open : run.cases<Open>({{"statue", "--even --normals", 300'000},
                                             {"primitives", "--even --normals", 300'000},
                                             {"survey", "", 500'000}})) {
        LUCARNE_ASSIGN(const Scan scan,
                       Scan::create(open.scan, run.points(open.points), run.folder, open.sampling));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open(table.view(scene_file(open.scan + "-sky"))));
        for (const int bounce : run.cases<int>({0, 1}))
            LUCARNE_TRY(table.row(stage, {.name = fmt::format("{}-sky, bounce {}", open.scan, bounce),
                                          .only_bounce = bounce,
                                          .targets = {{.015, .005}},
                                          .brute_force = bounce > 0}));
    }
    LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(300'000), run.folder));
    LUCARNE_TRY(nave_sky(table, nave, .15));
    return furnace(device, run, "environment", .005, .005);
}

}  // namespace lucarne::bench
