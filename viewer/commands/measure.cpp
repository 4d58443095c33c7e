#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/terminal.h"
#include "io/files/file.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/inputs/input.h"
#include "viewer/measure/file.h"
#include "viewer/measure/section/section.h"
#include "viewer/picking/nearest.h"

namespace lucarne::viewer {
namespace {

struct MeasureOptions {
    InputOptions input;
    std::string measurements, output, sections, results = "m";
    std::vector<std::vector<double>> at;
    std::string json_file;
    uint64_t section_points = kMostSectionPoints;
    bool snap = false, overwrite = false;
};

/// Returns the scan's points nearest to the requested places, as measurements of kind "point".
Result<std::vector<Measurement>> points_at(const MeasureOptions& options, NodeCache& cache) {
    std::vector<Measurement> all;
    for (const std::vector<double>& place : options.at) {
        if (place.size() != 3) return bad_arguments("--at", "takes three numbers", "give X,Y,Z");
        LUCARNE_ASSIGN(auto found, nearest_point(cache, {place[0], place[1], place[2]}, INFINITY));
        if (!found) return rejected("--at", "the scan has no points");
        Measurement point;
        point.name = fmt::format("Point {}", all.size() + 1);
        point.points.push_back(std::move(*found));
        all.push_back(std::move(point));
    }
    return all;
}

Result<void> snap(std::vector<Measurement>& all, NodeCache& cache) {
    for (Measurement& measurement : all)
        for (ExactPoint& point : measurement.points) {
            LUCARNE_ASSIGN(auto found, nearest_point(cache, point.position, INFINITY));
            if (found) point = std::move(*found);
        }
    return {};
}

/// Writes section-1.csv and section-1.svg, and so on, in the order of the measurements.
Result<void> write_sections(const MeasureOptions& options, const std::vector<Measurement>& all,
                            const UnitChoice& units, NodeCache& cache) {
    size_t number = 0;
    for (const Measurement& measurement : all) {
        if (measurement.kind != MeasureKind::section) continue;
        LUCARNE_ASSIGN(const Section section,
                       read_section(*cache.source(), Slice::of(measurement), options.section_points,
                                    [](const Section&, bool) { return true; }));
        const auto path = std::filesystem::path(options.sections) / fmt::format("section-{}", ++number);
        LUCARNE_TRY(check_outputs({path.string() + ".csv", path.string() + ".svg"}, options.overwrite,
                                  options.input.paths));
        LUCARNE_TRY(write_section(path, section, measurement.name, units, cache, options.overwrite));
        log::info("{}.csv and .svg: {} points of {}{}", path.string(), section.points.size(),
                  measurement.name,
                  section.complete ? "" : ", a sample: there are more than --section-points");
    }
    return {};
}

Result<void> measure(const MeasureOptions& options) {
    if (options.measurements.empty() && options.at.empty())
        return bad_arguments("measure", "there is nothing to measure",
                             "give a file of measurements or --at X,Y,Z");
    // Measurements may be saved to the file they came from, but no other output may replace that file.
    LUCARNE_TRY(check_outputs({options.output, options.json_file}, options.overwrite, options.input.paths));
    if (!options.measurements.empty())
        LUCARNE_TRY(check_outputs({options.json_file}, options.overwrite, {options.measurements}));
    LUCARNE_ASSIGN(auto source, open_input(options.input));
    const double metres_per_unit = source->header().metres_per_unit;
    NodeCache cache(std::move(source));
    const UnitChoice units{options.results == "m", metres_per_unit};
    LUCARNE_ASSIGN(std::vector<Measurement> all, points_at(options, cache));
    if (!options.measurements.empty()) {
        LUCARNE_ASSIGN(auto loaded, load_measurements(options.measurements, metres_per_unit));
        if (options.snap) LUCARNE_TRY(snap(loaded, cache));
        all.insert(all.end(), std::make_move_iterator(loaded.begin()), std::make_move_iterator(loaded.end()));
    }
    if (options.output.empty())
        print_lines(measurements_text(all, units));
    else
        LUCARNE_TRY(save_measurements(options.output, all, units, options.overwrite));
    if (!options.json_file.empty())
        LUCARNE_TRY(
            write_file(options.json_file, measurements_json(all, metres_per_unit), options.overwrite));
    return options.sections.empty() ? Result<void>{} : write_sections(options, all, units, cache);
}

}  // namespace

void add_measure(CommandLine& line) {
    auto options = std::make_shared<MeasureOptions>();
    Arguments command = line.add("measure", "Measure as the window does: points, distances, areas, sections");
    add_input_options(command, options->input);
    command
        .add("--measurements", options->measurements,
             "What to measure, as the window saves it (data/README.md)")
        .type_name("FILE.json");
    command
        .add("--at", options->at,
             "Show everything about the scan's point nearest to this place; may be repeated")
        .separator(',')
        .type_name("X,Y,Z");
    command.flag("--snap", options->snap,
                 "First move the measurements' points to the nearest points of the scan");
    command
        .add("-o,--output", options->output,
             "Write a table (.csv) or the measurements (.json); by default they are printed")
        .type_name("FILE");
    command.add("--json", options->json_file, "Also write the results as JSON").type_name("FILE");
    command.add("--results", options->results, "Unit of the results: metres or the scan file's own unit")
        .one_of({"m", "file"})
        .show_default();
    command
        .add("--sections", options->sections,
             "Write every section to this folder, as points and as a drawing")
        .type_name("FOLDER");
    command.add("--section-points", options->section_points, "Largest number of points of a section")
        .range(uint64_t{1}, uint64_t{100'000'000})
        .show_default();
    command.flag("--overwrite", options->overwrite, "Replace outputs that exist");
    command.run([options] { return measure(*options); });
}

}  // namespace lucarne::viewer
