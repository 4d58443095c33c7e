#include "viewer/commands/convert.h"

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/log_silence.h"
#include "io/core/options.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/formats/common/divisible.h"
#include "io/formats/scan.h"
#include "octree/convert/build.h"
#include "octree/edit/edit.h"
#include "octree/normals/normals.h"
#include "viewer/commands/build_memory.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/edit_report.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/inputs/describe.h"
#include "viewer/inputs/input.h"
#include "viewer/inputs/scan_list.h"
#include "viewer/inputs/shared_headers.h"

namespace lucarne::viewer {
namespace {

struct ConvertOptions {
    octree::BuildOptions build;
    std::vector<std::string> inputs;
    io::ReadOptions read;
    std::string memory = "2G", json;
    bool append = false;
};

/// A scan whose file is open only while it is read, so that thousands of inputs do not need thousands of file
/// handles.
class ClosedScan final : public io::PointSource, public io::DivisibleSource {
 public:
    ClosedScan(std::string path, io::ReadOptions options, ScanHeader header)
        : path_(std::move(path)),
          options_(std::move(options)),
          schema_(std::move(header.schema)),
          info_(std::move(header.info)) {
        options_.quiet = true;
    }
    const io::Schema& schema() const override { return schema_; }
    const io::ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        return opened([](const io::PointSource& scan) { return scan.open(); });
    }
    Result<uint64_t> cut(uint64_t point) const override {
        LUCARNE_ASSIGN(const auto scan, reopened());
        const auto* divisible = dynamic_cast<const io::DivisibleSource*>(scan.get());
        return divisible ? divisible->cut(point) : uint64_t{0};
    }
    Result<std::unique_ptr<io::PointReader>> open_part(uint64_t first, uint64_t end) const override {
        using Opened = Result<std::unique_ptr<io::PointReader>>;
        return opened([&](const io::PointSource& scan) -> Opened {
            const auto* divisible = dynamic_cast<const io::DivisibleSource*>(&scan);
            if (!divisible) return rejected(path_, "changed while it was read");
            return divisible->open_part(first, end);
        });
    }

 private:
    Result<std::unique_ptr<io::PointSource>> reopened() const {
        const log::Hush said_before;  // by the rank that read the header
        return io::open_scan(path_, options_);
    }
    /// Opens the file and starts a pass over it.
    template <class Start>
    Result<std::unique_ptr<io::PointReader>> opened(const Start& start) const {
        LUCARNE_ASSIGN(auto scan, reopened());
        if (scan->schema() != schema_) return rejected(path_, "changed while it was read");
        LUCARNE_ASSIGN(auto reader, start(*scan));
        return std::make_unique<Reader>(std::move(scan), std::move(reader));
    }
    class Reader final : public io::PointReader {
     public:
        Reader(std::unique_ptr<io::PointSource> scan, std::unique_ptr<io::PointReader> reader)
            : scan_(std::move(scan)), reader_(std::move(reader)) {}
        Result<size_t> read(io::PointBatch& batch, size_t most) override {
            return reader_->read(batch, most);
        }
        uint64_t dropped() const override { return reader_->dropped(); }
        io::Losses losses() const override { return reader_->losses(); }

     private:
        std::unique_ptr<io::PointSource> scan_;
        std::unique_ptr<io::PointReader> reader_;
    };
    std::string path_;
    io::ReadOptions options_;
    io::Schema schema_;
    io::ScanInfo info_;
};

/// The contents of each input, the losses of all inputs, and the inputs without points.
struct Summary {
    nlohmann::ordered_json inputs = nlohmann::ordered_json::array();
    io::Losses losses;
    std::vector<std::string> empty;

