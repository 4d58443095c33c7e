#include "octree/growing/growing_build.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include <glm/common.hpp>
#include <tbb/task_arena.h>

#include "io/core/guarded.h"
#include "io/core/log.h"
#include "io/core/parallel.h"
#include "octree/cache/cache.h"
#include "octree/colours/colour_survey.h"
#include "octree/convert/build_inputs.h"
#include "octree/convert/chunks/record_loader.h"
#include "octree/convert/nodes/build_listener.h"
#include "octree/growing/pass_sample.h"
#include "octree/growing/quick_surface.h"
#include "octree/growing/sample.h"
#include "octree/growing/tree_top.h"
#include "octree/normals/splat_surface.h"
#include "octree/tree/attributes.h"
#include "octree/tree/edge_line.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/radix_sort.h"
#include "octree/tree/station_ids.h"

namespace lucarne::octree {
namespace {

using Clock = std::chrono::steady_clock;

/// The sample with its surface, in the order in which it was taken.
struct ShownSample {
    QuickSample points;
    std::vector<QuickSurface> surface;
    Cube root;  ///< the areas of `surface` are in its faces

    void move_to(const Cube& other) {
        const auto faces = static_cast<float>(root.size * root.size / (other.size * other.size));
        for (QuickSurface& point : surface)
            if (point.area != kStrayArea) point.area *= faces;
        root = other;
    }
};

constexpr double kFace = 1;  ///< areas are in faces of the root cube

// How the sample grows while the build runs. Its rounds take a few hundredths of the time of a build.
constexpr uint64_t kMostGrown = 1'000'000;       ///< points
constexpr uint64_t kLeastPerPoint = 16;          ///< points in the inputs for each point of the last round
constexpr double kSecondsBetweenRounds = 0.5;    ///< at least
constexpr double kSecondsBetweenPassRounds = 1;  ///< while the build's first pass is kept: both take time
/// Until more of the inputs is read for the sample, if that pass is kept: for most scans it is over sooner.
constexpr double kSecondsOfPass = 2;
constexpr double kGrowth = 1.1;     ///< a sample is shown if it has this many times the points of the last
constexpr uint64_t kManyTimes = 4;  ///< as many points as the sample has are shown in two steps
constexpr uint64_t kMostReadBytes = uint64_t{128} << 20;  ///< of the points kept of the build's first pass

/// Returns every n-th record.
std::vector<std::byte> some_of(std::span<const std::byte> records, size_t stride, size_t n) {
    std::vector<std::byte> some;
    for (size_t at = 0; at < records.size(); at += n * stride) {
        const auto record = records.subspan(at, stride);
        some.insert(some.end(), record.begin(), record.end());
    }
    return some;
}

/// Returns the sample's records as a cache over `root` would hold them, along that root's Morton curve.
LoosePoints along_curve(const ShownSample& sample, const io::Schema& from, const io::Schema& schema,
                        const Cube& root) {
    const size_t count = sample.points.positions.size();
    std::vector<CodeIndex> order(count);
    parallel_ranges(count, 1 << 14, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            order[i] = {root.place(sample.points.positions[i]).code(), static_cast<uint32_t>(i)};
    });
    sort_by_code(order, 3 * kMaxLevel);
    const io::Attribute* normal = schema == from ? nullptr : schema.find(io::names::normal_oct);
    const io::Attribute* area = schema == from ? nullptr : schema.find(io::names::area);
    const io::Attribute* edge = schema == from ? nullptr : schema.find(io::names::edge_line);
    const SplatSurface splats(from);
    LoosePoints points;
    points.records.resize(count * schema.stride);
    points.codes.resize(count);
    points.areas.resize(count);
    parallel_ranges(count, 1 << 14, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const uint32_t index = order[i].index;
            std::byte* record = &points.records[i * schema.stride];
            std::memcpy(record, &sample.points.records[size_t{index} * from.stride], from.stride);
            const QuickSurface& surface = sample.surface[index];
            const float share = splats.area(record, surface.area, root.size * root.size);
            if (normal)
                io::store(record + normal->offset, encode_normal(splats.normal(record, surface.normal)));
            if (area) io::store(record + area->offset, encode_area(share, kFace));
            if (edge) io::store(record + edge->offset, kNoEdge);
            points.codes[i] = order[i].code;
            points.areas[i] = area ? share : 0.0f;
        }
    });
    return points;
}

}  // namespace

