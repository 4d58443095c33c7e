#include "viewer/scans/scan_set.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "io/core/log.h"
#include "octree/open.h"
#include "octree/stream/joined_source.h"
#include "viewer/inputs/scan_list.h"

namespace lucarne::viewer {
namespace {

using Source = std::shared_ptr<const octree::NodeSource>;

constexpr uint64_t kSamplePoints = 400'000;  ///< for all scans that are opened at once
constexpr uint64_t kFirstPoints = 60'000;    ///< of these, for the first picture
/// Points that are read for it where files cannot seek, for each core: some .2 s of decoding LAZ.
constexpr uint64_t kFirstReadPerCore = 250'000;
constexpr uint64_t kReadPoints = 4'000'000;      ///< shown of the scan that is being converted
constexpr double kPatience = 2;                  ///< s for which the conversion waits for pictures of these
constexpr uint64_t kLeastSamplePoints = 20'000;  ///< for one scan
/// Each scan keeps one or two files open, and a process may have 1024.
constexpr size_t kMostScans = 400;
constexpr std::chrono::seconds kBetweenLooks(1);  ///< for caches that other programs have finished
constexpr auto kNoTime = std::filesystem::file_time_type::min();  ///< of a file that is not there

/// Returns how many points all cores read for the first picture: 500 000 to 4 million.
uint64_t first_read() {
    return kFirstReadPerCore * std::clamp(std::thread::hardware_concurrency(), 2u, 16u);
}

/// State shared between the window and the thread that opens a scan.
struct Watch {
    std::atomic<bool> cancelled{false};
    std::atomic<double> share{0};
};

std::filesystem::file_time_type time_of(const std::filesystem::path& file) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    return error ? kNoTime : time;
}

bool is_folder(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

/// Returns the paths that become rows of their own: the files of folders, and folders with a problem, whose
/// row shows it.
Result<std::vector<std::string>> expanded(const InputOptions& how, bool together) {
    LUCARNE_ASSIGN(ScanList list, expand_folders(how.paths, how.read));
    if (list.files.size() > kMostScans)
        return rejected(
            how.paths.front(),
            fmt::format("contains {} scans, but at most {} can be open", list.files.size(), kMostScans),
            "convert them into one cache first: lucarne convert FOLDER -o ALL.luc");
    if (!together)
        for (const Error& problem : list.problems)
            if (std::ranges::find(how.paths, problem.what) == how.paths.end())
                list.files.push_back(problem.what);
    return list.files;
}

}  // namespace

std::string ScanRow::name() const {
    if (paths.empty()) return {};
    const std::filesystem::path first(paths.front());
    std::string name = first.filename().string();
    if (name.empty()) name = paths.front();
    if (paths.size() == 1) return name;
    const std::filesystem::path whole = std::filesystem::path(folder).lexically_normal();
    const std::string named = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
    if (!named.empty() && named != "." && named != "..")
        return fmt::format("{} ({} scans)", named, paths.size());
    return fmt::format("{} and {} more", name, paths.size() - 1);
}

std::string scans_title(const std::vector<ScanRow>& rows) {
    std::string title;
    size_t open = 0;
    for (const ScanRow& row : rows)
        if (row.state != ScanState::failed && ++open == 1) title = row.name();
    if (open == 0) return "No scan open";
    if (open > 1) title += fmt::format(" and {} more", open - 1);
    for (const ScanRow& row : rows)
        if (row.state == ScanState::converting)
            title += fmt::format(" - {} {:.0f} %", row.stage, 100 * row.share);
    return title;
}

/// The internal state of a row.
struct ScanSet::Item {
    std::shared_ptr<Watch> watch = std::make_shared<Watch>();
    log::Operation operation;  ///< collects the warnings of opening and conversion
    OpenInput input;
    Source source;                                         ///< the newest source
    bool going = false;                                    ///< the build has been started
    std::filesystem::file_time_type cache_time = kNoTime;  ///< of the cache's file when the scan was opened
};

/// The opened files of a row, or the paths to open instead.
struct Opened {
    OpenInput input;
    std::vector<std::string> instead;
    bool together = false;  ///< the paths in `instead` become one row
};

struct ScanSet::Joined {
    Source source;
    Result<StartingView> start;
    std::vector<uint64_t> ids;  ///< of the scans in the source
    bool grows = false;         ///< more points of them are to come
};

/// Results of the threads.
struct ScanSet::Shared {
    std::mutex mutex;
    std::vector<std::pair<uint64_t, Result<Opened>>> opened;  ///< by the rows' ids
    std::optional<Result<Joined>> joined;
    std::function<void()> changed;

