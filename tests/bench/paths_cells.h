// Figs 7, 12 and 13 of the paper behind the engine `paths`, Yue et al. 2007: its cells by themselves. Light
// of one bounce at gathering points, by what the parts of the engine make of the same rays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/groups.h"
#include "gi/scene/scene.h"
#include "gi/scene/views.h"
#include "gi/shared/light.h"
#include "gi/shared/luminance.h"
#include "io/core/parallel.h"
#include "tests/bench/all_surfels.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_figures.h"
#include "tests/bench/scan.h"

namespace lucarne::bench {

/// A scene of lamps, and gathering points whose rays are known: as the engine's, with the options of the
/// preset `interactive`.
class CellScene {
 public:
    static constexpr uint32_t kRays = 256;
    static constexpr uint64_t kSeed = 1;
    /// Rays of a point that tell its true light.
    static constexpr uint32_t kTrueRays = 4096;

    static Result<std::unique_ptr<CellScene>> create(gi::Device& device, const std::string& cache,
                                                     const std::string& scene) {
        LUCARNE_ASSIGN(const auto surfels, all_surfels(device, cache));
        LUCARNE_ASSIGN(const gi::Scene loaded, gi::load_scene(scene));
        LUCARNE_ASSIGN(auto tracer, gi::tracing::SurfelTracer::create(surfels));
        std::unique_ptr<CellScene> made(new CellScene(std::move(tracer)));
        for (const gi::SceneLight& light : loaded.lights)
            made->lights_.push_back(gi::device_light(light, {}));
        made->choose_points();
        return made;
    }

    const gi::paths::Surfaces& surfaces() const { return surfaces_; }
    const gi::paths::PointChooser::State& points() const { return chooser_->state(); }
    float least_cell() const { return std::min(points().spacing.most / 2, points().spacing.least); }

    /// Returns the luminance that lamps make a place on a side send out by the first bounce, times pi.
    double light_at(gi::paths::Side side, const glm::vec3& place) const {
        const gi::Surfel disc = surfaces_.surfels()[side / 2];
        const glm::vec3 normal = side % 2 ? -disc.normal : disc.normal;
        const glm::vec3 start = gi::tracing::offset_origin(place, normal, disc.radius);
        glm::vec3 sum(0.0f);
        for (const gi::Light& light : lights_) {
            glm::vec3 in;
            const glm::vec3 arriving = gi::light_irradiance(light, place, normal, in);
            if (arriving != glm::vec3(0.0f) && !surfaces_.tracer().occluded(start, glm::vec3(light.position)))
                sum += arriving;
        }
        return gi::luminance(disc.albedo * sum);
    }
    gi::paths::RayStart start_of(size_t point) const {
        const gi::paths::GatheringPoint& p = points().points[point];
        return {p.position, p.normal, p.radius};
    }
    /// Follows a ray of a point. Sets the light that it brings.
    gi::paths::RayHit follow(size_t point, const glm::vec3& direction, uint32_t count, double& light) const {
        const gi::paths::RayStart start = start_of(point);
        float distance = 0;
        const auto hit = gi::paths::follow(surfaces_, start, direction, count, distance);
        const glm::vec3 origin = gi::tracing::offset_origin(start.position, start.normal, start.radius);
        light = hit.side == gi::paths::kNone ? 0 : light_at(hit.side, origin + distance * direction);
        return hit;
    }
    /// The light of every ray where it hits.
    std::span<const double> at_hits() const { return at_hits_; }
    /// Points whose light is compared, and their true light.
    std::span<const size_t> compared() const { return compared_; }
    std::span<const double> truth() const { return truth_; }

 private:
    explicit CellScene(std::unique_ptr<gi::tracing::SurfelTracer> tracer) : surfaces_(std::move(tracer)) {
        while (surfaces_.find_parts()) continue;
    }