struct GrowingBuild::State final : BuildListener {
    Inputs inputs;
    GrowingOptions options;
    std::optional<Unifier> unifier;
    ShownSample sample;
    io::Schema schema;  ///< schema of the sources
    SourceHeader header;
    bool header_is_final = false;  ///< the build has read all points
    std::function<void()> changed;
    std::thread thread;
    std::atomic<bool> stop{false};
    log::Operation operation = log::Operation::current();  ///< the operation that opened the build

    // Used by the build's thread:
    std::shared_ptr<const LoosePoints> loose;
    std::vector<format::Entry> entries;
    std::vector<std::shared_ptr<const LooseNode>> roots;
    Clock::time_point published;
    double publishing = 0;  ///< seconds that the last source took to make

    mutable std::mutex mutex;  ///< guards the members below
    BuildState now;
    const NodeSource* seen = nullptr;  ///< of which a picture has been made; never read
    std::condition_variable sight;     ///< `seen` has changed, or the build is to stop

    std::thread grower;       ///< enlarges the sample until the build shows nodes
    std::mutex making;        ///< guards `header` to `publishing` against the grower
    std::mutex grower_mutex;  ///< with `grower_wakes`: for the pause between two rounds
    std::condition_variable grower_wakes;
    std::atomic<bool> grown{true};      ///< the sample grows no more
    std::optional<PassSample> passing;  ///< of the build's first pass, until it has ended
    std::atomic<bool> passed{true};     ///< that pass has ended, or is not kept

    Result<void> take_first();
    ScanFacts facts_of(const QuickSample& points, const Cube& root) const;
    ShownSample with_surface(QuickSample points, const Cube& root) const;
    void show_sample(const Cube& root);
    void grow();
    bool show_larger(QuickSample points);
    void end_growing();
    void publish(std::shared_ptr<const ByteSource> file);
    void show(std::shared_ptr<const NodeSource> source);
    void work();
    void end(Result<std::shared_ptr<const NodeSource>> cache);
    Result<std::shared_ptr<const NodeSource>> build();

    std::vector<std::byte> take_passing();
    void replace_sample(std::vector<std::byte> records);
    void wait_for_picture();

    void read(std::span<const std::byte> records) override;
    void scanned(const SourceHeader& facts, const io::Schema& records) override;
    void building(const io::Schema& records) override;
    void settled(std::span<const format::Entry> nodes) override;
    void pending(const Pending& node, std::span<const std::byte> shown, const CacheWriter& writer) override;
    void advanced(std::string_view stage, uint64_t points, uint64_t total) override;
    bool stopped() const override { return stop; }
};

Result<void> GrowingBuild::State::take_first() {
    std::vector<const io::PointSource*> sources;
    for (const auto& input : inputs) sources.push_back(input.get());
    options.build.inputs = sources;
    LUCARNE_ASSIGN(unifier,
                   Unifier::create(std::move(sources), options.build.normals == NormalsMode::estimate));
    LUCARNE_TRY(check_units(*unifier));
    LUCARNE_TRY(wanted_normals(options.build.normals, *unifier, true));  // fails before anything is read
    const bool sketch = options.first_points > 0 && options.first_points < options.sample_points;
    auto taken = sketch ? take_sketch(*unifier, options.first_points, options.first_read, options.sampling)
                        : take_sample(*unifier, options.sample_points, options.sampling);
    LUCARNE_ASSIGN(QuickSample points, std::move(taken));
    grown = !sketch;
    const bool complete =
        PointNormals(unifier->schema()).missing(points.records, unifier->schema().stride) == 0;
    LUCARNE_ASSIGN(const auto normals, wanted_normals(options.build.normals, *unifier, complete));
    schema = normals ? with_estimates(unifier->schema(), *normals) : unifier->schema();
    LUCARNE_ASSIGN(const Cube root, root_cube(points.min, points.max));
    header = header_of(*unifier, facts_of(points, root), schema);
    sample = with_surface(std::move(points), root);
    show_sample(root);
    if (options.read_points > 0) {
        const uint32_t stride = unifier->schema().stride;
        passing.emplace(stride, std::min(options.read_points, kMostReadBytes / stride),
                        unifier->declared_points());
        passed = false;
    }
    return {};
}

