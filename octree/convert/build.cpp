#include "octree/convert/build.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <span>
#include <thread>

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/parallel.h"
#include "io/core/progress.h"
#include "octree/cluster/only_rank.h"
#include "octree/colours/colour_survey.h"
#include "octree/convert/build_inputs.h"
#include "octree/convert/chunks/point_stations.h"
#include "octree/convert/identity.h"
#include "octree/convert/nodes/assembler.h"
#include "octree/convert/nodes/build_listener.h"
#include "octree/convert/nodes/in_order.h"
#include "octree/convert/nodes/join_ranks.h"
#include "octree/convert/scans/early_count.h"
#include "octree/convert/scans/scan_stage.h"
#include "octree/convert/takeover.h"
#include "octree/convert/together.h"
#include "octree/holes/hole_survey.h"

namespace lucarne::octree {
namespace {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Runs one stage and records its time. Returns the memory that it freed to the system; otherwise the
/// allocator keeps it in pools of each thread, and the next stage's memory is added to it.
template <class Stage>
auto timed(BuildReport& report, const char* name, const Stage& stage) {
    const auto wall = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    auto result = stage();
    ::malloc_trim(0);
    report.stages.push_back({name,
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
                             cpu_seconds() - cpu});
    return result;
}

/// Returns a stage's outcome: restored from an interrupted build's record, else from `run`, which is then
/// recorded. If one of several ranks has no sound record, all run the stage again.
template <class Restore, class Run>
auto resumable(Workspace& work, Ranks* ranks, const char* stage, const Restore& restore, const Run& run)
    -> decltype(run()) {
    {
        const auto* record = work.finished(stage);
        std::optional<decltype(run())> before;
        if (record) before = restore(*record);
        const bool sound = before && *before;
        if (record && !sound)
            log::warn("the stored result of stage '{}' is damaged; the stage is run again", stage);
        uint64_t all = sound ? 1 : 0;
        if (ranks) LUCARNE_TRY(ranks->sum({&all, 1}));
        if (all == (ranks ? ranks->count() : 1)) return std::move(*before);
        if (ranks && ranks->rank() == 0 && all > 0)
            log::warn("{} of {} ranks have lost what stage '{}' made; all ranks run it again",
                      ranks->count() - all, ranks->count(), stage);
    }
    auto outcome = run();
    if (outcome) LUCARNE_TRY(work.finish(stage, outcome->save()));
    return outcome;
}

/// Reports the progress of a stage to the terminal and the listener.
class Steps {
 public:
    Steps(BuildListener* listener, std::string stage, uint64_t points)
        : listener_(listener),
          stage_(std::move(stage)),
          points_(points),
          progress_(stage_, points, "points") {}

    /// Counts finished points. Error: the build is to stop.
    Result<void> add(uint64_t points) {
        progress_.add(points);
        if (!listener_) return {};
        listener_->advanced(stage_, done_ += points, points_);
        if (listener_->stopped()) return failed("the build", "was stopped");
        return {};
    }