    void report(uint64_t id, Result<Opened> one) {
        {
            const std::lock_guard lock(mutex);
            opened.emplace_back(id, std::move(one));
        }
        changed();
    }
};

namespace {

Result<Opened> open_paths(const InputOptions& how, bool together, Watch& watch, uint64_t sample_points) {
    if (watch.cancelled) return failed("opening", "was stopped");
    if (std::ranges::any_of(how.paths, is_folder)) {
        LUCARNE_ASSIGN(auto files, expanded(how, together));
        return Opened{{}, std::move(files), together};
    }
    if (how.paths.size() > 1 &&
        std::ranges::any_of(how.paths, [](const auto& p) { return octree::is_octree(p); }))
        return Opened{{}, how.paths, false};
    Opening opening;
    opening.resumable = true;
    opening.sample_points = sample_points;
    opening.first_points = sample_points * kFirstPoints / kSamplePoints;
    opening.first_read = sample_points * first_read() / kSamplePoints;
    opening.read_points = kReadPoints;
    opening.patience = kPatience;
    opening.sampling = [&watch](uint64_t done, uint64_t total) {
        watch.share = total ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total)) : 0.0;
        return !watch.cancelled;
    };
    LUCARNE_ASSIGN(OpenInput input, open_growing(how, opening));
    return Opened{std::move(input), {}, false};
}

}  // namespace

/// Opens a row on the opening thread.
void ScanSet::push_opening(uint64_t id, InputOptions how, bool together, uint64_t sample_points) {
    std::string name = how.paths.front();
    opener_.push(
        std::move(name),
        [watch = items_[id].watch, operation = items_[id].operation, how = std::move(how), together,
         sample_points] {
            const log::Operation::Scope scope(operation);
            return open_paths(how, together, *watch, sample_points);
        },
        [shared = shared_, id](Result<Opened> opened) { shared->report(id, std::move(opened)); });
}

ScanSet::ScanSet(InputOptions how, StartOf start, std::function<void()> changed)
    : how_(std::move(how)), start_of_(std::move(start)), shared_(std::make_shared<Shared>()) {
    how_.paths.clear();
    shared_->changed = std::move(changed);
}

ScanSet::~ScanSet() {
    for (auto& [id, item] : items_) {
        item.watch->cancelled = true;
        if (item.input.build) item.input.build->stop();
    }
}

void ScanSet::open(std::vector<std::string> paths, bool together) {
    if (together) return open_one(std::move(paths), true);
    for (std::string& path : paths) open_one({std::move(path)}, false);
}

void ScanSet::open_one(std::vector<std::string> paths, bool together, uint64_t instead_of,
                       std::string folder) {
    if (paths.empty()) return;
    const uint64_t id = next_id_++;
    ScanRow row;
    row.id = id;
    row.stage = "opening";
    row.paths = paths;
    row.folder = std::move(folder);
    const auto place = std::ranges::find(rows_, instead_of, &ScanRow::id);
    const bool full = rows_.size() >= kMostScans;
    if (full) {
        row.state = ScanState::failed;
        row.error =
            Error{ErrorKind::failed, row.paths.front(),
                  fmt::format("{} scans are open, which is the limit", kMostScans), "close some first"};
    }
    rows_.insert(place, std::move(row));
    if (full) return;
    const auto waiting =
        static_cast<uint64_t>(std::ranges::count(rows_, ScanState::opening, &ScanRow::state));
    const uint64_t sample = std::max(kLeastSamplePoints, kSamplePoints / std::max<uint64_t>(waiting, 1));
    InputOptions how = how_;
    how.paths = std::move(paths);
    push_opening(id, std::move(how), together, sample);
}

ScanRow* ScanSet::row_of(uint64_t id) {
    const auto row = std::ranges::find(rows_, id, &ScanRow::id);
    return row == rows_.end() ? nullptr : &*row;
}

/// Cancels an item's work. Its build is destroyed on the opening thread, so that the window does not wait for
/// it.
void ScanSet::retire(Item& item) {
    item.watch->cancelled = true;
    if (!item.input.build) return;
    item.input.build->stop();
    opener_.push(
        "closing a scan",
        [input = std::make_shared<OpenInput>(std::exchange(item.input, {}))]() mutable { input.reset(); });
}