    void choose_points() {
        constexpr float kSpacing = 16e-3f, kLeastShare = .125f, kLeastRadii = 4;  // as gi/engines/paths/bake
        glm::vec3 low(3e38f), high(-3e38f);
        double radius = 0;
        const auto& discs = surfaces_.tracer().surfels();
        for (const gi::Surfel& s : discs) {
            low = glm::min(low, s.position);
            high = glm::max(high, s.position);
            radius += s.radius / static_cast<double>(discs.size());
        }
        const float most = kSpacing * glm::distance(low, high);
        const float least = std::max(kLeastShare * most, kLeastRadii * static_cast<float>(radius));
        chooser_ = std::make_unique<gi::paths::PointChooser>(
            surfaces_, gi::paths::Spacing{least, std::max(least, most)}, kRays, kSeed);
        while (chooser_->advance()) continue;
        const auto& state = points();
        at_hits_.resize(state.hits.size());
        parallel_ranges(state.points.size(), 16, [&](size_t begin, size_t end) {
            for (size_t point = begin; point < end; ++point)
                for (uint32_t ray = 0; ray < kRays; ++ray) {
                    const auto& hit = state.hits[point * kRays + ray];
                    if (hit.side == gi::paths::kNone) continue;
                    at_hits_[point * kRays + ray] =
                        light_at(hit.side, gi::paths::place_of(start_of(point), kSeed,
                                                               state.points[point].side, ray, kRays, hit));
                }
        });
        const size_t step = std::max<size_t>(state.points.size() / 1000, 1);
        for (size_t point = 0; point < state.points.size(); point += step) compared_.push_back(point);
        truth_.resize(compared_.size());
        parallel_ranges(compared_.size(), 4, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const gi::paths::RayStart start = start_of(compared_[i]);
                const gi::paths::CosineDirections directions(start.normal, ~kSeed, compared_[i]);
                for (uint32_t ray = 0; ray < kTrueRays; ++ray) {
                    double light = 0;
                    follow(compared_[i], directions[ray], kTrueRays, light);
                    truth_[i] += light / kTrueRays;
                }
            }
        });
    }

    gi::paths::Surfaces surfaces_;
    std::vector<gi::Light> lights_;
    std::unique_ptr<gi::paths::PointChooser> chooser_;
    std::vector<double> at_hits_;
    std::vector<size_t> compared_;
    std::vector<double> truth_;
};

/// Cells and the groups in them, with the light of each: the mean of what rays met in it.
struct LitCells {
    gi::paths::Groups groups;
    std::vector<double> light;  ///< of each group
    std::vector<double> met;    ///< of each leaf: how many rays end there
    double cpu_seconds = 0;     ///< to make the groups

    /// `hits`: their widths say how fine cells are to be; those of the scene's rays for cells as the
    /// engine's.
    LitCells(const CellScene& scene, std::span<const gi::paths::RayHit> hits, float least_cell) {
        const auto& state = scene.points();
        const std::clock_t start = std::clock();
        gi::paths::GroupBuilder builder(scene.surfaces(), hits, least_cell);
        while (builder.divide()) continue;
        const auto leaf_of = builder.leaf_of();
        for (size_t i = 0; i < state.hits.size(); ++i)
            if (state.hits[i].side != gi::paths::kNone)
                builder.connect(leaf_of[state.points[i / CellScene::kRays].side],
                                leaf_of[state.hits[i].side]);
        while (builder.join()) continue;
        groups = builder.take();
        cpu_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        groups.leaf_of.assign(leaf_of.begin(), leaf_of.end());
        light.assign(groups.count(), 0);
        met.assign(groups.leaves, 0);
        for (size_t i = 0; i < state.hits.size(); ++i)
            if (const auto side = state.hits[i].side; side != gi::paths::kNone) {
                light[leaf_of[side]] += scene.at_hits()[i];
                ++met[leaf_of[side]];
            }
        for (uint32_t leaf = 0; leaf < groups.leaves; ++leaf) light[leaf] /= std::max(met[leaf], 1.0);
        for (uint32_t group = groups.leaves; group < groups.count(); ++group) {
            double sum = 0;
            for (const uint32_t child : groups.children_of(group)) sum += groups.area[child] * light[child];
            light[group] = groups.area[group] > 0 ? sum / groups.area[group] : 0;
        }
    }
};

/// What some way to gather makes of the light at the compared points.
struct GatherErrors {
    double energy = 0;  ///< of the mean
    double rms = 0;     ///< over the mean
    double leak = 0;    ///< mean light of points that are dark in truth over the mean of all; nan: no such
    size_t rays = 0;    ///< that are kept, of all points

