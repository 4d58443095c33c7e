#include "viewer/light/preparing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "gi/bake/bake_file.h"
#include "gi/bake/precomputation.h"
#include "gi/registry.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "viewer/opening/moods.h"

namespace lucarne::viewer {
namespace {

constexpr double kLeastProgress = 0.02;  ///< before which the time that is left is not told

std::string time_text(double seconds) {
    if (seconds < 90) return fmt::format("{:.0f} s", std::max(std::round(seconds / 5), 1.0) * 5);
    return fmt::format("{:.0f} min", std::ceil(seconds / 60));
}

/// Returns a size in steps of 10 MiB, since it is only estimated.
std::string about_bytes(uint64_t bytes) {
    constexpr double kStep = 10 << 20;
    return fmt::format("{:.0f} MiB", 10 * std::max(std::round(static_cast<double>(bytes) / kStep), 1.0));
}

const FrameStats* stats_of(const View& view) {
    const bool about_it = view.picture && view.picture->stats.prepared_for == prepared_engine();
    return about_it ? &view.picture->stats : nullptr;
}

uint64_t size_of(const std::filesystem::path& file) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(file, unknown);
    return unknown ? 0 : bytes;
}

gi::BakeCost cost_of(const Lighting& model) {
    const auto entry = gi::find_engine(prepared_engine());
    if (!entry || !(*entry)->info.precomputes || !(*entry)->info.precomputes->cost) return {};
    const Method& method = model.view.method;
    const uint64_t surfels = std::min(model.lights.preparation.points, method.budgets.light);
    return (*entry)->info.precomputes->cost(method.settings, surfels);
}

/// Returns the share that the kept file holds; none without one. It is read once for each news of the work:
/// frames ask for it.
std::optional<double> kept_share(const Lighting& model) {
    Preparation& preparation = model.lights.preparation;
    const std::filesystem::path& path = preparation.place;
    if (path.empty()) return std::nullopt;
    if (!preparation.kept_read) {
        const auto header = gi::read_bake_header(path);
        preparation.kept_share = header ? std::optional(header->share) : std::nullopt;
        preparation.kept_read = true;
    }
    return preparation.kept_share;
}

/// Ends what is not finished. Pictures are by the engine that drew before, or by that of an unprepared view.
void give_up(const Lighting& model) {
    Preparation& preparation = model.lights.preparation;
    preparation.wanted = false;
    // A file found at the start was for other options, or there would be nothing to stop.
    model.view.is_prepared = false;
    preparation.file.clear();
    const std::string before = std::exchange(preparation.engine_before, {});
    std::string& engine = model.view.method.engine;
    if (engine != prepared_engine()) return;
    engine = before.empty() ? engine_here(model.view, model.lights.mood.value_or(Mood::evening)) : before;
}

}  // namespace

std::string why_not_prepared(const Lighting& model) {
    const auto entry = gi::find_engine(prepared_engine());
    if (!entry || !gi::can_run((*entry)->info)) return "The engine cannot run here.";
    if (!model.view.picture || model.view.site.outline.empty()) return "There is no picture yet.";
    if (model.lights.preparation.grows) return "The scan is still being converted: wait until it is whole.";
    if (!shows_rooms(model.view))
        return model.view.site.inside ? "It is for rooms: go inside first (Navigate, Go inside)."
                                      : "It is for rooms, and this scan shows none.";
    if (is_preparing(model)) return "It is being prepared.";
    if (model.view.is_prepared) return "It is prepared.";
    return "";
}

std::string preparing_cost(const Lighting& model) {
    const gi::BakeCost cost = cost_of(model);
    const Preparation& preparation = model.lights.preparation;
    const unsigned processors = std::max(1u, std::thread::hardware_concurrency());
    std::string text =
        fmt::format("Takes about {} on {} {} (rooms differ by half), {} of memory meanwhile, and ",
                    time_text(cost.cpu_seconds / processors), processors,
                    processors == 1 ? "processor" : "processors", about_bytes(cost.memory_bytes));
    if (preparation.place.empty())
        return text + "is forgotten when the window is closed: there is no place for a file.";
    text += fmt::format("up to {} on disk.", about_bytes(cost.file_bytes));
    std::error_code unknown;
    const auto space = std::filesystem::space(preparation.place.parent_path(), unknown);
    if (!unknown && space.available < cost.file_bytes)
        text += fmt::format(" Only {} are free there, so it may not be kept.", bytes_text(space.available));
    return text;
}

std::string preparing_gain() {
    return "Computes once how light goes about this room. Then any lamp, the sun, the sky and materials can\n"
           "be changed with all bounces in the next picture, without noise. The picture can be used "
           "meanwhile.";
}

bool is_preparing(const Lighting& model) {
    if (model.lights.preparation.wanted) return true;
    const FrameStats* stats = stats_of(model.view);
    return stats && *stats->prepared < 1 && stats->not_prepared.empty() &&
           model.view.method.engine == prepared_engine();
}

double prepared_share(const View& view) {
    return stats_of(view) ? view.preparing.share : 0;
}