void ScanSet::remove(uint64_t id) {
    if (const auto item = items_.find(id); item != items_.end()) {
        retire(item->second);
        items_.erase(item);
    }
    std::erase_if(rows_, [&](const ScanRow& row) { return row.id == id; });
    stale_ = true;
}

void ScanSet::set_visible(uint64_t id, bool visible) {
    ScanRow* row = row_of(id);
    if (!row || row->visible == visible) return;
    row->visible = visible;
    stale_ = true;
}

void ScanSet::stop(uint64_t id) {
    ScanRow* row = row_of(id);
    if (!row) return;
    if (row->state == ScanState::opening) return remove(id);
    Item& item = items_[id];
    if (row->state == ScanState::converting && item.input.build) item.input.build->stop();
    if (row->state == ScanState::sample) row->state = ScanState::stopped;
}

void ScanSet::go_on(uint64_t id) {
    ScanRow* row = row_of(id);
    if (!row || row->state != ScanState::stopped) return;
    Item& item = items_[id];
    row->error.reset();
    if (!item.going) {
        row->state = ScanState::sample;  // its conversion had not started
        return;
    }
    open_again(*row, item);
}

/// Opens a row's files again. What is drawn of them stays meanwhile.
void ScanSet::open_again(ScanRow& row, Item& item) {
    retire(item);  // before the new build is opened, since both use the same file name
    item.watch = std::make_shared<Watch>();
    item.operation = {};
    item.going = false;
    row.error.reset();
    row.state = ScanState::opening;
    row.stage = "opening";
    row.share = 0;
    InputOptions how = how_;
    how.paths = row.paths;
    push_opening(row.id, std::move(how), true, kSamplePoints);
}

/// A window that opens a scan while another one converts it leaves that to it, since both would write one
/// cache. It converts the scan itself if the other window is closed before its cache is finished.
void ScanSet::take_caches_of_others() {
    const auto now = std::chrono::steady_clock::now();
    if (now - looked_ < kBetweenLooks) return;
    looked_ = now;
    for (ScanRow& row : rows_) {
        if (row.state != ScanState::stopped && row.state != ScanState::elsewhere) continue;
        Item& item = items_[row.id];
        const bool finished = !item.input.cache.empty() && time_of(item.input.cache) != item.cache_time;
        const bool free = row.state == ScanState::elsewhere && !item.input.build->is_built_elsewhere();
        if (finished || free) open_again(row, item);
    }
}

void ScanSet::convert_next() {
    if (std::ranges::any_of(rows_, [](const auto& row) { return row.state == ScanState::converting; }))
        return;
    const auto next = std::ranges::find(rows_, ScanState::sample, &ScanRow::state);
    if (next == rows_.end()) return;
    Item& item = items_[next->id];
    item.going = true;
    next->state = ScanState::converting;
    item.input.build->begin(shared_->changed);
}

void ScanSet::seen() {
    if (stale_ || joining_) return;  // the next source has more
    for (const auto& [id, item] : items_)
        if (item.going && item.input.build) item.input.build->seen(item.source.get());
}

/// Fills a row from its source.
void ScanSet::describe(const Item& item, ScanRow& row) const {
    const octree::SourceHeader& header = item.source->header();
    row.points = header.points;
    row.memory = item.source->directory_bytes();
    if (header.points) row.box = {header.min, header.max};
    row.file_bytes = 0;
    row.of_path.clear();
    uint64_t declared = 0;
    for (const io::ScanInfo& scan : header.scans) {
        row.file_bytes += scan.file_bytes;
        declared += scan.declared_points;
        row.of_path.push_back(scan.declared_points);
    }
    // Until the scan is complete, its source contains only a sample.
    if (row.state != ScanState::whole) row.points = std::max(row.points, declared);
    if (row.of_path.size() != row.paths.size()) row.of_path.clear();
}

void ScanSet::take_opened() {
    std::vector<std::pair<uint64_t, Result<Opened>>> opened;
    {
        const std::lock_guard lock(shared_->mutex);
        opened.swap(shared_->opened);
    }
    for (auto& [id, one] : opened) {
        ScanRow* row = row_of(id);
        if (!row) continue;  // removed meanwhile; a build that has not started is dropped at once
        if (one && !one->instead.empty()) {
            if (one->together) {
                std::string folder = row->paths.size() == 1 ? row->paths.front() : std::string();
                open_one(std::move(one->instead), true, id, std::move(folder));
            } else {
                for (std::string& path : one->instead) open_one({std::move(path)}, false, id);
            }
            remove(id);
            continue;
        }
        Item& item = items_[id];
        row->stage.clear();
        if (!one) {
            row->state = item.source ? ScanState::stopped : ScanState::failed;
            row->error = std::move(one).error();
            const log::Operation::Scope scope(item.operation);
            log::warn("{}", row->error->line());
            continue;
        }
        item.input = std::move(one->input);
        item.source = item.input.source;
        if (!item.input.cache.empty()) item.cache_time = time_of(item.input.cache);
        row->state = item.input.build ? ScanState::sample : ScanState::whole;
        describe(item, *row);
        stale_ = true;
    }
}