    GatherErrors(const CellScene& scene, std::span<const double> found, size_t kept) : rays(kept) {
        double truth = 0, squares = 0, sum = 0, dark = 0, count = 0;
        for (size_t i = 0; i < found.size(); ++i) {
            truth += scene.truth()[i];
            sum += found[i];
            squares += (found[i] - scene.truth()[i]) * (found[i] - scene.truth()[i]);
        }
        const auto points = static_cast<double>(found.size());
        for (size_t i = 0; i < found.size(); ++i)
            if (scene.truth()[i] < 1e-3 * truth / points) {
                dark += found[i];
                ++count;
            }
        energy = sum / truth - 1;
        rms = std::sqrt(squares * points) / truth;
        leak = count > 0 ? dark / count / (truth / points) : NAN;
    }
};

inline void print_gathered(const std::string& name, const GatherErrors& errors, double cpu_seconds) {
    fmt::print("{:>46} {:>9.2f} {:>8.1f} {:>11} {:>9.2f} {:>7.1f}\n", name, 100 * errors.energy,
               100 * errors.rms, std::isnan(errors.leak) ? "-" : fmt::format("{:.2g}", errors.leak),
               1e-6 * static_cast<double>(errors.rays), cpu_seconds);
    std::fflush(stdout);
}

/// The share of a ray's width into which the group fits that it names, as in gi/engines/paths/path_builder.
inline constexpr float kNamedShare = .5f;

/// Gathers the light of the groups that the points' rays name.
inline GatherErrors gathered_from(const CellScene& scene, const LitCells& cells) {
    std::vector<double> found;
    for (const size_t point : scene.compared()) {
        double sum = 0;
        for (uint32_t ray = 0; ray < CellScene::kRays; ++ray) {
            const auto& hit = scene.points().hits[point * CellScene::kRays + ray];
            if (hit.side == gi::paths::kNone) continue;
            const uint32_t leaf = cells.groups.leaf_of[hit.side];
            sum += cells.light[cells.groups.fitting(leaf, kNamedShare * hit.width)];
        }
        found.push_back(sum / CellScene::kRays);
    }
    return {scene, found, scene.points().hits.size()};
}

/// Gathers from the paper's cells (fig. 12 a): a cell holds all surfaces in it, whichever way they face. What
/// no ray meets is left out, as the triangles of the paper have no backs.
inline GatherErrors gathered_from_boxes(const CellScene& scene, const LitCells& cells) {
    const gi::paths::Groups& groups = cells.groups;
    constexpr int kLevels = 20;
    struct Sum {
        double light = 0, area = 0;
    };
    std::vector<std::unordered_map<uint64_t, Sum>> boxes(kLevels + 1);
    const auto planes = groups.find_planes();
    const auto key = [&](uint32_t leaf, int level) {
        const glm::vec3 at = (planes[leaf].centre - groups.corner) / groups.edge * std::ldexp(1.0f, level);
        return uint64_t(at.x) << 42 | uint64_t(at.y) << 21 | uint64_t(at.z);
    };
    const auto level_of = [&](float edge) {
        return std::clamp(static_cast<int>(std::ceil(std::log2(groups.edge / edge) - 1e-3f)), 0, kLevels);
    };
    for (uint32_t leaf = 0; leaf < groups.leaves; ++leaf)
        for (int level = 0; cells.met[leaf] > 0 && level <= level_of(groups.cell[leaf]); ++level) {
            Sum& sum = boxes[static_cast<size_t>(level)][key(leaf, level)];
            sum.light += cells.light[leaf] * groups.area[leaf];
            sum.area += groups.area[leaf];
        }
    std::vector<double> found;
    for (const size_t point : scene.compared()) {
        double sum = 0;
        for (uint32_t ray = 0; ray < CellScene::kRays; ++ray) {
            const auto& hit = scene.points().hits[point * CellScene::kRays + ray];
            if (hit.side == gi::paths::kNone) continue;
            const uint32_t leaf = groups.leaf_of[hit.side];
            const int level = std::min(level_of(1.25f * kNamedShare * std::max(hit.width, 1e-6f)),
                                       level_of(groups.cell[leaf]));
            const Sum& box = boxes[static_cast<size_t>(level)].at(key(leaf, level));
            sum += box.light / std::max(box.area, 1e-12);
        }
        found.push_back(sum / CellScene::kRays);
    }
    return {scene, found, scene.points().hits.size()};
}

