#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/options.h"
#include "io/core/progress.h"
#include "io/core/terminal.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/formats/mesh/source.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/open.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/inputs/describe.h"
#include "viewer/inputs/input.h"
#include "viewer/inputs/scan_list.h"
#include "viewer/inputs/units.h"

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
    std::vector<std::string> inputs;
    io::ReadOptions read;
    bool quick = false;
    std::string json_file;
    bool overwrite = false;
};

/// Returns JSON text. File names need not be UTF-8: invalid bytes become U+FFFD.
std::string text_of(const Json& value) {
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<Json> describe_octree(const octree::NodeSource& cache, const char* kind) {
    const auto& header = cache.header();
    struct Level {
        uint64_t nodes = 0, points = 0;
    };
    std::vector<Level> found;
    for (const auto& node : cache.nodes()) {
        if (found.size() <= node.key.level) found.resize(node.key.level + 1);
        ++found[node.key.level].nodes;
        found[node.key.level].points += node.count;
    }
    LUCARNE_TRY(cache.directory_state());
    Json levels = Json::array();
    for (const Level& level : found) levels.push_back({{"nodes", level.nodes}, {"points", level.points}});
    Json scans = Json::array();
    for (const auto& scan : header.scans)
        scans.push_back({{"path", scan.path},
                         {"format", scan.format},
                         {"coordinate_system", scan.coordinate_system},
                         {"epsg", scan.epsg ? Json(scan.epsg) : Json()},
                         {"stations", scan.stations.size()},
                         {"left_out", losses_json(scan.losses)}});
    Json described{{"kind", kind},
                   {"points", header.points},
                   {"nodes", cache.nodes().size()},
                   {"levels", std::move(levels)},
                   {"min", vector_json(header.min)},
                   {"max", vector_json(header.max)},
                   {"root_size", header.root.size},
                   {"bytes_per_point", header.schema.stride},
                   {"unit", unit_name(header.metres_per_unit)},
                   {"metres_per_unit", header.metres_per_unit},
                   {"attributes", attributes_json(header.schema)},
                   {"scans", std::move(scans)}};
    for (const auto& station : header.estimated_stations)
        described["estimated_stations"].push_back(
            {{"scan", station.scan}, {"position", vector_json(station.position)}});
    if (header.filling) described["synthetic_surfels"] = header.filling->points;
    for (const auto& colour : header.station_colours) {
        Json& station = described["station_colours"].emplace_back();
        station["scan"] = colour.scan;
        if (colour.station) station["station"] = *colour.station;
        station["gain"] = vector_json(colour.gain);
        if (colour.unphotographed) station["unphotographed"] = vector_json(*colour.unphotographed);
    }
    return described;
}

Result<Json> describe_scan(std::shared_ptr<const ByteSource> file, const InfoOptions& options) {
    constexpr uint64_t kLong = 20'000'000;  // points: some seconds
    LUCARNE_ASSIGN(const auto scan, io::open_scan(std::move(file), options.read));
    // A mesh of a few bytes may be sampled into millions of points.
    if (options.quick || io::mesh::is_sampled(scan->info()))
        return scan_json(scan->info(), scan->schema(), nullptr);
    std::optional<Progress> progress;
    const uint64_t declared = scan->info().declared_points;
    if (declared > kLong) progress.emplace("looking through", declared, "points");
    LUCARNE_ASSIGN(const auto contents, io::survey(*scan, [&](uint64_t points) {
                       if (progress) progress->add(points);
                   }));
    return scan_json(scan->info(), scan->schema(), &contents);
}

Result<Json> describe(const std::string& path, const InfoOptions& options) {
    LUCARNE_ASSIGN(const std::shared_ptr<const ByteSource> file, InputFile::open_shared(path));
    const octree::OctreeKind kind = octree::octree_kind(*file);
    if (kind == octree::OctreeKind::none) return describe_scan(file, options);
    LUCARNE_ASSIGN(const auto source, octree::open_octree(file));
    if (kind == octree::OctreeKind::cache) return describe_octree(*source, "cache");
    // Its octree knows only the box that the header states.
    LUCARNE_ASSIGN(Json described, describe_octree(*source, "copc"));
    LUCARNE_ASSIGN(const Json scan, describe_scan(file, options));
    for (const char* key : {"min", "max"}) described.erase(key);
    for (const char* key : {"min", "max", "stated_min", "stated_max", "left_out"})
        if (scan.contains(key)) described[key] = scan[key];
    return described;
}

/// Prints 15 digits: further digits of a double do not come from the file.
std::string coordinates_text(const Json& vector) {
    std::string text;
    for (const Json& value : vector)
        text += fmt::format("{}{:.15g}", text.empty() ? "" : " ", value.get<double>());
    return text;
}

void print(const Json& described) {
    const bool assumed = !described.value("unit_stated", true);
    for (const auto& [name, value] : described.items()) {
        if (name == "unit_stated") continue;
        if (name.ends_with("min") || name.ends_with("max")) {
            print_line("{:<17} {}", name, coordinates_text(value));
            continue;
        }
        if (name == "unit" && assumed) {
            print_line("{:<17} {} (assumed)", name, value.get<std::string>());
            continue;
        }
        if (!value.is_array() || value.empty() || !value[0].is_object()) {
            print_line("{:<17} {}", name, value.is_string() ? value.get<std::string>() : text_of(value));
            continue;
        }
        print_line(name);
        for (const auto& item : value) print_line("    {}", text_of(item));
    }
}

Result<void> info(const InfoOptions& options) {
    LUCARNE_ASSIGN(const ScanList list, expand_folders(options.inputs, options.read));
    LUCARNE_TRY(check_outputs({options.json_file}, options.overwrite, list.files));
    const bool several = list.files.size() + list.problems.size() > 1;
    SetAside aside(list, options.read);
    Json all = Json::array();
    for (const std::string& input : list.files) {
        auto described = describe(input, options);
        if (described) {
            if (!all.empty()) print_line("");
            print(*described);
            all.push_back(std::move(*described));
        } else {
            auto only = std::vector{input};
            LUCARNE_TRY(aside.take(std::move(described).error(), only));
        }
    }
    for (const auto& rejected : aside.json()) all.push_back(rejected);
    if (!options.json_file.empty()) {
        LUCARNE_TRY(write_file(options.json_file, json_text(several ? all : all[0]), options.overwrite));
    }
    return aside.result("info", "cannot be read");
}

}  // namespace

void add_info(CommandLine& line) {
    auto options = std::make_shared<InfoOptions>();
    Arguments command = line.add("info", "Show what a cache or scan contains");
    command
        .add("inputs", options->inputs,
             "Caches, scan files, folders of scan files. Broken files among several are skipped")
        .required()
        .type_name("INPUT");
    command.flag(
        "--quick", options->quick,
        "Do not read the points of scans: show only the bounds that headers state, and only the losses "
        "that are known "
        "without reading");
    add_read_options(command, options->read);
    command
        .add("--json", options->json_file,
             "Also write JSON to this file: an object, or a list for several inputs")
        .type_name("FILE");
    command.flag("--overwrite", options->overwrite, "Replace the JSON file if it exists");
    command.run([options] { return info(*options); });
}

}  // namespace lucarne::viewer
