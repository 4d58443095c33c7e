#include "gi/bake/bake_job.h"

#include <chrono>
#include <optional>
#include <system_error>
#include <utility>

#include "gi/bake/bake_file.h"
#include "io/core/guarded.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "io/files/file.h"

namespace lucarne::gi {
namespace {

constexpr std::chrono::milliseconds kLook(50);          // between two looks at `stop`
constexpr std::chrono::milliseconds kBetweenNews(500);  // of the finished share alone
constexpr std::chrono::seconds kBetweenSaves(60);       // so that a crash loses little
constexpr double kThousandths = 1000;

}  // namespace

BakeJob::BakeJob(BakeOrder order, std::function<void(const Status&)> published)
    : order_(std::move(order)), published_(std::move(published)) {
    thread_ = std::thread([this] {
        auto done = guarded(order_.engine->name, [this] { return compute(); });
        {
            const std::lock_guard lock(mutex_);
            status_.error = std::move(done);
            status_.ended = true;
            status_.step.clear();
        }
        changed_.notify_all();
        published_(status());
    });
}

BakeJob::~BakeJob() {
    stop_ = true;
    thread_.join();
}

BakeJob::Status BakeJob::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

void BakeJob::wait(const std::atomic<bool>* stop, Progress* progress) const {
    uint64_t shown = 0;
    std::unique_lock lock(mutex_);
    while (!status_.ended && !(stop && stop->load(std::memory_order_relaxed))) {
        changed_.wait_for(lock, kLook);
        const auto now = static_cast<uint64_t>(kThousandths * status_.share);
        if (progress && now > shown) progress->add(now - std::exchange(shown, now));
    }
}

/// Publishes what is usable after a step, before the step called `next`.
void BakeJob::note(const Precomputation& work, std::string_view next) {
    auto bake = work.snapshot();
    bool news = false;
    {
        const std::lock_guard lock(mutex_);
        status_.step = next;
        status_.share = work.share();
        news = bake != status_.bake;
        if (news) ++status_.version;
        status_.bake = std::move(bake);
    }
    changed_.notify_all();
    const auto now = std::chrono::steady_clock::now();
    if (!news && now - told_ < kBetweenNews) return;
    told_ = now;
    published_(status());
}

/// Returns work that continues from a kept file. Errors: it is damaged, or was made from another input.
Result<std::unique_ptr<Precomputation>> BakeJob::restored(const std::filesystem::path& path,
                                                          uint64_t key) const {
    const Precomputes& how = *order_.engine->precomputes;
    LUCARNE_ASSIGN(const auto file, InputFile::open_shared(path));
    LUCARNE_ASSIGN(const BakeHeader header, read_bake_header(*file));
    if (header.engine != order_.engine->name || header.version != how.version || header.key != key)
        return rejected(path.string(), "was computed from another scan, scene or options");
    LUCARNE_ASSIGN(const BakeFile bake, read_bake(*file, order_.most_bytes));
    auto work = how.make();
    LUCARNE_TRY(work->restore(order_.input, bake.sections));
    return work;
}

/// Returns work that continues from a kept file if one was made from the same input, else new work.
std::unique_ptr<Precomputation> BakeJob::begin(uint64_t key) {
    std::optional<Error> problem;
    for (const std::filesystem::path& path : {order_.file, order_.read_only}) {
        std::error_code unknown;
        if (path.empty() || !std::filesystem::exists(path, unknown)) continue;
        if (auto work = restored(path, key)) {
            const std::lock_guard lock(mutex_);
            status_.file = path;
            return std::move(*work);
        } else {
            problem = std::move(work).error();
        }
    }
    if (problem) log::info("{}; it is computed again", problem->line());
    return order_.engine->precomputes->make();
}

/// Writes the file. An unfinished result never replaces a finished one of another input.
Result<void> BakeJob::keep(const Precomputation& work, uint64_t key) {
    const double share = work.share();
    if (order_.file.empty() || share <= 0) return {};
    if (share < 1) {
        std::error_code unknown;
        if (std::filesystem::exists(order_.file, unknown)) {
            const auto kept = read_bake_header(order_.file);
            if (kept && kept->share >= 1 && kept->key != key) return {};
        }
    }
    LUCARNE_TRY(write_bake(
        order_.file,
        {{std::string(order_.engine->name), order_.engine->precomputes->version, key, share}, work.save()}));
    const std::lock_guard lock(mutex_);
    status_.file = order_.file;
    return {};
}

Result<void> BakeJob::compute() {
    give_way();  // pictures come first
    BakeInput& input = order_.input;
    std::vector<octree::Filling> fillings;
    if (order_.fill_holes) {
        LUCARNE_ASSIGN(fillings, order_.source->fillings());
    }
    LUCARNE_ASSIGN(input.cut, load_host_cut(*order_.source, order_.cut, input.cut.frame, *order_.preparation,
                                            order_.clip, fillings, &stop_));
    const uint64_t key = bake_key(order_.engine->name, *order_.engine->precomputes, input);
    const auto work = begin(key);
    StepRunner<const BakeInput> runner;
    if (work->share() < 1) runner.start(work->steps(input));
    note(*work, runner.step());
    const bool was_whole = !runner.running();
    auto saved = std::chrono::steady_clock::now();
    while (runner.running() && !stop_) {
        LUCARNE_TRY(runner.run(input, StepBudget::timed(0), &stop_));
        note(*work, runner.step());
        if (std::chrono::steady_clock::now() - saved < kBetweenSaves) continue;
        if (auto kept = keep(*work, key); !kept) log::warn("{}", kept.error().line());
        saved = std::chrono::steady_clock::now();
    }
    if (!was_whole) {
        auto kept = keep(*work, key);
        if (!kept && stop_) log::warn("{}", kept.error().line());  // nobody asks for the status any more
        const std::lock_guard lock(mutex_);
        status_.keeping = std::move(kept);
    }
    return {};
}

}  // namespace lucarne::gi
