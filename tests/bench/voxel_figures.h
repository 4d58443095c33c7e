// The experiments of Gaitatzes 2012 on voxels, chapters 6 and 7, repeated with meshes of ours.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/raster/gbuffer.h"
#include "gi/scene/views.h"
#include "gi/volume/images/image_voxels.h"
#include "gi/volume/surfel_voxels.h"
#include "gi/volume/triangles/areas.h"
#include "gi/volume/triangles/raster_voxels.h"
#include "io/files/file.h"
#include "tests/bench/all_surfels.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_figures.h"
#include "tests/bench/quantile.h"
#include "tests/bench/rows.h"
#include "tests/bench/voxel_models.h"

namespace lucarne::bench {

/// Table 3 for one mesh: times and counts of both methods by the limit on vertices.
inline Result<void> row_of_table_3(gi::Device& device, const VoxelModel& model, uint32_t voxels) {
    using gi::volume::Slicing;
    LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
    const glm::ivec3 size = triangles.grid().size;
    fmt::print("{:<8} {:>5} {:>12} {:>7.2f}", model.name, voxels,
               fmt::format("{}x{}x{}", size.x, size.y, size.z),
               2e-6 * static_cast<double>(triangles.grid().cells()));
    size_t whole[2] = {};
    gi::volume::VoxelSet sets[2];
    for (const Slicing slicing : {Slicing::cut, Slicing::discard}) {
        const bool cuts = slicing == Slicing::cut;
        for (const uint32_t vertices :
             cuts ? std::vector<uint32_t>{7, 11, 15, 19} : std::vector<uint32_t>{6, 9, 12, 15}) {
            const gi::volume::RasterVoxelOptions options{slicing, vertices, 16, false, false};
            Result<gi::volume::VoxelSet> set = failed("voxels", "not drawn");
            const double time =
                milliseconds_of([&] { set = gi::volume::rasterize_triangles(device, triangles, options); });
            if (!set) return tl::make_unexpected(set.error());
            whole[cuts ? 0 : 1] = set->voxels.size();
            fmt::print(" {:>6.0f}", time);
            sets[cuts ? 0 : 1] = std::move(*set);
        }
    }
    fmt::print(" {:>8} {:>8} {:>7.3f} %\n", whole[0], whole[1],
               100.0 * static_cast<double>(gi::volume::difference(sets[0], sets[1]).all()) /
                   static_cast<double>(whole[1]));
    std::fflush(stdout);
    return {};
}

/// Returns how long rasterize_triangles() takes: the median of some runs, after one that makes the shaders.
inline Result<double> voxels_ms(gi::Device& device, const BenchRun& run,
                                const gi::volume::MeshTriangles& triangles,
                                const gi::volume::RasterVoxelOptions& options) {
    std::vector<double> times;
    Result<gi::volume::VoxelSet> set = failed("voxels", "not drawn");
    for (int i = 0; i <= run.frames(5); ++i) {
        times.push_back(
            milliseconds_of([&] { set = gi::volume::rasterize_triangles(device, triangles, options); }));
        if (!set) return tl::make_unexpected(set.error());
    }
    times.erase(times.begin());
    std::ranges::nth_element(times, times.begin() + static_cast<ptrdiff_t>(times.size() / 2));
    return times[times.size() / 2];
}

/// Tables 4, 6 and 7 for one mesh: times by what is written, by device and by the size of numbers.
inline Result<void> tables_of_targets(gi::Device& device, const BenchRun& run, const VoxelModel& model,
                                      const std::vector<uint32_t>& grids) {
    using gi::volume::Slicing;
    // The limits on vertices of the thesis.
    const auto limited = [](Slicing slicing) {
        return gi::volume::RasterVoxelOptions{.slicing = slicing,
                                              .vertices = slicing == Slicing::cut ? 15u : 9u};
    };
    heading("table 4: ms by attributes of 32 bits (the thesis: 1, 2, 3 render targets of four components)");
    fmt::print("{:<8} {:>5} {:<10} {:>10} {:>10} {:>20}\n", "mesh", "grid", "by", "coverage", "+ albedo",
               "+ albedo, normals");
    for (const uint32_t voxels : grids) {
        LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
        for (const Slicing slicing : {Slicing::cut, Slicing::discard}) {
            double times[3] = {};
            for (int i = 0; i < 3; ++i) {
                auto options = limited(slicing);
                options.albedo = i > 0;
                options.normals = i > 1;
                LUCARNE_ASSIGN(times[i], voxels_ms(device, run, triangles, options));
            }
            fmt::print("{:<8} {:>5} {:<10} {:>10.0f} {:>10.0f} {:>20.0f}\n", model.name, voxels,
                       slicing == Slicing::cut ? "geometry" : "slices", times[0], times[1], times[2]);
            std::fflush(stdout);
        }
    }
    fmt::print(
        "the thesis (GTX 285), bunny, geometry; slices: 64 2.36, 2.54, 2.70; 1.33, 1.33, 1.52; 128 3.22, "
        "4.12, "
        "5.18; 2.90, 2.90, 3.96; 256 10.2, 17.4, 25.1; 15.8, 15.9, 24.3\n");

    const uint32_t middle = grids[grids.size() / 2];
    heading(fmt::format("table 6: ms by device, {} at {}", model.name, middle));
    LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, middle));
    LUCARNE_ASSIGN(const double geometry, voxels_ms(device, run, triangles, limited(Slicing::cut)));
    LUCARNE_ASSIGN(const double slices, voxels_ms(device, run, triangles, limited(Slicing::discard)));
    fmt::print("{}: geometry {:.0f}, slices {:.0f}; compare with what other devices print\n",
               device.info().renderer, geometry, slices);
    fmt::print("the thesis, bunny at 128: G 105M 51.2, 30.8; GTS 9800M 13.5, 6.33; GTX 285 2.66, 1.72\n");

    heading("table 7: ms by the bits of each component, geometry with 15 vertices, all attributes");
    for (const uint32_t voxels : grids) {
        LUCARNE_ASSIGN(const auto grid, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
        double times[2] = {};
        for (int i = 0; i < 2; ++i) {
            auto options = limited(Slicing::cut);
            options.bits = i == 0 ? 16 : 32;
            LUCARNE_ASSIGN(times[i], voxels_ms(device, run, grid, options));
        }
        fmt::print("{:<8} {:>5}: 16 bits {:.0f}, 32 bits {:.0f}\n", model.name, voxels, times[0], times[1]);
        std::fflush(stdout);
    }
    fmt::print("the thesis, bunny: 64 2.03, 2.04; 128 2.66, 2.80; 256 6.43, 7.25\n");
    return {};
}