    Summary(std::span<const io::PointSource* const> scans, std::span<const io::Contents> contents) {
        for (size_t i = 0; i < std::min(scans.size(), contents.size()); ++i) {
            inputs.push_back(scan_json(scans[i]->info(), scans[i]->schema(), &contents[i]));
            io::add_losses(losses, contents[i].losses);
            if (contents[i].points == 0) empty.push_back(scans[i]->info().path);
        }
    }
    std::string text() const {
        std::string all = losses.empty() ? "" : "; left out: " + losses_text(losses);
        if (!empty.empty()) all += fmt::format("; without points: {}", some_of(empty));
        return all;
    }
};

Result<void> write_report(const std::string& path, bool overwrite, const octree::BuildReport& report,
                          const Summary& summary, const SetAside& aside) {
    nlohmann::json stages = nlohmann::json::array();
    for (const auto& stage : report.stages)
        stages.push_back(
            {{"name", stage.name}, {"wall_seconds", stage.wall_seconds}, {"cpu_seconds", stage.cpu_seconds}});
    const nlohmann::json root{{"points", report.points},
                              {"dropped", report.dropped},
                              {"nodes", report.nodes},
                              {"chunks", report.chunks},
                              {"bytes", report.bytes},
                              {"filled", report.filled},
                              {"exchanged_bytes", report.exchanged},
                              {"estimated_normals", report.estimated_normals},
                              {"estimated_stations", report.estimated_stations},
                              {"stages", std::move(stages)},
                              {"left_out", losses_json(summary.losses)},
                              {"inputs", summary.inputs},
                              {"rejected", aside.json()}};
    return write_file(path, json_text(root), overwrite);
}

using Scans = std::vector<std::unique_ptr<io::PointSource>>;

/// Opens the inputs. Removes inputs that cannot be opened from the list and notes them in `aside`.
Result<Scans> open_scans(ConvertOptions& options, SetAside& aside) {
    const std::vector<std::string> paths = options.inputs;
    std::vector<Result<ScanHeader>> headers;
    if (options.build.ranks) {
        LUCARNE_ASSIGN(headers, read_headers_together(paths, options.read, *options.build.ranks));
    } else {
        headers = read_headers(paths, options.read);
    }
    Scans scans;
    for (size_t i = 0; i < paths.size(); ++i) {
        if (headers[i])
            scans.push_back(std::make_unique<ClosedScan>(paths[i], options.read, *std::move(headers[i])));
        else
            LUCARNE_TRY(aside.take(std::move(headers[i]).error(), options.inputs));
    }
    if (scans.empty()) return rejected("convert", "none of the inputs can be read");
    return scans;
}

/// Builds from the inputs that open. If an input proves to be broken during the first stage, which reads all
/// inputs, builds again without it.
template <class Build>
auto build_of_the_sound(ConvertOptions& options, SetAside& aside, Scans& scans, const Build& build)
    -> decltype(build()) {
    for (;;) {
        LUCARNE_ASSIGN(scans, open_scans(options, aside));
        options.build.inputs.clear();
        for (const auto& scan : scans) options.build.inputs.push_back(scan.get());
        auto done = build();
        if (done) return done;
        LUCARNE_TRY(aside.take(std::move(done).error(), options.inputs));
    }
}

Result<void> append(ConvertOptions options, SetAside& aside) {
    const auto& build = options.build;
    const octree::EditOptions edit{build.output,     build.memory,           build.threads, build.temp_folder,
                                   build.neighbours, build.neighbour_search, build.ranks};
    Scans scans;
    LUCARNE_ASSIGN(auto report, build_of_the_sound(options, aside, scans, [&] {
                       return octree::append_to_cache(build.inputs, edit);
                   }));
    log::info("{}: {} added, {} in all; {} were rewritten, {} of {} nodes stayed{}", build.output.string(),
              counted(report.added, "points"), report.points, report.rewritten_points, report.kept_nodes,
              report.nodes, Summary(report.appended, report.inputs).text());
    if (build.ranks && build.ranks->rank() > 0) return aside.result(build.output.string());
    compact_after_update(edit, report);
    if (!options.json.empty()) LUCARNE_TRY(write_edit_report(options.json, build.overwrite, report));
    return aside.result(build.output.string());
}

Result<void> convert(ConvertOptions options) {
    auto& build = options.build;
    if (build.ranks && build.ranks->count() == 1) build.ranks = nullptr;
    LUCARNE_ASSIGN(build.memory, build_memory(options.memory));
    const std::string output = build.output.string();
    if (names_scan(output))
        return bad_arguments(output, "has the name of a scan",
                             "a cache is named .luc; lucarne export writes scans");
    if (const auto extension = std::filesystem::path(output).extension();
        !options.append && !extension.empty() && extension != ".luc")
        return bad_arguments(output, fmt::format("cannot write '{}'", extension.string()),
                             "name the cache .luc");
    LUCARNE_ASSIGN(const ScanList list, expand_folders(options.inputs, options.read));
    options.inputs = list.files;
    LUCARNE_TRY(check_outputs({options.append ? "" : output, options.json}, build.overwrite, options.inputs));
    SetAside aside(list, options.read);
    build.read_options = io::options_text(options.read);
    if (options.append) return append(std::move(options), aside);
    Scans scans;
    LUCARNE_ASSIGN(const auto report,
                   build_of_the_sound(options, aside, scans, [&] { return octree::build_cache(build); }));
    double cpu = 0, wall = 0;
    for (const auto& stage : report.stages) {
        log::info("{:<8}{:8.2f} s, {:8.2f} CPU-s", stage.name, stage.wall_seconds, stage.cpu_seconds);
        cpu += stage.cpu_seconds;
        wall += stage.wall_seconds;
    }
    if (report.filled > 0)
        log::info("{} fill holes of the scan; they are drawn, but never exported",
                  counted(report.filled, "synthetic surfels"));
    if (report.estimated_stations > 0)
        log::info("{} estimated from the points", counted(report.estimated_stations, "stations"));
    if (report.estimated_normals > 0)
        log::info("normals of {} were estimated", counted(report.estimated_normals, "points"));
    const Summary summary(build.inputs, report.inputs);
    log::info("{}: {} in {}, {}, in {:.2f} s ({:.2f} CPU-s){}", build.output.string(),
              counted(report.points, "points"), counted(report.nodes, "nodes"), bytes_text(report.bytes),
              wall, cpu, summary.text());
    if (build.ranks)
        log::info("{} ranks exchanged {}, {:.1f} bytes a point", build.ranks->count(),
                  bytes_text(report.exchanged),
                  static_cast<double>(report.exchanged) /
                      static_cast<double>(std::max<uint64_t>(1, report.points)));
    if (!options.json.empty() && (!build.ranks || build.ranks->rank() == 0))
        LUCARNE_TRY(write_report(options.json, build.overwrite, report, summary, aside));
    return aside.result(build.output.string());
}

}  // namespace

