#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/file.h"
#include "io/core/options.h"
#include "io/formats/scan.h"
#include "octree/cache.h"
#include "octree/open.h"
#include "viewer/commands/commands.h"
#include "viewer/input.h"

namespace lucarne::viewer {
namespace {

using json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path input;
    io::ReadOptions read;
    std::string json_file;
    bool overwrite = false;
};

json vector_json(const glm::dvec3& v) {
    return json::array({v.x, v.y, v.z});
}

json attributes_json(const io::Schema& schema) {
    json list = json::array();
    for (const auto& a : schema.attributes)
        list.push_back({{"name", a.name}, {"type", io::scalar_name(a.type)}, {"components", a.components}});
    return list;
}

/// File names need not be UTF-8: what is not becomes U+FFFD.
std::string text_of(const json& value, int indent = -1) {
    return value.dump(indent, ' ', false, json::error_handler_t::replace);
}

json describe_scan(const io::PointSource& scan) {
    const auto& info = scan.info();
    json stations = json::array();
    for (const auto& s : info.stations)
        stations.push_back({{"id", s.id}, {"position", vector_json(s.position)}});
    json described = {{"kind", "scan"},
                      {"format", info.format},
                      {"declared_points", info.declared_points},
                      {"bytes_per_point", scan.schema().stride},
                      {"metres_per_unit", info.metres_per_unit},
                      {"stations", std::move(stations)},
                      {"attributes", attributes_json(scan.schema())}};
    // What a file of several scans says of each, and its images, which are not read (E57); of a mesh.
    const json details = json::parse(info.details, nullptr, false);
    for (const char* list : {"scans", "images", "mesh"})
        if (details.is_object() && details.contains(list)) described[list] = details[list];
    return described;
}

json describe_octree(const octree::NodeSource& cache, const char* kind) {
    const auto& header = cache.header();
    json levels = json::array();
    for (const auto& node : cache.nodes()) {
        while (levels.size() <= node.key.level) levels.push_back({{"nodes", 0}, {"points", 0}});
        auto& level = levels[node.key.level];
        level["nodes"] = level["nodes"].get<uint64_t>() + 1;
        level["points"] = level["points"].get<uint64_t>() + node.count;
    }
    json scans = json::array();
    for (const auto& scan : header.scans)
        scans.push_back({{"path", scan.path}, {"format", scan.format}, {"stations", scan.stations.size()}});
    return {{"kind", kind},
            {"points", header.points},
            {"nodes", cache.nodes().size()},
            {"levels", std::move(levels)},
            {"min", vector_json(header.min)},
            {"max", vector_json(header.max)},
            {"root_size", header.root.size},
            {"bytes_per_point", header.schema.stride},
            {"metres_per_unit", header.metres_per_unit},
            {"attributes", attributes_json(header.schema)},
            {"scans", std::move(scans)}};
}

Result<void> info(const Options& options) {
    json described;
    if (octree::is_octree(options.input)) {
        LUCARNE_ASSIGN(const auto source, octree::open_octree(options.input));
        described = describe_octree(*source, octree::is_cache(options.input) ? "cache" : "copc");
    } else {
        LUCARNE_ASSIGN(const auto scan, io::open_scan(options.input, options.read));
        described = describe_scan(*scan);
    }
    for (const auto& [name, value] : described.items()) {
        if (!value.is_array() || value.empty() || !value[0].is_object()) {
            fmt::print("{:<17}{}\n", name, value.is_string() ? value.get<std::string>() : text_of(value));
            continue;
        }
        fmt::print("{}\n", name);
        for (const auto& item : value) fmt::print("    {}\n", text_of(item));
    }
    if (options.json_file.empty()) return {};
    LUCARNE_ASSIGN(auto file, OutputFile::create(options.json_file, options.overwrite));
    LUCARNE_TRY(file.append(text_of(described, 2) + "\n"));
    return file.commit();
}

}  // namespace

void add_info(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<Options>();
    auto* command = app.add_subcommand("info", "Say what a cache or a scan holds");
    command->add_option("input", options->input, "A cache or any scan file")->required()->type_name("INPUT");
    add_read_options(*command, options->read);
    command->add_option("--json", options->json_file, "Write it there as well, for machines")
        ->type_name("FILE");
    command->add_flag("--overwrite", options->overwrite, "Replace the JSON file if it exists");
    command->callback([options, &chosen] { chosen = [options] { return info(*options); }; });
}

}  // namespace lucarne::viewer
