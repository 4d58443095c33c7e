// What the tables of accuracy share: rows, settings, and scenes that all engines are measured in.
#pragma once

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/volume/first_bounce.h"
#include "gi/host_frame.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/scan.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "viewer/frame/presets.h"

namespace lucarne::bench {

/// Prints a figure beside the largest value that it should have; 0: no target.
inline void row(const std::string& scene, const std::string& measure, double value, double target,
                bool percent) {
    const double scale = percent ? 100 : 1;
    fmt::print("{:<44} {:<28} {:>9.4g} {:1}", scene, measure, scale * value, percent ? "%" : "");
    if (target > 0)
        fmt::print(" target {:>6.4g}  {}", scale * target, std::abs(value) <= target ? "kept" : "MISSED");
    fmt::print("\n");
    std::fflush(stdout);
}

inline gi::EngineSettings high(const BenchRun& run) {
    return viewer::find_preset(run.trial() ? "preview" : "high")->engine;
}
/// Returns the side of a square picture, pixels.
inline uint32_t side(const BenchRun& run, uint32_t full) {
    return run.trial() ? 32 : full;
}

/// Writes the Cornell box whose surfaces all are glossy, with lobes of this exponent, and returns the file.
inline std::filesystem::path shiny_scene(const BenchRun& run, int exponent) {
    std::ifstream file(scene_file("cornell-glossy"));
    auto scene = nlohmann::json::parse(file);
    scene["materials"][0]["shininess"] = exponent;
    const std::filesystem::path shiny = run.folder / fmt::format("shininess-{}.json", exponent);
    std::ofstream(shiny) << scene;
    return shiny;
}

/// Measures the mean radiance of a unit square of albedo .5 lit by another square that emits radiance 1,
/// divided by .5, over the mean form factor from what the pixels show to the square; in one frame and the
/// mean of four, with the errors that they should keep. (Pixels show also the rims of discs beyond the
/// square, and not all of a corner, so it is not quite that between the squares, of Howell's catalogue, C-11
/// and C-14.)
inline Result<void> form_factor(gi::Device& device, const BenchRun& run, const std::string& engine,
                                const std::string& name, const glm::vec3& corner, const glm::vec3& u,
                                const glm::vec3& v, double one, double four,
                                const gi::EngineSettings& over = {}) {
    gi::scenes::AnalyticScene scene;
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), o(0.0f);
    gi::scenes::add_rectangle(scene.surfels, o, x, y, 150, glm::vec3(.5f), 0);
    gi::scenes::add_rectangle(scene.surfels, corner, u, v, 150, glm::vec3(0.0f), 1);
    scene.materials = {gi::scenes::material(1, 0, 1, 0), gi::scenes::material(0, 0, 1, 1)};
    // The camera is far away and low, so that all parts of the receiver have the same weight and the emitter
    // hides none.
    scene.camera = gi::scenes::look(glm::vec3(40, .5f, 10), glm::vec3(.5f, .5f, 0), .02f, side(run, 256));
    scene.settings = high(run);
    scene.settings.override_with(over);
    scene.settings.set(gi::kOnlyBounce, 1);
    double sum = 0;
    constexpr int kFrames = 4;
    for (int i = 0; i < kFrames; ++i) {
        LUCARNE_ASSIGN(const auto rendered,
                       gi::scenes::render(device, engine, scene, static_cast<uint64_t>(i)));
        const auto shown = gi::visible_surfaces(scene.camera, rendered.texels);
        double mean = 0, truth = 0;
        for (size_t p = 0; p < rendered.texels.size(); ++p) {
            if (!(rendered.texels[p].depth > 0) || (rendered.texels[p].material & 0xffffu) != 0) continue;
            mean += rendered.radiance[p].y / .5;
            truth += gi::volume::form_factor(shown[p].position, glm::vec3(0, 0, 1), corner + .5f * (u + v),
                                             glm::normalize(glm::cross(u, v)), 1);
        }
        mean /= std::max(truth, 1e-9);
        if (i == 0) row("form factor, " + name + ", high", "mean", mean - 1, one, true);
        sum += mean / kFrames;
    }
    row("form factor, " + name + ", 4 frames", "mean", sum - 1, four, true);
    return {};
}

inline Result<void> form_factors(gi::Device& device, const BenchRun& run, const std::string& engine,
                                 double one, double four) {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0f);
    LUCARNE_TRY(form_factor(device, run, engine, "parallel at 1", z, y, x, one, four));
    LUCARNE_TRY(form_factor(device, run, engine, "parallel at .5", .5f * z, y, x, one, four));
    return form_factor(device, run, engine, "at a right angle", o, y, z, one, four);
}

/// Measures a closed box of albedo .5 whose walls emit .5: one frame and the mean of four, with the errors
/// that they should keep.
inline Result<void> furnace(gi::Device& device, const BenchRun& run, const std::string& engine, double one,
                            double four) {
    gi::scenes::AnalyticScene scene;
    scene.surfels = gi::scenes::closed_box(2, 100, glm::vec3(0.5f));
    scene.materials = {gi::scenes::material(1, 0, 1, 0.5f)};
    scene.camera =
        gi::scenes::look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, side(run, 128));
    scene.settings = high(run);
    for (const uint32_t bounces : run.cases<uint32_t>({1, 2, 3, 4})) {
        scene.settings.set(gi::kBounces, bounces);
        const double truth = 1 - std::pow(0.5, bounces + 1);
        double sum = 0;
        constexpr int kFrames = 4;
        for (int i = 0; i < kFrames; ++i) {
            LUCARNE_ASSIGN(const auto rendered,
                           gi::scenes::render(device, engine, scene, static_cast<uint64_t>(i)));
            const double mean = gi::mean_luminance(rendered.radiance);
            if (i == 0)
                row(fmt::format("closed furnace, {} bounces, high", bounces), "mean", mean / truth - 1, one,
                    true);
            sum += mean / kFrames;
        }
        row(fmt::format("closed furnace, {} bounces, 4 frames", bounces), "mean", sum / truth - 1, four,
            true);
    }
    return {};
}

}  // namespace lucarne::bench