 private:
    BuildListener* listener_;
    std::string stage_;
    uint64_t points_;
    std::atomic<uint64_t> done_{0};
    Progress progress_;
};

Pass with_steps(Pass pass, Steps& steps, uint32_t stride) {
    return [pass = std::move(pass), &steps, stride](const Visit& visit) {
        return pass([&](std::span<const std::byte> records) -> Result<void> {
            LUCARNE_TRY(steps.add(records.size() / stride));
            return visit(records);
        });
    };
}

/// Returns how many points a rank processes in the time in which rank 0 looks for holes and compares colours.
/// Measured with one thread: normals and nodes of 110 000 to 240 000 points take as long, if all are more
/// than 2 million.
uint64_t work_of_first(const BuildOptions& options, uint64_t points, bool normals) {
    if (!normals || !options.fill) return 0;
    constexpr uint64_t kShare = 16, kMost = 1 << 17;
    return std::min(points / kShare, kMost);
}

Result<ChunkStore> fill_chunks(const Workspace& work, const Unifier& inputs, InputRange own,
                               const ScanFacts& facts, const MemoryPlan& memory, const BuildOptions& options,
                               bool stations, uint64_t first_has, std::optional<CountGrid> counted) {
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("points", false));
    ChunkStore store(std::move(file), inputs.schema(), facts.root, stations);
    const ThreadLimit readers(memory.readers);
    uint64_t own_points = 0;
    for (size_t input = own.first; input < own.end; ++input)
        own_points += own.count_in(input, facts.inputs[input].points);
    Steps steps(options.listener, "sorting into chunks", (counted ? 1 : 2) * own_points);
    const Pass points = pass_over_inputs(inputs, own, memory.batch_bytes);
    const Pass pass =
        with_steps(stations ? with_point_stations(points, inputs.schema(), facts.spans,
                                                  {static_cast<uint32_t>(own.first), own.first_point})
                            : points,
                   steps, store.schema().stride);
    if (options.ranks) {
        LUCARNE_TRY(store.fill(pass, facts.points, memory, *options.ranks, work.resumable(),
                               std::move(counted), first_has));
    } else {
        LUCARNE_TRY(store.fill(pass, facts.points, memory, std::move(counted)));
    }
    return store;
}
Result<ChunkStore> kept_chunks(const Workspace& work, const Unifier& inputs, const ScanFacts& facts,
                               bool stations, std::span<const std::byte> record) {
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("points", true));
    return ChunkStore::restore(std::move(file), inputs.schema(), facts.root, stations, record);
}

Result<SurfaceStore> find_surface(const Workspace& work, const ChunkStore& store,
                                  const std::vector<io::ScanInfo>& scans,
                                  const SurfaceStore::Settings& settings) {
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("normals", false));
    return SurfaceStore::estimate(store, scans, std::move(file), settings);
}
Result<SurfaceStore> kept_surface(const Workspace& work, const ChunkStore& store,
                                  std::span<const std::byte> record) {
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("normals", true));
    return SurfaceStore::restore(store, std::move(file), record);
}

/// Reads the inputs once, for bounds and counts. `counted` becomes the counts for the chunks, or stays empty
/// if the headers do not state what is needed to make them.
Result<ScanFacts> scan_and_count(const Unifier& inputs, InputRange own, const MemoryPlan& memory,
                                 const BuildOptions& options, std::optional<CountGrid>& counted) {
    const ThreadLimit readers(memory.readers);
    uint64_t declared = 0;
    for (size_t input = own.first; input < own.end; ++input)
        declared += own.count_in(input, inputs.source(input).info().declared_points);
    Steps steps(options.listener, "reading", declared);
    const auto seen = [&](std::span<const std::byte> records) -> Result<void> {
        if (options.ranks && options.ranks->stopped())
            return failed("the build", "has failed on another rank");
        if (options.listener) options.listener->read(records);
        return steps.add(records.size() / inputs.schema().stride);
    };
    EarlyCount early(inputs, memory.grid_bytes);
    LUCARNE_ASSIGN(auto facts, options.ranks ? scan_together(inputs, own, memory.batch_bytes, *options.ranks,
                                                             0, &early, seen)
                                             : scan_inputs(inputs, memory.batch_bytes, 0, &early, seen));
    counted = early.take(facts);
    if (!options.ranks) return facts;
    uint64_t have = counted ? 1 : 0;
    LUCARNE_TRY(options.ranks->sum({&have, 1}));
    if (have < options.ranks->count()) counted.reset();  // all ranks have the counts, or none
    return facts;
}

/// Builds this process's chunks in parallel and assembles them in order. At most `workers` are in memory.
/// `keep`: a resumed build may need the chunks again, so their space on disk is not freed.
Result<void> build_chunks(ChunkStore& store, const RecordLoader& loader, const NodeLimits& limits,
                          const MemoryPlan& memory, bool keep, Assembler& assembler, Steps& steps,
                          const Ranks* ranks) {
    const auto chunks = store.chunks();
    const ChunkRange own = store.own();
    const auto build = [&](size_t i) { return build_subtree(loader, own.first + i, limits); };
    const auto assemble = [&](size_t i, Subtree&& tree) -> Result<void> {
        const size_t chunk = own.first + i;
        if (ranks && ranks->stopped()) return failed("the build", "has failed on another rank");
        LUCARNE_TRY(steps.add(chunks[chunk].count));
        LUCARNE_TRY(
            assembler.add(std::move(tree), chunk + 1 < chunks.size() ? &chunks[chunk + 1].key : nullptr));
        if (!keep) store.discard(chunk);
        return {};
    };
    return in_order(own.end - own.first, memory.workers, build, assemble);
}