/// Gathers by split rays (fig. 12 b): four that tile a ray's solid angle take its place unless all end in the
/// group that it names. `whole`: four take the place of every ray.
inline GatherErrors gathered_by_split(const CellScene& scene, const LitCells& cells, bool whole) {
    using gi::paths::kNone;
    const gi::paths::Groups& groups = cells.groups;
    std::vector<double> found(scene.compared().size());
    std::vector<size_t> kept(found.size(), 0);
    parallel_ranges(found.size(), 4, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const size_t point = scene.compared()[i];
            const gi::paths::GatheringPoint& at = scene.points().points[point];
            for (uint32_t ray = 0; ray < CellScene::kRays; ++ray) {
                const glm::dvec2 middle = gi::paths::even_point(ray, CellScene::kSeed, at.side);
                uint32_t named = kNone;  // by the first of the four, so that none counts more than others
                bool is_one = !whole;
                double parts = 0;
                for (int part = 0; part < 4; ++part) {
                    constexpr double kHalf = .25 / 16;  // of the side of a square with 1 / kRays of the area
                    glm::dvec2 square = middle + kHalf * glm::dvec2(part & 1 ? 1 : -1, part & 2 ? 1 : -1);
                    square -= glm::floor(square);
                    float distance = 0;
                    const auto ends = gi::paths::follow(scene.surfaces(), scene.start_of(point),
                                                        gi::paths::cosine_direction(at.normal, square),
                                                        4 * CellScene::kRays, distance);
                    const uint32_t leaf = ends.side == kNone ? kNone : groups.leaf_of[ends.side];
                    if (part == 0 && leaf != kNone)
                        named = groups.fitting(leaf, 2 * kNamedShare * ends.width);
                    uint32_t about = leaf;
                    while (about != kNone && about != named) about = groups.parent[about];
                    is_one = is_one && about == named;
                    if (leaf != kNone)
                        parts += cells.light[groups.fitting(leaf, kNamedShare * ends.width)] / 4;
                }
                found[i] += (is_one ? named == kNone ? 0 : cells.light[named] : parts) / CellScene::kRays;
                kept[i] += is_one ? 1 : 4;
            }
        }
    });
    double sum = 0;
    for (const size_t own : kept) sum += static_cast<double>(own);
    const double share = sum / static_cast<double>(kept.size() * CellScene::kRays);
    return {scene, found, static_cast<size_t>(share * static_cast<double>(scene.points().hits.size()))};
}

/// Fig. 7: cells whose sizes follow the rays beside even ones, as small and as many.
inline void figure_7(const CellScene& scene, const LitCells& adaptive, const std::string& what) {
    heading("fig. 7: " + what +
            ", bounce 1 at points from the leaves that rays meet; even cells beside adaptive ones");
    fmt::print("{:>46} {:>9} {:>8} {:>11} {:>9} {:>7} {:>8} {:>8}\n", "", "energy %", "rms %", "dark",
               "Mrays", "CPU-s", "leaves", "groups");
    const auto row = [&](const std::string& name, const LitCells& cells) {
        std::vector<double> found;
        for (const size_t point : scene.compared()) {
            double sum = 0;
            for (uint32_t ray = 0; ray < CellScene::kRays; ++ray)
                if (const auto side = scene.points().hits[point * CellScene::kRays + ray].side;
                    side != gi::paths::kNone)
                    sum += cells.light[cells.groups.leaf_of[side]];
            found.push_back(sum / CellScene::kRays);
        }
        const GatherErrors errors(scene, found, scene.points().hits.size());
        fmt::print("{:>46} {:>9.2f} {:>8.1f} {:>11} {:>9.2f} {:>7.1f} {:>8} {:>8}\n", name,
                   100 * errors.energy, 100 * errors.rms,
                   std::isnan(errors.leak) ? "-" : fmt::format("{:.2g}", errors.leak),
                   1e-6 * static_cast<double>(errors.rays), cells.cpu_seconds, cells.groups.leaves,
                   cells.groups.count());
        std::fflush(stdout);
    };
    const auto even = [&](float edge) {
        std::vector<gi::paths::RayHit> hits;
        for (gi::paths::Side side = 0; side < 2 * scene.surfaces().surfels().size(); ++side)
            if (scene.surfaces().exists(side)) hits.push_back({side, 1e-9f});
        return LitCells(scene, hits, edge);
    };
    row("adaptive", adaptive);
    float edge = scene.least_cell();
    for (bool more = true; more; edge *= 2) {
        const LitCells cells = even(edge);
        const auto leaves = std::span(cells.groups.cell).first(cells.groups.leaves);
        row(fmt::format("even, {:.2g} m", *std::ranges::min_element(leaves)), cells);
        more = cells.groups.leaves > adaptive.groups.leaves;
    }
}