void ScanSet::take_builds() {
    for (ScanRow& row : rows_) {
        const auto found = items_.find(row.id);
        if (found == items_.end()) continue;
        Item& item = found->second;
        if (row.state == ScanState::opening) row.share = item.watch->share;
        if (!item.input.build || row.state != ScanState::converting) continue;
        octree::BuildState build = item.input.build->state();
        row.stage = std::move(build.progress.stage);
        row.share = build.progress.share;
        if (build.source != item.source) {
            item.source = std::move(build.source);
            stale_ |= row.visible;
        }
        if (build.finished) {
            row.state = ScanState::whole;
            item.input.build.reset();  // its thread has finished
        } else if (!build.error && !build.stopped && item.input.build->is_built_elsewhere()) {
            row.state = ScanState::elsewhere;
        } else if (!build.error) {
            row.state = ScanState::stopped;
            if (!build.stopped) row.error = std::move(build.error).error();
            const log::Operation::Scope scope(item.operation);
            if (row.error) log::warn("the cache was not finished: {}", row.error->line());
        }
        describe(item, row);
    }
}

/// Joins the visible scans on a thread, because this copies all directories and the starting view reads some
/// nodes.
void ScanSet::join_visible() {
    if (!stale_ || joining_) return;
    stale_ = false;
    std::vector<Source> visible;
    std::vector<uint64_t> ids;
    for (const ScanRow& row : rows_)
        if (const auto item = items_.find(row.id);
            row.visible && item != items_.end() && item->second.source) {
            visible.push_back(item->second.source);
            ids.push_back(row.id);
        }
    joining_ = true;
    joiner_.push(
        "the open scans",
        [visible = std::move(visible), ids = std::move(ids), start_of = start_of_,
         grows = std::ranges::any_of(rows_, &ScanRow::grows)]() mutable -> Result<Joined> {
            if (visible.empty()) return Joined{};
            LUCARNE_ASSIGN(Source source, octree::join_sources(std::move(visible)));
            auto start = start_of(*source);
            return Joined{std::move(source), std::move(start), std::move(ids), grows};
        },
        [shared = shared_](Result<Joined> joined) {
            {
                const std::lock_guard lock(shared->mutex);
                shared->joined = std::move(joined);
            }
            shared->changed();
        });
}

void ScanSet::take_joined() {
    std::optional<Result<Joined>> joined;
    {
        const std::lock_guard lock(shared_->mutex);
        joined = std::exchange(shared_->joined, std::nullopt);
    }
    if (!joined) return;
    joining_ = false;
    problem_.reset();
    if (!*joined) {
        problem_ = std::move(*joined).error();
        return;
    }
    source_ = std::move((*joined)->source);
    source_grows_ = (*joined)->grows;
    shown_ = std::move((*joined)->ids);
    start_.reset();
    if (!source_) return;
    if ((*joined)->start)
        start_ = std::move(*(*joined)->start);
    else
        problem_ = std::move((*joined)->start).error();
}

bool ScanSet::update() {
    const Source before = source_;
    take_opened();
    take_builds();
    take_caches_of_others();
    take_joined();
    join_visible();
    return source_ != before;
}

bool ScanSet::converting() const {
    return std::ranges::any_of(rows_, [](const auto& row) { return row.state == ScanState::converting; });
}

bool ScanSet::grows() const {
    return std::ranges::any_of(rows_, &ScanRow::grows) || (source_grows_ && !settled());
}

bool ScanSet::settled() const {
    return !stale_ && !joining_ && std::ranges::none_of(rows_, &ScanRow::busy);
}

Result<void> ScanSet::error() const {
    for (const ScanRow& row : rows_)
        if (row.error) return tl::make_unexpected(*row.error);
    if (problem_) return tl::make_unexpected(*problem_);
    return {};
}

}  // namespace lucarne::viewer