inline Result<void> figures_of_chapter_6(gi::Device& device, const BenchRun& run) {
    using gi::volume::Slicing;
    LUCARNE_ASSIGN(VoxelModel knot, knot_model());
    LUCARNE_ASSIGN(VoxelModel nave, scene_model("nave", "nave", run.trial() ? 4 : .5));
    const std::vector<VoxelModel> models = {std::move(knot), std::move(nave)};
    const std::vector<uint32_t> grids =
        run.trial() ? std::vector<uint32_t>{32} : std::vector<uint32_t>{64, 128, 256};
    for (const VoxelModel& model : models)
        fmt::print("{}: {} triangles, {:.1f} m2\n", model.name, model.mesh.triangles.size(),
                   model.mesh.area());

    heading(
        "table 3: one channel of 16 bits; ms by the limit on vertices; voxels at the largest limits, and how "
        "many differ");
    fmt::print("{:<8} {:>5} {:>12} {:>7} {:>27} {:>27} {:>8} {:>8} {:>9}\n", "mesh", "grid", "actual", "MB",
               "geometry: 7 11 15 19", "slices: 6 9 12 15", "geometry", "slices", "differ");
    for (const VoxelModel& model : models)
        for (const uint32_t voxels : grids) LUCARNE_TRY(row_of_table_3(device, model, voxels));
    fmt::print(
        "the thesis (GTX 285): bunny, 69451 triangles: 64 1.74 to 2.51 and 1.13 to 1.58 ms, 5.3K voxels; 128 "
        "2.37 to "
        "3.19 and 1.71 to 2.16 ms, 22K; 256 5.92 to 6.98 and 4.92 to 5.48 ms, 89.6K\n");

    LUCARNE_TRY(tables_of_targets(device, run, models.front(), grids));

    heading("table 5: voxels by method; (times those at half the grid)");
    fmt::print("{:<8} {:>5} {:>20} {:>20} {:>20} {:>12} {:>14}\n", "mesh", "grid", "slices",
               "area: all that are met", "surfels", "area, ms", "area over mesh");
    for (const VoxelModel& model : models) {
        size_t before[3] = {};
        for (const uint32_t voxels : grids) {
            LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
            LUCARNE_ASSIGN(const auto slices,
                           gi::volume::rasterize_triangles(device, triangles, {.slicing = Slicing::discard}));
            gi::volume::VoxelSet area;
            const double time = milliseconds_of([&] { area = gi::volume::areas_of_triangles(triangles); });
            // Discs about points of the mesh that are a third of a voxel apart.
            std::vector<gi::Surfel> surfels;
            const double spacing = static_cast<double>(triangles.grid().voxel) / 3;
            const auto count =
                std::min<size_t>(4'000'000, static_cast<size_t>(model.mesh.area() / (spacing * spacing)));
            const float share = static_cast<float>(model.mesh.area()) / static_cast<float>(count);
            for (const auto& [point, normal] : points_with_normals(model.mesh, count))
                surfels.push_back({glm::vec3(point - triangles.origin()), normal, glm::vec3(.5f),
                                   1.3f * std::sqrt(share), share, 0});
            LUCARNE_ASSIGN(const auto discs,
                           gi::volume::voxels_of_surfels(surfels, triangles.grid(), triangles.origin()));
            const size_t counts[3] = {slices.voxels.size(), area.voxels.size(), discs.voxels.size()};
            fmt::print("{:<8} {:>5}", model.name, voxels);
            for (int i = 0; i < 3; ++i) {
                fmt::print(" {:>20}", before[i] ? fmt::format("{} ({:.2f})", counts[i],
                                                              static_cast<double>(counts[i]) /
                                                                  static_cast<double>(before[i]))
                                                : std::to_string(counts[i]));
                before[i] = counts[i];
            }
            fmt::print(" {:>12.0f} {:>14.6f}\n", time, area.area() / triangles.area());
            std::fflush(stdout);
        }
    }
    fmt::print(
        "the thesis, bunny at 64, 128 (times), 256 (times): its slicing 5.3K, 22K (4.15), 89.6K (4.07); Fang "
        "et al. 5.5K, "
        "22.2K (4.04), 90.3K (4.07); Eisemann et al. 2.1K, 18.6K (8.9), 145K (7.8)\n");

    const VoxelModel& model = models.front();
    const uint32_t coarse = run.trial() ? 32 : 128, fine = run.trial() ? 48 : 256;
    heading(
        fmt::format("fig. 65: {} at {}: geometry and slices with 11 vertices (the thesis' bunny: 33 voxels "
                    "differ, .15 %)",
                    model.name, coarse));
    LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, coarse));
    LUCARNE_ASSIGN(const auto cut, gi::volume::rasterize_triangles(
                                       device, triangles, {.slicing = Slicing::cut, .vertices = 11}));
    LUCARNE_ASSIGN(
        const auto discarded,
        gi::volume::rasterize_triangles(device, triangles, {.slicing = Slicing::discard, .vertices = 11}));
    const auto differing = gi::volume::difference(cut, discarded);
    fmt::print("{} voxels differ, {:.3f} %: {} only by geometry (green), {} only by slices (red)\n",
               differing.all(),
               100.0 * static_cast<double>(differing.all()) / static_cast<double>(cut.voxels.size()),
               differing.only_first, differing.only_second);
    std::vector<DrawnVoxel> both = drawn(cut, glm::vec3(0, .8f, 0));
    for (DrawnVoxel& voxel : drawn(discarded, glm::vec3(.9f, 0, 0))) {
        const auto same =
            std::ranges::find_if(both, [&](const DrawnVoxel& other) { return other.middle == voxel.middle; });
        if (same != both.end())
            same->colour = glm::vec3(.75f);
        else
            both.push_back(voxel);
    }
    LUCARNE_TRY(
        io::write_png(run.folder / "fig-65.png", voxel_picture(both, cut.grid.voxel, run.side(800)), true));

    heading(
        fmt::format("fig. 66: {} at {}: slices with 3, 6, 9 and 12 vertices (the thesis' bunny: 52382, "
                    "87690, 89696 and 89696 voxels)",
                    model.name, fine));
    LUCARNE_ASSIGN(const auto finer, gi::volume::MeshTriangles::create(model.mesh, 1, fine));
    LUCARNE_ASSIGN(const auto all,
                   gi::volume::rasterize_triangles(device, finer, {.slicing = Slicing::discard}));
    for (const uint32_t vertices : {3u, 6u, 9u, 12u}) {
        LUCARNE_ASSIGN(const auto set,
                       gi::volume::rasterize_triangles(device, finer,
                                                       {.slicing = Slicing::discard, .vertices = vertices}));
        fmt::print("{:>2} vertices: {} voxels, {:.2f} % of {}\n", vertices, set.voxels.size(),
                   100.0 * static_cast<double>(set.voxels.size()) / static_cast<double>(all.voxels.size()),
                   all.voxels.size());
        LUCARNE_TRY(io::write_png(run.folder / fmt::format("fig-66-{}.png", vertices),
                                  voxel_picture(drawn(set, glm::vec3(.8f)), set.grid.voxel, run.side(800)),
                                  true));
    }
    return {};
}