ScanFacts GrowingBuild::State::facts_of(const QuickSample& points, const Cube& root) const {
    return {.points = points.points, .min = points.min, .max = points.max, .root = root};
}

/// Publishes the sample. Its points that no camera saw, and the gains of its stations, are found as those of
/// the cache will be.
void GrowingBuild::State::show_sample(const Cube& root) {
    header.has_gaps = sample.points.has_gaps;
    LoosePoints points = along_curve(sample, unifier->schema(), schema, root);
    ColourSurvey survey(header);
    if (survey.has_colours()) {
        NodeData all{static_cast<uint32_t>(points.codes.size()), std::move(points.records)};
        survey.add(root, all);
        points.records = std::move(all.records);
        header.station_colours = survey.result();
    }
    loose = std::make_shared<const LoosePoints>(std::move(points));
    publish(nullptr);
}

/// Called by the grower as well, which must not read `header` or `schema` here.
ShownSample GrowingBuild::State::with_surface(QuickSample points, const Cube& root) const {
    const auto scans = header_of(*unifier, facts_of(points, root), unifier->schema()).scans;
    const StationIds ids(scans, unifier->schema());
    std::vector<std::optional<glm::dvec3>> stations(points.positions.size());
    parallel_ranges(stations.size(), 1 << 14, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            if (const int32_t id = ids.of(&points.records[i * unifier->schema().stride]); id >= 0)
                stations[i] = ids.stations()[static_cast<size_t>(id)];
    });
    auto surface = quick_surface(points.positions, root, stations);
    return {std::move(points), std::move(surface), root};
}

