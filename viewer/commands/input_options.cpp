#include "viewer/commands/input_options.h"

#include <optional>
#include <string>

#include "io/core/options.h"
#include "viewer/inputs/units.h"

namespace lucarne::viewer {
namespace {

std::optional<std::string> problem_unless(bool good, const char* problem) {
    return good ? std::nullopt : std::optional<std::string>(problem);
}

}  // namespace

void add_read_options(Arguments& command, io::ReadOptions& options) {
    command
        .add("--columns", options.columns,
             "What the columns of a text file are, such as x,y,z,-,intensity:f32,r,g,b (- is left out); "
             "else they are guessed, and the guess is printed")
        .type_name("NAMES");
    command
        .parsed(
            "--unit",
            [&options](const std::string& text) {
                options.metres_per_unit = metres_of(text);
                return problem_unless(options.metres_per_unit.has_value(),
                                      "is none of m, cm, mm, km, ft, us-ft, in, nor a number of metres");
            },
            "The unit of the scans' coordinates, where a file does not say it or is wrong: m, cm, mm, km, "
            "ft, us-ft, "
            "in, or how many metres it has")
        .type_name("UNIT");
    const Argument spacing =
        command
            .add("--spacing", options.mesh.spacing,
                 "Mean distance of the points that a mesh is sampled to, in metres (default: a thousandth of "
                 "its diagonal, or as dense as its vertices)")
            .positive()
            .type_name("METRES");
    command
        .parsed(
            "--mesh-points",
            [&options](const std::string& text) {
                const auto count = parse_count("--mesh-points", text);
                options.mesh.samples = count.value_or(0);
                return problem_unless(options.mesh.samples > 0, "is no number of points");
            },
            "About so many points of a mesh, instead of --spacing")
        .type_name("N")
        .excludes(spacing);
    command.flag("--vertices", options.mesh.vertices,
                 "The vertices of a mesh are the points; its faces are passed over");
    command.flag("--salvage", options.salvage,
                 "Read what can be read of damaged and truncated scan files, and say what cannot");
}

void add_input_options(Arguments& command, InputOptions& options) {
    command.add("INPUT", options.paths, "Caches or scan files, taken together").required(options.required);
    command.flag(
        "--no-cache", options.no_cache,
        "Convert scans anew and keep nothing (else the cache is kept as SCAN.luc beside the scan, or in "
        "the user's cache folder, and found the next time)");
    add_read_options(command, options.read);
}

}  // namespace lucarne::viewer