/// Pictures of a model by a camera that goes round it.
class Tour {
 public:
    static Result<Tour> create(gi::Device& device, const VoxelModel& model, const BenchRun& run,
                               uint32_t side) {
        const std::string mesh = run.folder / (model.name + ".obj"),
                          cache = run.folder / (model.name + ".luc");
        std::string text;
        for (const glm::dvec3& p : model.mesh.positions)
            text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
        for (const auto& [a, b, c] : model.mesh.triangles)
            text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
        LUCARNE_TRY(write_file(mesh, text, true));
        LUCARNE_TRY(run_lucarne({"convert", mesh, "-o", cache, "--mesh-points",
                                 std::to_string(run.points(1'500'000)), "--overwrite"}));
        LUCARNE_ASSIGN(auto surfels, whole_cut(device, cache));
        return Tour(device, std::move(surfels), model, side);
    }

    /// Takes the next picture: one turn about each axis.
    Result<gi::volume::SeenImage> take(int number, int turn) {
        const double angle = 2 * M_PI * (number % turn + .5) / turn, reach = 1.1 * glm::length(extent_);
        const int axis = number / turn % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
        gi::SceneCamera camera{.target = middle_, .vertical_fov = .9};
        camera.position = middle_;
        camera.position[u] += reach * std::cos(angle);
        camera.position[v] += reach * std::sin(angle);
        camera.up = glm::dvec3(0.0);
        camera.up[axis] = 1;
        view_ = gi::camera_view(camera, {side_, side_}, {});
        drawing_ms_ += milliseconds_of([&] {
            drawn_ = gi::rasterize(device_, surfels_->cut, view_, gbuffer_);
            if (drawn_) texels_ = gbuffer_.texels.download_all<gi::GBufferTexel>(size_t{side_} * side_);
        });
        if (!drawn_) return tl::make_unexpected(drawn_.error());
        ++pictures_;
        return gi::volume::SeenImage{view_, texels_};
    }
    double milliseconds_a_picture() const { return drawing_ms_ / std::max(1, pictures_); }