/// Does the same on several ranks: each builds its chunks into scratch files, from which the nodes get into
/// the cache. Returns the CPU time of compression.
Result<double> build_together(ChunkStore& store, const RecordLoader& loader, const NodeLimits& limits,
                              const MemoryPlan& memory, bool keep, const std::filesystem::path& folder,
                              SharedCache& cache, Steps& steps, Ranks& ranks) {
    LUCARNE_ASSIGN(CacheWriter staged, CacheWriter::stage(folder));
    LUCARNE_ASSIGN(Assembler own, Assembler::create(staged, loader, limits, folder));
    const size_t first = store.own().first;
    own.only_a_part(first > 0 ? &store.chunks()[first - 1].key : nullptr);
    LUCARNE_TRY(build_chunks(store, loader, limits, memory, keep, own, steps, &ranks));
    return join_ranks(ranks, {loader, limits, staged, own}, cache.writer ? &*cache.writer : nullptr,
                      *cache.output, folder);
}

/// Builds all chunks into the cache. Returns the CPU time of compression.
Result<double> build_alone(ChunkStore& store, const RecordLoader& loader, const NodeLimits& limits,
                           const MemoryPlan& memory, bool keep, const std::filesystem::path& folder,
                           CacheWriter& cache, Steps& steps, BuildListener* listener) {
    if (listener) listener->building(loader.schema());
    LUCARNE_ASSIGN(Assembler assembler, Assembler::create(cache, loader, limits, folder, listener));
    LUCARNE_TRY(build_chunks(store, loader, limits, memory, keep, assembler, steps, nullptr));
    return assembler.encode_seconds();
}

/// Returns normals and areas of all points, those of an earlier run if they are whole.
Result<SurfaceStore> surface_of(Workspace& work, ChunkStore& store, const std::vector<io::ScanInfo>& scans,
                                const SurfaceStore::Settings& settings) {
    return resumable(
        work, settings.ranks, "normals",
        [&](const auto& record) { return kept_surface(work, store, record); },
        [&] { return find_surface(work, store, scans, settings); });
}

/// Adds to a cache what is computed from its nodes, and writes its directory and `header`.
Result<void> complete(CacheWriter& writer, SourceHeader header, const BuildOptions& options,
                      BuildReport& report) {
    LUCARNE_ASSIGN(header.station_colours,
                   timed(report, "colours", [&] { return survey_colours(writer, header); }));
    if (options.fill) {
        LUCARNE_ASSIGN(const HoleSurvey survey,
                       timed(report, "holes", [&] { return fill_holes(writer, header, options.memory); }));
        header.filling = survey.filling;
        report.filled = survey.filling.points;
        if (survey.station) {
            header.estimated_stations.push_back(*survey.station);
            ++report.estimated_stations;
        }
    }
    return timed(report, "write", [&] { return writer.finish(header); });
}

/// Warns of points without normals where those of the inputs are kept. Errors: no point has one.
Result<void> check_kept_normals(const BuildOptions& options, const ScanFacts& facts) {
    if (facts.without_normal == 0) return {};
    if (facts.without_normal == facts.points)
        return bad_arguments(options.inputs[0]->info().path, "has no normals to keep",
                             "use --normals estimate");
    log::warn("{} of {} points have no normal to keep, and get no light; --normals auto estimates theirs",
              facts.without_normal, facts.points);
    return {};
}

uint64_t points_of(const ChunkStore& store) {
    uint64_t points = 0;
    for (size_t chunk = store.own().first; chunk < store.own().end; ++chunk)
        points += store.chunks()[chunk].count;
    return points;
}