std::string preparing_progress(const Lighting& model) {
    const Preparation& preparation = model.lights.preparation;
    const double share = prepared_share(model.view), done = share - preparation.share_at_begin;
    std::string text = fmt::format("{:.0f} %", std::floor(100 * share));
    // Whether it failed or is kept is known with the next picture, which may take long.
    if (share > 0 && model.view.preparing.ended) return text + ", ends with the next picture";
    if (!preparation.begun || done < kLeastProgress) return text;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - *preparation.begun;
    return text + ", about " + time_text(spent.count() * (1 - share) / done) + " left";
}

std::string prepared_state(const Lighting& model) {
    const Preparation& preparation = model.lights.preparation;
    if (!model.view.is_prepared) return "";
    if (preparation.file.empty())
        return preparation.problem.empty()
                   ? "Prepared, until the window is closed."
                   : fmt::format("Prepared, until the window is closed: {}", preparation.problem);
    return fmt::format("Prepared: {} in {}", bytes_text(preparation.file_bytes), preparation.file.string());
}

void prepare(const Lighting& model) {
    if (!why_not_prepared(model).empty()) return;
    Preparation& preparation = model.lights.preparation;
    preparation.wanted = true;
    preparation.problem.clear();
    preparation.kept_read = false;
    ++preparation.asked;
    preparation.begun.reset();
    std::string& engine = model.view.method.engine;
    preparation.engine_before = engine == prepared_engine() ? std::string() : engine;
    const bool lit = !gi::engine_is(engine, &gi::EngineInfo::unlit);
    if (lit && shows_moods(engine, SiteKind::interior)) engine = prepared_engine();
    model.view.message = "Preparing light. " + preparing_cost(model);
}

void stop_preparing(const Lighting& model) {
    if (!is_preparing(model)) return;
    model.lights.preparation.kept_read = false;
    const bool is_there = kept_share(model).value_or(1) < 1;
    const std::string kept = is_there ? what_stopping_keeps(model) : "";
    model.view.message = fmt::format("Stopped at {:.0f} %{}{}", std::floor(100 * prepared_share(model.view)),
                                     kept.empty() ? "" : ". ", kept);
    give_up(model);
}

std::string what_stopping_keeps(const Lighting& model) {
    const std::filesystem::path& place = model.lights.preparation.place;
    if (model.view.preparing.ended && prepared_share(model.view) >= 1)
        return "It is finished, and is shown by the next picture";
    if (place.empty()) return "Nothing is kept: there is no place for a file";
    if (kept_share(model).value_or(0) >= 1)
        return "Nothing is kept: the file holds a finished preparation for another scan or other options";
    return "Gathering points that are done are kept, and it continues from them";
}

void take_progress(const Lighting& model, BakeProgress progress) {
    Preparation& preparation = model.lights.preparation;
    if (progress.share != model.view.preparing.share) preparation.kept_read = false;
    model.view.preparing = std::move(progress);
    const double share = prepared_share(model.view);
    // What is restored from a file was not done since.
    if (!preparation.wanted || share <= 0 || share < preparation.share_at_begin) preparation.begun.reset();
    if (!preparation.wanted || share <= 0 || preparation.begun) return;
    preparation.begun = std::chrono::steady_clock::now();
    preparation.share_at_begin = share;
}

void follow_preparing(const Lighting& model) {
    Preparation& preparation = model.lights.preparation;
    const FrameStats* stats = stats_of(model.view);
    if (!stats) return;
    // A picture that was begun before the user asked again tells of the last failure.
    const bool is_answer = preparation.wanted && stats->prepares_again == preparation.asked;
    if (!stats->not_prepared.empty() && is_answer) {
        model.view.message = preparation.problem = stats->not_prepared;
        give_up(model);
        return;
    }
    const bool is_whole = *stats->prepared >= 1 && stats->not_prepared.empty();
    const bool was_whole = std::exchange(preparation.whole, is_whole);
    if (!is_whole) return;
    model.view.is_prepared = true;
    preparation.problem = stats->not_kept;
    const auto file = preparation.problem.empty() ? stats->prepared_file : std::filesystem::path();
    if (const bool is_other = std::exchange(preparation.file, file) != file; is_other || !was_whole)
        preparation.file_bytes = size_of(file);
    if (!std::exchange(preparation.wanted, false)) return;
    preparation.engine_before.clear();
    model.view.message = prepared_state(model);
    log::info("{}", model.view.message);
    const bool lit = !gi::engine_is(model.view.method.engine, &gi::EngineInfo::unlit);
    if (lit && shows_moods(model.view.method.engine, SiteKind::interior, true))
        model.view.method.engine = prepared_engine();
    else
        model.view.message += ". Moods are shown by it.";
}

void begin_preparation(const Lighting& model, Preparation preparation) {
    model.view.is_prepared = !preparation.file.empty();
    preparation.file_bytes = size_of(preparation.file);
    model.lights.preparation = std::move(preparation);
}

std::string_view engine_to_prepare(const Lighting& model) {
    // What no file holds is lost when the job ends.
    const bool lost = model.view.is_prepared && model.lights.preparation.file.empty();
    return model.lights.preparation.wanted || lost ? prepared_engine() : std::string_view();
}

}  // namespace lucarne::viewer