 private:
    Tour(gi::Device& device, std::unique_ptr<WholeCut> surfels, const VoxelModel& model, uint32_t side)
        : device_(device),
          surfels_(std::move(surfels)),
          middle_((model.mesh.low + model.mesh.high) / 2.0),
          extent_(model.mesh.high - model.mesh.low),
          side_(side) {}

    gi::Device& device_;
    std::unique_ptr<WholeCut> surfels_;
    glm::dvec3 middle_, extent_;
    uint32_t side_;
    gi::GBuffer gbuffer_;
    gi::CameraView view_{};
    std::vector<gi::GBufferTexel> texels_;
    Result<void> drawn_;
    double drawing_ms_ = 0;
    int pictures_ = 0;
};

/// A window about a model with `voxels` along its longest side, and one voxel of margin.
inline gi::volume::ImageVoxels window_about(const VoxelModel& model, uint32_t voxels) {
    const glm::dvec3 extent = model.mesh.high - model.mesh.low;
    const double voxel = std::max({extent.x, extent.y, extent.z}) / voxels;
    const glm::ivec3 low = glm::ivec3(glm::floor(model.mesh.low / voxel)) - 1,
                     high = glm::ivec3(glm::floor(model.mesh.high / voxel)) + 2;
    return {high - low, static_cast<float>(voxel), low};
}

/// Prints mean and largest distances between a mesh and the middles of voxels, in % of its box's diagonal.
inline void row_of_table_9(const VoxelModel& model, const std::string& method, uint32_t voxels,
                           const gi::volume::VoxelSet& set, const std::vector<glm::dvec3>& on_mesh,
                           const NearestPoint& mesh) {
    std::vector<glm::dvec3> middles;
    for (const auto& voxel : set.voxels) middles.push_back(set.middle(voxel));
    const NearestPoint nearest(middles, 2 * static_cast<double>(set.grid.voxel));
    std::vector<glm::dvec3> some;
    for (size_t i = 0; i < on_mesh.size(); i += 16) some.push_back(on_mesh[i]);
    const Distances there = distances(some, nearest), back = distances(middles, mesh);
    const double diagonal = glm::length(model.mesh.high - model.mesh.low) / 100;
    fmt::print("{:<8} {:>5} {:<32} {:>8} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f}\n", model.name, voxels, method,
               middles.size(), there.mean / diagonal, back.mean / diagonal, there.largest / diagonal,
               back.largest / diagonal);
    std::fflush(stdout);
}