/// Fig. 12: what a ray takes for the light of its cross section.
inline void figure_12(const CellScene& scene, const LitCells& cells, const std::string& what) {
    heading("fig. 12: " + what + ", bounce 1 at points; dark: light of points that see none, over the mean");
    fmt::print("{:>46} {:>9} {:>8} {:>11} {:>9}\n", "", "energy %", "rms %", "dark", "Mrays");
    const auto row = [&](const std::string& name, const auto& errors_of) {
        const std::clock_t start = std::clock();
        const GatherErrors errors = errors_of();
        print_gathered(name, errors, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    };
    row("lit where rays hit", [&] {
        std::vector<double> found;
        for (const size_t point : scene.compared()) {
            double sum = 0;
            for (uint32_t ray = 0; ray < CellScene::kRays; ++ray)
                sum += scene.at_hits()[point * CellScene::kRays + ray];
            found.push_back(sum / CellScene::kRays);
        }
        return GatherErrors(scene, found, scene.points().hits.size());
    });
    row("a: the paper's cells", [&] { return gathered_from_boxes(scene, cells); });
    row("groups, of one surface each", [&] { return gathered_from(scene, cells); });
    row("b: groups, rays split in four where they differ",
        [&] { return gathered_by_split(scene, cells, false); });
    row("groups, all rays split in four", [&] { return gathered_by_split(scene, cells, true); });
}

/// Fig. 13: how the levels are made from each other.
inline void figure_13(const LitCells& cells, const std::string& what) {
    heading("figs 13 and 14: " + what + ", groups that each level pulls from finer ones");
    fmt::print("{:>12} {:>8} {:>10} {:>10}\n", "cell, m", "groups", "children", "each");
    uint32_t begin = cells.groups.leaves;
    for (const uint32_t end : cells.groups.level_ends) {
        const uint32_t first = begin - cells.groups.leaves, last = end - cells.groups.leaves;
        const uint32_t children = cells.groups.first[last] - cells.groups.first[first];
        if (end > begin)
            fmt::print("{:>12.3g} {:>8} {:>10} {:>10.2f}\n", cells.groups.cell[begin], end - begin, children,
                       static_cast<double>(children) / (end - begin));
        begin = end;
    }
    std::fflush(stdout);
}

inline Result<void> figures_of_cells(gi::Device& device, const BenchRun& run) {
    for (const std::string& scene : run.cases<std::string>({"lattice", "cornell", "nave"})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(scene, run.points(200'000), run.folder));
        LUCARNE_ASSIGN(const auto cell_scene, CellScene::create(device, scan.cache(), scene_file(scene)));
        const LitCells cells(*cell_scene, cell_scene->points().hits, cell_scene->least_cell());
        const std::string what = fmt::format("{}, {} points of {} rays", scene,
                                             cell_scene->points().points.size(), CellScene::kRays);
        if (run.wants("7")) figure_7(*cell_scene, cells, what);
        if (run.wants("12")) figure_12(*cell_scene, cells, what);
        if (run.wants("13")) figure_13(cells, what);
    }
    return {};
}

}  // namespace lucarne::bench