/// Replaces the sample by larger ones, until the build shows nodes of its own: of longer fronts of the parts,
/// and of what the build has read of the inputs so far.
void GrowingBuild::State::grow() {
    const log::Operation::Scope scope(operation);
    tbb::task_arena arena(tbb::task_arena::automatic, 1, tbb::task_arena::priority::low);
    const uint64_t most =
        std::max(options.sample_points, std::min(kMostGrown, sample.points.points / kLeastPerPoint));
    uint64_t points = options.first_points, read = options.first_read;
    QuickSample fronts = sample.points;
    const auto seconds = [start = Clock::now()] {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    while (!grown && (points < most || !passed)) {
        {
            // What has been read grows with time: an earlier round would find too little to be shown.
            const double pause = passed ? kSecondsBetweenRounds
                                        : std::max(kSecondsBetweenPassRounds, (kGrowth - 1) * seconds());
            std::unique_lock lock(grower_mutex);
            grower_wakes.wait_for(lock, std::chrono::duration<double>(pause), [&] { return grown.load(); });
        }
        if (grown) return;
        if ((passed || seconds() > kSecondsOfPass) && points < most) {
            points = std::min(2 * points, most);
            read *= 2;
            auto taken = arena.execute([&] {
                return take_sketch(*unifier, points, read, [&](uint64_t, uint64_t) { return !grown; });
            });
            if (!taken) return;  // the build will report the error
            if (taken->positions.size() > fronts.positions.size()) fronts = std::move(*taken);
        }
        auto joined = passed ? fronts : join(*unifier, fronts, passing->some(most));
        if (!joined || !arena.execute([&] { return show_larger(std::move(*joined)); })) return;
    }
}

/// Shows these points instead of the sample if they are more. Returns false if the sample grows no more.
bool GrowingBuild::State::show_larger(QuickSample points) {
    if (static_cast<double>(points.positions.size()) <
        kGrowth * static_cast<double>(sample.points.positions.size()))
        return true;
    points.min = glm::min(points.min, sample.points.min);
    points.max = glm::max(points.max, sample.points.max);
    const auto root = root_cube(points.min, points.max);
    if (!root) return false;
    ShownSample larger = with_surface(std::move(points), *root);
    const std::lock_guard lock(making);
    if (grown) return false;
    if (header_is_final)
        larger.move_to(header.root);
    else
        header = header_of(*unifier, facts_of(larger.points, *root), schema);
    sample = std::move(larger);
    show_sample(header.root);
    return true;
}

/// Lets the sample grow no more. Waits for a round that is being made.
void GrowingBuild::State::end_growing() {
    {
        const std::lock_guard lock(grower_mutex);
        grown = true;
    }
    grower_wakes.notify_all();
    if (grower.joinable()) grower.join();
}

/// Makes a source of the current state.
void GrowingBuild::State::publish(std::shared_ptr<const ByteSource> file) {
    const auto start = Clock::now();
    show(make_growing_source({header, entries, roots, loose, std::move(file)}));
    published = Clock::now();
    publishing = std::chrono::duration<double>(published - start).count();
}

void GrowingBuild::State::show(std::shared_ptr<const NodeSource> source) {
    {
        const std::lock_guard lock(mutex);
        now.source = std::move(source);
    }
    if (changed) changed();
}

void GrowingBuild::State::read(std::span<const std::byte> records) {
    if (passing) passing->add(records);
}

void GrowingBuild::State::scanned(const SourceHeader& facts, const io::Schema& records) {
    std::vector<std::byte> kept = take_passing();
    if (!kept.empty()) end_growing();
    {
        const std::lock_guard lock(making);
        header = facts;
        header.schema = schema = records;  // a few points without a normal may not be in the sample
        header_is_final = true;
        if (kept.empty()) {
            sample.move_to(header.root);
            return show_sample(header.root);
        }
    }
    // The surface of all points takes seconds, that of some tenths of a second.
    const size_t stride = unifier->schema().stride, count = kept.size() / stride;
    if (count >= kManyTimes * options.sample_points)
        replace_sample(some_of(kept, stride, count / options.sample_points));
    replace_sample(std::move(kept));
    sample = {};  // it is not needed again
}

/// Returns the points that were kept of the first pass, if they are more than those of the sample.
std::vector<std::byte> GrowingBuild::State::take_passing() {
    if (!passing) return {};
    passed = true;
    std::vector<std::byte> records = passing->take();
    const std::lock_guard lock(making);
    if (records.size() <= sample.points.records.size()) return {};
    return records;
}

/// Shows these records of all points' box instead of the sample, which grows no more.
void GrowingBuild::State::replace_sample(std::vector<std::byte> records) {
    QuickSample points;
    points.records = std::move(records);
    points.points = header.points;
    auto taken = with_positions(*unifier, std::move(points));
    if (!taken) return;
    sample = with_surface(std::move(*taken), header.root);
    show_sample(header.root);
    wait_for_picture();
}

/// Leaves the processors to a picture of the newest source.
void GrowingBuild::State::wait_for_picture() {
    std::unique_lock lock(mutex);
    sight.wait_for(lock, std::chrono::duration<double>(options.patience),
                   [&] { return stop || seen == now.source.get(); });
}

void GrowingBuild::State::building(const io::Schema& records) {
    if (records != schema) throw std::logic_error("the build's records differ from the sample's");
    end_growing();
}

void GrowingBuild::State::settled(std::span<const format::Entry> nodes) {
    entries.insert(entries.end(), nodes.begin(), nodes.end());
}

void GrowingBuild::State::pending(const Pending& node, std::span<const std::byte> shown,
                                  const CacheWriter& writer) {
    if (node.key.level > kMaxLevel)
        // It is a part of one cell, which the sample shows until the cell is whole.
        return;
    const io::Attribute* area = schema == unifier->schema() ? nullptr : schema.find(io::names::area);
    auto root = std::make_shared<LooseNode>();
    root->node = node;
    root->points.records.assign(shown.begin(), shown.end());
    for (size_t at = 0; at < shown.size(); at += schema.stride) {
        const std::byte* record = &shown[at];
        root->points.codes.push_back(header.root.place(io::position_of(schema, record)).code());
        const auto code = area ? io::load<uint16_t>(record + area->offset) : kNoArea;
        root->points.areas.push_back(static_cast<float>(decode_area(code, kFace)));
    }
    while (!roots.empty() && roots.back()->node.key.level > node.key.level &&
           roots.back()->node.key.parent() == node.key)
        roots.pop_back();
    roots.push_back(std::move(root));
    const double since = std::chrono::duration<double>(Clock::now() - published).count();
    if (since < std::max(options.seconds_between, publishing / options.share_of_time)) return;
    auto file = writer.reader();
    if (file) publish(std::make_shared<const InputFile>(std::move(*file)));
}

void GrowingBuild::State::advanced(std::string_view stage, uint64_t points, uint64_t total) {
    const std::lock_guard lock(mutex);
    now.progress = {std::string(stage),
                    total ? std::min(1.0, static_cast<double>(points) / static_cast<double>(total)) : 0.0};
}

Result<std::shared_ptr<const NodeSource>> GrowingBuild::State::build() {
    options.build.listener = this;
    // Frames are drawn meanwhile and have priority.
    tbb::task_arena arena(tbb::task_arena::automatic, 1, tbb::task_arena::priority::low);
    LUCARNE_TRY(arena.execute([&] { return build_cache(options.build); }));
    LUCARNE_ASSIGN(auto cache, open_cache(options.build.output));
    return std::shared_ptr<const NodeSource>(std::move(cache));
}

void GrowingBuild::State::work() {
    const log::Operation::Scope scope(operation);
    auto cache = guarded("the build", [&] { return build(); });
    end_growing();
    entries = {};
    roots.clear();
    end(std::move(cache));
}

void GrowingBuild::State::end(Result<std::shared_ptr<const NodeSource>> cache) {
    {
        const std::lock_guard lock(mutex);
        now.progress = {};
        now.finished = cache.has_value();
        now.stopped = stop && !cache;
        if (cache)
            now.source = std::move(*cache);
        else
            now.error = tl::make_unexpected(std::move(cache).error());
    }
    if (changed) changed();
}

GrowingBuild::GrowingBuild() : state_(std::make_unique<State>()) {}

Result<std::unique_ptr<GrowingBuild>> GrowingBuild::open(Inputs inputs, GrowingOptions options) {
    std::unique_ptr<GrowingBuild> build(new GrowingBuild);
    build->state_->inputs = std::move(inputs);
    build->state_->options = std::move(options);
    LUCARNE_TRY(build->state_->take_first());
    return build;
}

GrowingBuild::~GrowingBuild() {
    stop();
    wait();
}

void GrowingBuild::stop() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stop = true;
        state_->grown = true;
    }
    state_->sight.notify_all();
}

void GrowingBuild::seen(const NodeSource* source) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->seen = source;
    }
    state_->sight.notify_all();
}

void GrowingBuild::begin(std::function<void()> changed) {
    state_->changed = std::move(changed);
    State* state = state_.get();
    if (!state->grown) {
        // If it cannot start, the sample stays as it is.
        [[maybe_unused]] const auto grows = guarded("the sample", [&] {
            state->grower = std::thread(
                [state] { [[maybe_unused]] const auto end = guarded("the sample", [&] { state->grow(); }); });
        });
    }
    auto started = guarded("the build", [&] { state->thread = std::thread([state] { state->work(); }); });
    if (started) return;
    state->end_growing();
    state->end(tl::make_unexpected(std::move(started).error()));
}

void GrowingBuild::wait() {
    if (state_->thread.joinable()) state_->thread.join();
}

BuildState GrowingBuild::state() const {
    const std::lock_guard lock(state_->mutex);
    return state_->now;
}

bool GrowingBuild::is_built_elsewhere() const {
    return is_being_built(state_->options.build);
}

}  // namespace lucarne::octree