void add_convert(CommandLine& line) {
    add_convert_of(line, nullptr);
}

void add_convert_of(CommandLine& line, octree::Ranks* ranks) {
    using octree::NeighbourSearch;
    using octree::NormalsMode;
    auto options = std::make_shared<ConvertOptions>();
    options->build.resume = octree::Resume::later;
    options->build.ranks = ranks;
    Arguments command = line.add("convert", "Build an octree cache from scans");
    command
        .add("inputs", options->inputs,
             "Scan files, or folders of them; several become one cache. Broken files among several are "
             "skipped")
        .required()
        .type_name("INPUT");
    add_read_options(command, options->read);
    command.add("-o,--output", options->build.output, "The cache to write").required().type_name("CACHE.luc");
    command
        .choice<NormalsMode>(
            "--normals", options->build.normals,
            {{"auto", NormalsMode::automatic},
             {"keep", NormalsMode::keep},
             {"estimate", NormalsMode::estimate},
             {"none", NormalsMode::none}},
            "auto: keep the inputs' normals, and estimate those of points that have none (or zero, or NaN); "
            "keep: require normals in all inputs; "
            "estimate: estimate all normals and keep the inputs' as normal_in_file; none: no normals")
        .show_default("auto");
    command
        .add("--memory", options->memory,
             "Cap on the memory of the process, whatever the size of the input (at least 48M)")
        .show_default()
        .type_name("BYTES");
    command.add("--threads", options->build.threads, "Number of threads; 0: all cores")
        .show_default()
        .type_name("N");
    command.add("--temp", options->build.temp_folder, "Folder for temporary files (default: the cache's)")
        .type_name("DIR");
    command
        .add("--neighbours", options->build.neighbours,
             "Number of nearest points that a normal is estimated from")
        .show_default()
        .range(3u, octree::kMostNormalNeighbours)
        .type_name("K");
    command
        .choice<NeighbourSearch>("--neighbours-search", options->build.neighbour_search,
                                 {{"leaf", NeighbourSearch::leaf}, {"flann", NeighbourSearch::flann}},
                                 "How neighbours are found: leaf is fast; flann is PCL's default kd-tree, "
                                 "for comparison")
        .show_default("leaf");
    command.flag(
        "--no-fill", [options] { options->build.fill = false; },
        "Do not fill the holes of the scan (below tripods, behind furniture) with synthetic surfels");
    command.flag(
        "--resume", [options] { options->build.resume = octree::Resume::go_on; },
        "Continue after the last finished stage of an interrupted conversion; if this one fails, "
        "keep its "
        "stages");
    command.flag("--overwrite", options->build.overwrite, "Replace the outputs if they exist");
    Argument append_flag =
        command.flag("--append", options->append,
                     "Add the inputs to an existing cache, in place; its unit and its kind of normals "
                     "stay. Files that it contains already are skipped");
    for (const char* other : {"--resume", "--overwrite", "--normals"})
        append_flag.excludes(command.find(other));
    command.add("--json", options->json, "Write what was done and how long it took").type_name("FILE");
    command.run([options] { return convert(*options); });
}

}  // namespace lucarne::viewer
