#include "viewer/inputs/input.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/files/file.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/open.h"
#include "octree/stream/joined_source.h"
#include "viewer/inputs/kept_cache.h"
#include "viewer/inputs/scan_list.h"
#include "viewer/inputs/units.h"

namespace lucarne::viewer {
namespace {

using octree::GrowingBuild;

constexpr uint64_t kMemoryBeside = uint64_t{1} << 30;  ///< for a build that runs while pictures are drawn
constexpr size_t kMostOpenFiles = 64;  ///< file handles; further files share them and are reopened on use
using Source = std::shared_ptr<const octree::NodeSource>;

/// The scans and the place of their cache, or the cache if it exists.
struct Scans {
    Source cache;
    GrowingBuild::Inputs inputs;
    octree::BuildOptions build;
    std::optional<TemporaryFolder> folder;
};

/// The input files, each opened once.
struct Files {
    std::vector<std::shared_ptr<const ByteSource>> all;
    std::vector<octree::OctreeKind> kinds;
    bool octree = false;  ///< at least one is an octree: each input is opened separately
};

/// Opens the files. Many files share a bounded number of handles.
Result<Files> open_files(const InputOptions& options) {
    const auto handles =
        options.paths.size() > kMostOpenFiles ? std::make_shared<HandlePool>(kMostOpenFiles) : nullptr;
    Files files;
    for (const std::string& path : options.paths) {
        LUCARNE_ASSIGN(std::shared_ptr<const ByteSource> file, InputFile::open_shared(path, handles));
        files.kinds.push_back(octree::octree_kind(*file));
        files.all.push_back(std::move(file));
        if (files.octree || files.kinds.back() == octree::OctreeKind::none) continue;
        files.octree = true;
        if (options.read.metres_per_unit)
            log::warn("{}: is an octree and keeps its unit; --unit is for scans that are converted", path);
        if (options.read.up != io::UpAxis::z)
            log::warn("{}: is an octree and keeps its axes; --up is for scans that are converted", path);
    }
    return files;
}

/// `leave_out`: a scan that is rejected is left out with a warning if there are others.
Result<Scans> open_scans(const InputOptions& options,
                         std::span<const std::shared_ptr<const ByteSource>> files, bool leave_out = false) {
    Scans scans;
    std::vector<io::ScanInfo> infos;
    std::optional<Error> first_error;
    for (const auto& file : files) {
        auto scan = io::open_scan(file, options.read);
        if (!scan && leave_out && files.size() > 1 && scan.error().kind == ErrorKind::input_rejected) {
            log::warn("{}; skipped", scan.error().line());
            first_error = first_error.value_or(scan.error());
            continue;
        }
        if (!scan) return tl::unexpected(io::with_salvage_advice(scan.error(), file->path(), options.read));
        infos.push_back((*scan)->info());
        scans.inputs.push_back(std::move(*scan));
    }
    if (scans.inputs.empty()) return tl::unexpected(std::move(*first_error));
    const KeptCache kept(infos, io::options_text(options.read));
    scans.build.read_options = io::options_text(options.read);
    if (!options.no_cache) {
        scans.cache = kept.find();
        if (scans.cache) return scans;
        if (const auto place = kept.place(kept.bytes_needed())) {
            scans.build.output = *place;
            scans.build.overwrite = true;  // an older cache of the same scans
            log::info("{}: {}; converting, the cache is kept as {}", options.paths[0], infos[0].format,
                      place->string());
        } else {
            log::warn("{}: there is no place to keep its cache; it is converted again the next time",
                      options.paths[0]);
        }
    }
    if (scans.build.output.empty()) {
        LUCARNE_ASSIGN(scans.folder, TemporaryFolder::create());
        scans.build.output = scans.folder->path() / "scan.luc";
    }
    return scans;
}

/// Returns the scans as one cache: the kept one, or a new one.
Result<Source> convert_scans(const InputOptions& options,
                             std::span<const std::shared_ptr<const ByteSource>> files) {
    LUCARNE_ASSIGN(Scans scans, open_scans(options, files));
    if (scans.cache) return scans.cache;
    for (const auto& input : scans.inputs) scans.build.inputs.push_back(input.get());
    if (auto built = octree::build_cache(scans.build); !built)
        return tl::unexpected(io::with_salvage_advice(built.error(), built.error().what, options.read));
    // The open file stays readable after the folder and its name are removed.
    LUCARNE_ASSIGN(auto cache, octree::open_cache(scans.build.output));
    return Source(std::move(cache));
}

/// Opens every input separately, octrees as they are.
Result<Source> open_parts(const InputOptions& options, const Files& files) {
    std::vector<Source> sources;
    for (size_t i = 0; i < files.all.size(); ++i) {
        if (files.kinds[i] != octree::OctreeKind::none) {
            LUCARNE_ASSIGN(auto octree, octree::open_octree(files.all[i]));
            sources.push_back(std::move(octree));
        } else {
            LUCARNE_ASSIGN(sources.emplace_back(),
                           convert_scans({{options.paths[i]}, options.no_cache, options.read},
                                         std::span(&files.all[i], 1)));
        }
    }
    if (sources.size() == 1) return std::move(sources.front());
    return octree::join_sources(std::move(sources));
}

InputOptions with_each_once(InputOptions options) {
    options.paths = once_each(options.paths);
    return options;
}

}  // namespace

Result<OpenInput> open_growing(const InputOptions& given, const Opening& opening) {
    const InputOptions options = with_each_once(given);
    OpenInput open;
    LUCARNE_ASSIGN(const Files files, open_files(options));
    if (files.octree) {
        LUCARNE_ASSIGN(open.source, open_parts(options, files));
        return open;
    }
    LUCARNE_ASSIGN(Scans scans, open_scans(options, files.all, true));
    open.source = scans.cache;
    if (open.source) return open;
    open.folder = std::move(scans.folder);
    if (!open.folder) open.cache = scans.build.output;
    octree::GrowingOptions growing;
    growing.build = std::move(scans.build);
    growing.build.memory = kMemoryBeside;
    growing.sample_points = opening.sample_points;
    growing.first_points = opening.first_points;
    growing.first_read = opening.first_read;
    growing.read_points = opening.read_points;
    growing.patience = opening.patience;
    growing.sampling = opening.sampling;
    // A temporary folder is removed with the program, together with its contents.
    if (opening.resumable && !open.folder) growing.build.resume = octree::Resume::go_on;
    LUCARNE_ASSIGN(open.build, GrowingBuild::open(std::move(scans.inputs), std::move(growing)));
    open.source = open.build->state().source;
    return open;
}

Result<Source> open_input(const InputOptions& given) {
    LUCARNE_ASSIGN(ScanList list, expand_folders(given.paths, given.read));
    if (!list.problems.empty()) return tl::unexpected(std::move(list.problems.front()));
    InputOptions options = given;
    options.paths = std::move(list.files);
    LUCARNE_ASSIGN(const Files files, open_files(options));
    return files.octree ? open_parts(options, files) : convert_scans(options, files.all);
}

Result<Source> open_input(const std::filesystem::path& path) {
    return open_input(InputOptions{{path.string()}, false, {}});
}

std::string inputs_text(const std::vector<std::string>& paths) {
    if (paths.empty()) return {};
    return paths.size() == 1 ? paths.front() : fmt::format("{} and {} more", paths.front(), paths.size() - 1);
}

}  // namespace lucarne::viewer
