#include "viewer/commands/options/input_options.h"

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
    const ArgumentGroup group(command, "Reading scans");
    command
        .add("--columns", options.columns,
             "Columns of a text file, such as x,y,z,-,intensity:f32,r,g,b (- skips a column); "
             "by default they are guessed, and the guess is printed")
        .type_name("NAMES");
    command
        .parsed(
            "--unit",
            [&options](const std::string& text) {
                options.metres_per_unit = metres_of(text);
                return problem_unless(options.metres_per_unit.has_value(),
                                      "is neither m, cm, mm, km, ft, us-ft or in, nor a number of metres");
            },
            "Unit of the scans' coordinates if a file does not state it or is wrong: m, cm, mm, km, "
            "ft, us-ft, "
            "in, or the unit's length in metres")
        .type_name("UNIT");
    command
        .parsed(
            "--up",
            [&options](const std::string& text) {
                const auto up = io::up_axis(text);
                options.up = up.value_or(io::UpAxis::z);
                return problem_unless(up.has_value(), "is none of x, y, z, -x, -y, -z");
            },
            "Axis of the scans' files that points up: x, y, z (default), -x, -y, -z")
        .type_name("AXIS");
    const Argument spacing =
        command
            .add("--spacing", options.mesh.spacing,
                 "Mean distance between the points sampled on a mesh, in metres (default: a thousandth of "
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
            "Sample about this many points on a mesh, instead of --spacing")
        .type_name("N")
        .excludes(spacing);
    command.flag("--vertices", options.mesh.vertices,
                 "Take a mesh's vertices as the points and ignore its faces");
    command.flag("--salvage", options.salvage,
                 "Read what can be read of damaged and truncated scan files, and report what cannot");
}

void add_input_options(Arguments& command, InputOptions& options) {
    command.add("INPUT", options.paths, "Caches or scan files, shown together").required(options.required);
    command.flag(
        "--no-cache", options.no_cache,
        "Convert scans again and keep no cache (by default it is kept as SCAN.luc beside the scan, or in "
        "the user's cache folder, and used the next time)");
    add_read_options(command, options.read);
}

}  // namespace lucarne::viewer