inline Result<void> figures_of_chapter_7(gi::Device& device, const BenchRun& run) {
    LUCARNE_ASSIGN(const VoxelModel model, knot_model());
    const uint32_t side = run.trial() ? 96 : 512;
    const int turn = run.trial() ? 2 : 24;
    LUCARNE_ASSIGN(Tour tour, Tour::create(device, model, run, side));
    const std::vector<uint32_t> grids =
        run.trial() ? std::vector<uint32_t>{32} : std::vector<uint32_t>{64, 128, 256};
    struct Way {
        std::string name;
        gi::volume::ImageUpdate how;
    };
    const std::vector<Way> ways = {{"pictures", {}},
                                   {"pictures, the thesis' cleanup", {.careful = false}},
                                   {"pictures, fused", {.fused = true}},
                                   {"pictures, fused, the thesis'", {.fused = true, .careful = false}},
                                   {"one picture alone", {}}};
    heading(
        fmt::format("table 9: distances in % of the diagonal, {} pictures of {}x{}; the thesis prints a "
                    "mean: dragon 64 .36 "
                    "(full voxelization .26), 128 .19 (.13), 256 .13 (.065)",
                    3 * turn, side, side));
    fmt::print("{:<8} {:>5} {:<32} {:>8} {:>9} {:>9} {:>9} {:>9}\n", "mesh", "grid", "voxels by", "voxels",
               "mean: to", "from", "sup: to", "from");
    const std::vector<glm::dvec3> on_mesh = points_on(model.mesh, run.trial() ? 20'000 : 1'000'000);
    const NearestPoint mesh(on_mesh, glm::length(model.mesh.high - model.mesh.low) / 400);
    std::vector<std::vector<double>> times;  // by grid and way, ms an update
    for (const uint32_t voxels : grids) {
        std::vector<gi::volume::ImageVoxels> windows;
        for (size_t i = 0; i < ways.size(); ++i) windows.push_back(window_about(model, voxels));
        times.emplace_back(ways.size());
        for (int picture = 0; picture < 3 * turn; ++picture) {
            LUCARNE_ASSIGN(const gi::volume::SeenImage image, tour.take(picture, turn));
            for (size_t i = 0; i < ways.size(); ++i) {
                if (i == 4 && picture > 0) continue;
                gi::volume::ImageUpdate how = ways[i].how;
                how.samples = 2 * voxels;
                times.back()[i] += milliseconds_of([&] { windows[i].update({&image, 1}, how); }) / (3 * turn);
            }
        }
        for (size_t i = 0; i < ways.size(); ++i)
            row_of_table_9(model, ways[i].name, voxels, windows[i].set(), on_mesh, mesh);
        LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
        LUCARNE_ASSIGN(const auto slices, gi::volume::rasterize_triangles(
                                              device, triangles, {.slicing = gi::volume::Slicing::discard}));
        row_of_table_9(model, "triangles, slices", voxels, slices, on_mesh, mesh);
        row_of_table_9(model, "triangles, area", voxels, gi::volume::areas_of_triangles(triangles), on_mesh,
                       mesh);
        LUCARNE_TRY(io::write_png(
            run.folder / fmt::format("fig-75-{}.png", voxels),
            voxel_picture(drawn(windows[0].set(), glm::vec3(.8f)), windows[0].voxel(), run.side(800)), true));
    }
    heading(
        fmt::format("table 8: ms an update by one picture, two samples across a voxel; the thesis (GTX 285): "
                    "128 .14 to .33 ms, 512 4.9 to "
                    "7 ms; a picture itself takes {:.0f} ms",
                    tour.milliseconds_a_picture()));
    fmt::print("{:<8} {:>5} {:>22} {:>22} {:>10} {:>18}\n", "mesh", "grid", "cleanup and injection",
               "the thesis' cleanup", "fused", "area of triangles");
    for (size_t i = 0; i < grids.size(); ++i) {
        LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, grids[i]));
        const double area = milliseconds_of([&] { gi::volume::areas_of_triangles(triangles); });
        fmt::print("{:<8} {:>5} {:>22.1f} {:>22.1f} {:>10.1f} {:>18.0f}\n", model.name, grids[i], times[i][0],
                   times[i][1], times[i][2], area);
    }
    return {};
}

}  // namespace lucarne::bench