/// What stays until all ranks are done, because any of them may fail.
struct Held {
    std::optional<SharedCache> cache;
    std::optional<Workspace> work;
    std::vector<Workspace> left;  ///< of other numbers of ranks
};

/// Opens the workspace, with what an interrupted build has left, if this one is to go on. A meeting.
Result<void> open_workspace(const BuildOptions& options, const Unifier& inputs, InputRange own,
                            const std::filesystem::path& folder, const MemoryPlan& memory, Held& held) {
    OnlyRank alone;
    Ranks& ranks = options.ranks ? *options.ranks : alone;
    std::string identity;
    if (options.resume != Resume::never) {
        LUCARNE_ASSIGN(identity, build_identity(options, own, ranks));
    }
    LUCARNE_ASSIGN(held.work, Workspace::open(folder, options.output, identity, options.resume,
                                              {ranks.rank(), ranks.count()}));
    const std::string mark = held.work->mark();
    const auto bytes = std::as_bytes(std::span(mark));
    LUCARNE_ASSIGN(const auto marks, share(ranks, {bytes.begin(), bytes.end()}));
    std::vector<std::string> used;
    for (const Ranks::Bytes& of_rank : marks)
        used.emplace_back(reinterpret_cast<const char*>(of_rank.data()), of_rank.size());
    LUCARNE_ASSIGN(held.left, held.work->left_by_others(used));
    uint64_t removed = held.work->removed();
    LUCARNE_TRY(ranks.sum(std::span(&removed, 1)));  // only rank 0 prints
    if (removed > 0)
        log::warn("removed {} that an interrupted conversion left; --resume would have used it",
                  bytes_text(removed));
    return take_over(*held.work, held.left, ranks, inputs, options, memory);
}

std::filesystem::path scratch_folder(const BuildOptions& options) {
    return !options.temp_folder.empty()       ? options.temp_folder
           : options.output.has_parent_path() ? options.output.parent_path()
                                              : std::filesystem::path(".");
}

/// Builds the cache; of several ranks each does its part.
Result<BuildReport> build(const BuildOptions& options, Held& held) {
    LUCARNE_TRY(check_output(options.output, options.overwrite));
    const unsigned threads =
        options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    const ThreadLimit limit(threads);
    const auto folder = scratch_folder(options);
    LUCARNE_ASSIGN(const Unifier inputs,
                   Unifier::create(options.inputs, options.normals == NormalsMode::estimate));
    LUCARNE_TRY(check_units(inputs));
    warn_of_differences(inputs);
    LUCARNE_TRY(check_descriptions(inputs));
    const auto stride_with = [&](std::optional<bool> normals) {
        return (normals ? with_estimates(inputs.schema(), *normals) : inputs.schema()).stride;
    };
    // The most that may have to be estimated; only the scan tells whether every point has its own normal.
    LUCARNE_ASSIGN(const auto most, wanted_normals(options.normals, inputs, false));
    const uint32_t widest = stride_with(most);
    const MemoryPlan::Work need{widest, NodeLimits(widest).leaf, most.has_value(), threads};
    LUCARNE_ASSIGN(const auto memory, MemoryPlan::create(options.memory, need));

    BuildReport report;
    Ranks* const ranks = options.ranks;
    if (ranks) {
        LUCARNE_TRY(check_ranks(*ranks, options));
        LUCARNE_ASSIGN(held.cache, SharedCache::create(*ranks, options, folder));
    }
    InputRange own{0, inputs.inputs()};
    if (ranks) {
        LUCARNE_ASSIGN(own, inputs_of_rank(inputs, *ranks));
    }
    LUCARNE_TRY(open_workspace(options, inputs, own, folder, memory, held));
    Workspace& work = *held.work;
    std::optional<CountGrid> counted;
    LUCARNE_ASSIGN(const auto facts, timed(report, "scan", [&] {
                       return resumable(work, ranks, "scan", ScanFacts::restore, [&] {
                           return scan_and_count(inputs, own, memory, options, counted);
                       });
                   }));
    report.points = facts.points;
    report.dropped = facts.dropped;
    report.inputs = facts.inputs;
    report.estimated_stations = facts.stations.size();
    LUCARNE_ASSIGN(const auto normals, wanted_normals(options.normals, inputs, facts.without_normal == 0));
    if (normals && !*normals) LUCARNE_TRY(check_kept_normals(options, facts));
    const NodeLimits limits(stride_with(normals));
    SourceHeader bare = header_of(inputs, facts, inputs.schema());
    bare.options = options.read_options;
    for (const auto* input : options.inputs) warn_of_assumed_unit(input->info(), bare.metres_per_unit);
    if (options.listener)
        options.listener->scanned(bare,
                                  normals ? with_estimates(inputs.schema(), *normals) : inputs.schema());
    // Only the search for normals uses the stations of points.
    const bool stations = normals && !facts.spans.empty();
    const uint64_t first_has = work_of_first(options, facts.points, normals.has_value());
    LUCARNE_ASSIGN(
        ChunkStore store, timed(report, "chunk", [&] {
            return resumable(
                work, ranks, "chunk",
                [&](const auto& record) { return kept_chunks(work, inputs, facts, stations, record); },
                [&] {
                    return fill_chunks(work, inputs, own, facts, memory, options, stations, first_has,
                                       std::move(counted));
                });
        }));
    std::optional<SurfaceStore> surface;
    if (normals) {
        Steps steps(options.listener, "normals", points_of(store));
        LUCARNE_ASSIGN(
            surface, timed(report, "normals", [&] {
                return surface_of(
                    work, store, bare.scans,
                    {*normals, options.neighbours, options.neighbour_search, threads, options.memory,
                     facts.stations, [&](uint64_t points) { return steps.add(points); }, ranks, folder});
            }));
    }
    const RecordLoader loader(store, surface ? &*surface : nullptr, normals.value_or(false), bare.scans);
    std::optional<CacheWriter> alone;
    if (!ranks) {
        LUCARNE_ASSIGN(alone, CacheWriter::create(options.output, options.overwrite, folder));
    }
    double encoding = 0;
    LUCARNE_TRY(timed(report, "build", [&]() -> Result<void> {
        Steps steps(options.listener, "building", points_of(store));
        if (ranks) {
            LUCARNE_ASSIGN(encoding, build_together(store, loader, limits, memory, work.resumable(), folder,
                                                    *held.cache, steps, *ranks));
        } else {
            LUCARNE_ASSIGN(encoding, build_alone(store, loader, limits, memory, work.resumable(), folder,
                                                 *alone, steps, options.listener));
        }
        return {};
    }));
    report.stages.back().cpu_seconds -= encoding;
    report.stages.push_back({"encode", 0, encoding});
    if (ranks) {
        LUCARNE_TRY(sum_cpu(*ranks, report.stages));
        report.exchanged = ranks->sent();
        LUCARNE_TRY(ranks->sum({&report.exchanged, 1}));
        if (ranks->rank() > 0) return report;  // rank 0 does what is left
    }
    CacheWriter& writer = ranks ? *held.cache->writer : *alone;
    bare.schema = loader.schema();
    LUCARNE_TRY(complete(writer, std::move(bare), options, report));
    report.estimated_normals = normals.value_or(false) ? facts.without_normal : 0;
    report.chunks = store.chunks().size();
    report.nodes = writer.nodes();
    report.bytes = writer.bytes();
    return report;
}

}  // namespace

Result<BuildReport> build_cache(const BuildOptions& options) {
    Held held;
    auto report = build(options, held);
    if (options.ranks)
        LUCARNE_TRY(options.ranks->conclude(report ? Result<void>() : tl::make_unexpected(report.error())));
    if (!report) return report;
    held.work->end();
    if (options.ranks) LUCARNE_TRY(meet(*options.ranks));
    held.work->done();
    return report;
}

bool is_being_built(const BuildOptions& options) {
    return Workspace::in_use(scratch_folder(options), options.output);
}

}  // namespace lucarne::octree
