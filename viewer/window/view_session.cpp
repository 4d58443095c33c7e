#include "viewer/window/view_session.h"

#include <algorithm>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include "gi/registry.h"
#include "io/core/guarded.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "io/files/free_name.h"
#include "viewer/frame/rgba.h"
#include "viewer/light/darkness.h"
#include "viewer/light/preparing.h"
#include "viewer/opening/first_view.h"
#include "viewer/opening/moods.h"
#include "viewer/ui/on_screen.h"
#include "viewer/ui/popups.h"
#include "viewer/window/actions/actions.h"
#include "viewer/window/panels/panels.h"
#include "viewer/window/unsaved.h"

namespace lucarne::viewer {
namespace {

constexpr std::chrono::seconds kMessageTime(10);  ///< for which a message is shown

constexpr double kSharp = 0.1;       ///< s without motion until the picture is made at full size
constexpr double kRest = 0.25;       ///< and at full quality
constexpr double kStep = 1.0 / 60;   ///< s between the window's frames while something moves
constexpr double kInFront = 1.2;     ///< m: how near the camera goes to what was clicked twice
constexpr uint32_t kIdleFrames = 4;  ///< frames until ImGui's windows have their final sizes

double axis(int less, int more) {
    return (ImGui::IsKeyDown(more) ? 1.0 : 0.0) - (ImGui::IsKeyDown(less) ? 1.0 : 0.0);
}

/// Returns whether points of visible scans are missing.
bool is_sketch(const ScanSet& scans) {
    return scans.grows() || std::ranges::any_of(scans.rows(), [](const ScanRow& row) {
               return row.visible && row.state == ScanState::stopped;
           });
}

constexpr double kQuickScale = 0.5;  ///< of the first picture that a slow engine makes of another light

/// Returns whether a picture by an engine takes so long that it reports its progress.
bool is_slow(std::string_view engine) {
    const auto entry = gi::find_engine(engine);
    return entry && (*entry)->info.reports_progress;
}

/// Draws the background of the first picture, before there is one.
void draw_backdrop(const gi::Backdrop& backdrop) {
    if (backdrop.kind != gi::Backdrop::Kind::gradient) return;
    const auto colour = [](const glm::dvec3& c) {
        return ImGui::ColorConvertFloat4ToU32(
            ImVec4(static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z), 1));
    };
    const ImU32 top = colour(backdrop.top), bottom = colour(backdrop.bottom);
    ImGui::GetBackgroundDrawList()->AddRectFilledMultiColor(ImVec2(0, 0), ImGui::GetIO().DisplaySize, top,
                                                            top, bottom, bottom);
}

}  // namespace

double ViewSession::seconds_at_rest() const {
    return std::chrono::duration<double>(Clock::now() - moved_).count();
}

void ViewSession::take_picture() {
    if (!scans_.source()) return;  // the last scan was closed; the worker may not know it yet
    take_progress(model_.lighting(), worker_.preparing());
    const auto latest = worker_.latest();
    if (!latest || (model_.view.picture && latest->number == model_.view.picture->number)) return;
    model_.view.picture = latest;
    if (latest->moving && !latest->sketch) {
        quality_.observe(latest->stats.seconds);
        const auto now = Clock::now();
        model_.health.pictures.add(std::chrono::duration<double>(now - last_moving_).count());
        last_moving_ = now;
    }
    model_.view.scale = quality_.scale();
    model_.health.shaders = latest->shader_problem;
    const uint64_t lost = latest->stats.nodes_lost;
    model_.health.nodes =
        lost == 0 ? "" : fmt::format("left out of the picture: {}", latest->stats.lost_node);
    if (lost > 1) model_.health.nodes += fmt::format(" (and {} more)", lost - 1);
    if (latest->source == scans_.source() && latest->stats.nodes_pending == 0) scans_.seen();
    const bool last_source = scans_.settled() && latest->source == scans_.source();
    const bool own_engine = latest->stats.lit_by == sent_.method.engine;  // none that stands in
    const bool newest = latest->request == sent_number_ && !latest->moving;
    const bool whole =
        newest && !sent_.small && own_engine && latest->stats.nodes_pending == 0 && last_source;
    whole_pictures_ = whole ? latest->stats.accumulated : 0;
    relit_seen_ |= newest;
    lit_seen_ |= latest->source == scans_.source() && !latest->moving &&
                 !gi::engine_is(latest->stats.lit_by, &gi::EngineInfo::unlit);
    if (last_source && !latest->stats.prepared_for.empty())
        model_.history.without_step(model_, [&] { follow_preparing(model_.lighting()); });
    if (whole) help_in_the_dark(*latest);
}

/// Says what to do where no light reaches the view, as in a closed room in daylight.
void ViewSession::help_in_the_dark(const Picture& picture) {
    if (std::exchange(looked_for_dark_, picture.request) == picture.request) return;
    const bool dark = !gi::engine_is(picture.stats.lit_by, &gi::EngineInfo::unlit) && is_dark(picture);
    if (dark && !std::exchange(is_dark_, dark))
        model_.view.message = "No light gets here: choose Evening or Scan colours";
    is_dark_ = dark;
}

/// Makes lost contexts and their contents again.
Result<void> ViewSession::recover() {
    follow_device();
    if (!window_.lost()) return {};
    if (!tries_.take(Clock::now()))
        return failed("window", "the graphics driver has lost it repeatedly",
                      "check that the driver is up to date");
    const log::Operation::Scope scope{log::Operation()};
    log::warn("the graphics driver has lost the window; it is made again");
    LUCARNE_TRY(window_.recover());
    bookmarks_.textures_lost(model_.bookmarks);
    return {};
}

/// Replaces the worker's device if it was lost. The last picture stays meanwhile, and also if no device can
/// be made.
void ViewSession::follow_device() {
    const auto lost = worker_.lost_device();
    if (!lost || given_up_) return;
    const log::Operation::Scope scope{log::Operation()};
    log::warn("{}", lost->line());
    model_.view.message = lost->why + ": the graphics device is set up again";
    if (tries_.take(Clock::now())) {
        if (auto device = window_.renew_worker_device(Window::Hidden::view))
            return worker_.set_device(std::move(*device));
    }
    given_up_ = true;
    model_.view.message.clear();
    model_.health.device = fmt::format(
        "There are no more pictures: the graphics device was lost repeatedly ({}). Restart Lucarne.",
        lost->why);
    log::warn("{}", model_.health.device);
}

/// Updates light and camera to the starting view of all open scans, unless the user has changed them.
void ViewSession::take_extent() {
    const auto& start = scans_.start();
    if (!start) return;
    const auto is_open = [&](uint64_t id) {
        return std::ranges::find(scans_.rows(), id, &ScanRow::id) != scans_.rows().end();
    };
    if (!placed_ && !std::ranges::all_of(scans_.shown(), is_open)) return;  // of scans that have been closed
    const bool first = !std::exchange(placed_, true);
    const bool others = std::exchange(shown_scans_, scans_.shown()) != scans_.shown();
    lit_seen_ &= !others;
    // More points of the same scans must not shake the picture. Only once, when there are enough of them, the
    // view follows if they show something else than the first few; and once if the conversion has found the
    // station that all was scanned from.
    const bool sure = start->site.sure || scans_.settled();
    const bool station_found = sure && start->site.station && !placed_for_.station;
    const bool follows =
        first || others || station_found ||
        (sure && !sure_ && !(alike(placed_for_, start->site) && shown_alike(placed_for_, start->site)));
    sure_ = sure || (sure_ && !others);
    model_.view.scene_size = start->scene_size();
    model_.view.box = start->box;
    model_.view.site = start->site;
    if (first || others)
        begin_preparation(model_.lighting(), {.points = scans_.source()->header().points,
                                              .place = start->prepared_place,
                                              .file = start->prepared_file});
    model_.view.rig.set_clearance(model_.view.scene_size);
    if (first) model_.view.navigation.set_scene(start->scene_size(), start->metres_per_unit);
    if (!first && model_.view.scene_version != own_scene_) return;
    if (start->fits_window && !follows) return;
    placed_for_ = start->site;
    gi::SceneCamera home = start->camera;
    if (start->fits_window) home = first_view(start->site, picture_shape(model_.view.side_bar));
    const bool same_home =
        home.position == model_.view.home.position && home.target == model_.view.home.target;
    if (!first && same_home) return;
    const auto camera = model_.view.rig.camera();
    const bool at_home = first || model_.view.glide.under_way() ||
                         (CameraRig(model_.view.home).camera().position == camera.position &&
                          CameraRig(model_.view.home).camera().target == camera.target);
    model_.view.scene = start->scene;
    model_.lights.mood = start->mood;
    if (first && !start->engine.empty()) model_.view.method.engine = start->engine;
    model_.view.home = home;
    if (first)
        model_.view.go_to(home);
    else if (at_home)
        model_.view.glide_to(home);
    model_.view.scene_changed();
    own_scene_ = model_.view.scene_version;
    model_.scene_file.mark(model_.view);
    if (first) open_project();
}

/// Shows the work that was kept on the scans that have been opened first.
void ViewSession::open_project() {
    own_engine_ = model_.view.method.engine;
    if (project_.open(*scans_.source())) own_scene_ = 0;  // more points change nothing
}

/// Replaces the open scans and the work on them by those of a project's file. Scans that are not where they
/// were are looked for in `folder`; if some are missing, the user is asked. Errors: those of the file; none
/// of its scans is there; work would be lost. Then nothing changes.
Result<void> ViewSession::change_project(const std::filesystem::path& file,
                                         const std::filesystem::path& folder) {
    LUCARNE_ASSIGN(const Project project, read_project(file, std::nullopt));
    FoundScans scans = find_scans(project.scans, folder);
    if (scans.found.empty()) {
        if (scans.missing.empty()) return failed(file.string(), "names no scan");
        if (!shot_ && !model_.missing_scans.shown)
            model_.missing_scans.ask(file, std::move(scans.missing), false);
        return failed(file.string(), "none of its scans was found", "put them beside it");
    }
    model_.closing.kept = project_.keep();
    if (!work_to_lose(model_).empty())
        return failed(file.string(), "is not opened while other work is unsaved", "save that first");
    const std::vector<ScanRow> rows = scans_.rows();
    for (const ScanRow& row : rows) scans_.remove(row.id);
    if (!shot_ && !scans.missing.empty())
        model_.missing_scans.ask(file, scans.missing, true);
    else
        model_.missing_scans.shown = false;
    project_.use(file, std::move(scans.missing));
    placed_ = sure_ = lit_seen_ = false;
    model_.measure.stop();
    model_.measure.restore({}, model_.measure.metres_per_unit);
    LUCARNE_TRY(model_.publish.editor.restore({}));
    model_.history.restart(model_);
    for (auto& group : scans.found) scans_.open(std::move(group), true);
    return {};
}

void ViewSession::open_project_file(const std::filesystem::path& path) {
    const std::string file = absolute_path(path.string());
    model_.missing_scans.shown = false;
    if (const auto done = change_project(file, std::filesystem::path(file).parent_path()); !done) {
        log::warn("{}", model_.view.message = done.error().line());
        return;
    }
    model_.view.message = "opened " + file;
    model_.project_name.file = file;
    model_.settings.opened(file);
    settings_.save();
}

/// Looks for the missing scans of a project in the folder that the user has named.
void ViewSession::open_missing_scans() {
    MissingScans& question = model_.missing_scans;
    const auto folder = question.take_answer();
    if (!folder) return;
    if (!question.others_open) {
        const auto done = change_project(question.project, *folder);
        if (!done) question.problem = done.error().why;
        return;
    }
    ScanGroups missing;
    for (const std::string& path : question.paths) missing.push_back({path});
    FoundScans scans = find_scans(missing, *folder);
    question.problem = scans.found.empty() ? "None of them is there." : "These are still missing.";
    question.shown = !scans.missing.empty();
    for (auto& group : scans.found) scans_.open(std::move(group), true);
    question.paths = std::move(scans.missing);
    project_.still_missing(question.paths);
}

void ViewSession::save_project() {
    const auto answer = model_.project_name.take_answer();
    if (!answer) return;
    const auto saved = project_.save_as(answer->file, answer->overwrite);
    model_.project_name.problem = saved ? "" : saved.error().line();
    if (!saved) return;
    model_.project_name.shown = false;
    model_.view.message = "saved " + answer->file.string() + ", which is kept up to date";
    model_.settings.opened(absolute_path(answer->file.string()));
    settings_.save();
}

/// Whether the window shows anything but the start of what is open.
bool ViewSession::changed_by_user() const {
    if (!placed_ || model_.view.glide.under_way()) return false;
    const auto camera = model_.view.rig.camera(), home = CameraRig(model_.view.home).camera();
    return model_.view.scene_version != own_scene_ || model_.view.method.engine != own_engine_ ||
           camera.position != home.position || camera.target != home.target ||
           !model_.measure.list.all().empty() || !model_.publish.editor.empty();
}

/// Applies changes of the open scans. Starts conversions, one after another, once there is something to see.
void ViewSession::follow_scans() {
    if (scans_.update()) {
        model_.history.without_step(model_, [&] { take_extent(); });
        worker_.set_source(scans_.source());
        follow_stations(model_.stationing(), scans_.source().get());
        if (!scans_.source()) model_.view.picture = nullptr;
        whole_pictures_ = 0;
    }
    const bool seen = model_.view.picture && model_.view.picture->stats.nodes_pending == 0;
    if (seen && !std::exchange(first_told_, true))
        log::info("first picture after {:.2f} s: {} points", seconds_since_start(),
                  model_.view.picture->stats.view_points);
    if (placed_ && scans_.rows().empty()) project_.close();
    if (seen || (!scans_.source() && scans_.settled())) scans_.convert_next();
    model_.lights.preparation.grows = is_sketch(scans_);
    window_.set_title("Lucarne - " + scans_title(scans_.rows()));
}

/// Bookmarks belong to the scan that was opened first.
void ViewSession::follow_bookmarks() {
    const auto& rows = scans_.rows();
    bookmarks_.follow(model_.bookmarking(),
                      rows.empty()
                          ? std::filesystem::path()
                          : bookmark_folder(config_folder(), absolute_path(rows.front().paths.front())));
}

/// Returns the floor under the camera for walking, world z, once it has been found.
std::optional<double> ViewSession::floor() {
    const Navigation& navigation = model_.view.navigation;
    if (navigation.mode() != NavigationMode::walk || !navigation.gravity()) return std::nullopt;
    floor_.look(scans_.source(), model_.view.rig.position(), navigation.eye_height());
    return floor_.found();
}

bool ViewSession::take_navigation() {
    const ImGuiIO& io = ImGui::GetIO();
    NavigationInput input;
    input.seconds = io.DeltaTime;
    input.fast = io.KeyShift;
    if (!io.WantCaptureKeyboard)
        input.keys = {axis(GLFW_KEY_A, GLFW_KEY_D), axis(GLFW_KEY_Q, GLFW_KEY_E),
                      axis(GLFW_KEY_S, GLFW_KEY_W)};
    if (!io.WantCaptureMouse) {
        const NavigationMode mode = model_.view.navigation.mode();
        const bool twice = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
        const bool starts = ImGui::IsMouseClicked(ImGuiMouseButton_Left) ||
                            ImGui::IsMouseClicked(ImGuiMouseButton_Right) ||
                            ImGui::IsMouseClicked(ImGuiMouseButton_Middle);
        const bool goes = io.MouseWheel != 0 && model_.view.navigation.turns_scene();
        if (model_.view.picture && (goes || twice || (starts && mode == NavigationMode::orbit)))
            if (const auto point = model_.view.picture->pick(cursor())) {
                model_.view.rig.set_pivot(*point);
                if (twice && model_.view.inside() && mode == NavigationMode::orbit)
                    model_.view.glide_to(gone_toward(model_.view.rig.camera(), *point,
                                                     kInFront / model_.view.picture->metres_per_unit));
                else if (twice)
                    model_.view.message =
                        fmt::format("Pivot: {:.2f} {:.2f} {:.2f}", point->x, point->y, point->z);
            }
        input.inside = model_.view.inside();
        input.rotate = ImGui::IsMouseDown(ImGuiMouseButton_Left);
        input.shift =
            ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle);
        if (!starts) input.drag = cursor_move();
        input.scroll = io.MouseWheel;
    }
    model_.view.navigation.set_floor(floor());
    return model_.view.navigation.apply(input, model_.view.rig);
}

void ViewSession::take_input() {
    const ImGuiIO& io = ImGui::GetIO();
    if (controller_.take(model_, io.DeltaTime)) moved_ = Clock::now();
    std::vector<KeyChord> keys = window_.take_pressed_keys();
    if (const auto escape = std::ranges::find(keys, KeyChord{GLFW_KEY_ESCAPE});
        escape != keys.end() && close_popups())
        keys.erase(escape);
    if (model_.show_help || model_.show_about)  // it closes these
        std::erase_if(keys, [](const KeyChord& chord) { return chord.key == GLFW_KEY_ESCAPE; });
    // Do not test WantCaptureKeyboard: it is also set while the mouse holds an item, and one frame longer, so
    // keys would be lost.
    const bool menu = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    if (model_.closing.shown)
        closing_.answer(keys);
    else if (!io.WantTextInput && !menu && !files_.asks() && !model_.project_name.shown &&
             !model_.missing_scans.shown && !model_.exporting.name.shown)
        run_actions(actions_, keys);
    if (legend_.take(model_.styling()) || take_clip_handles(model_.styling()) ||
        take_comparison_border(model_.rendering()) || take_light_handles(model_.lighting()))
        return;
    if (!model_.measure.tool && take_station_spots(model_.stationing())) return;
    measure_.take_input(model_.measuring());
    const bool at_light = io.KeyShift && (ImGui::IsMouseDown(ImGuiMouseButton_Left) ||
                                          ImGui::IsMouseDown(ImGuiMouseButton_Right));
    if (at_light && !io.WantCaptureMouse) {
        light_.take_gesture(model_.lighting());
    } else if (take_navigation()) {
        model_.view.glide.stop();
        moved_ = Clock::now();
    }
    if (model_.view.advance(io.DeltaTime)) moved_ = Clock::now();
}

void ViewSession::draw_panels() {
    draw_overlay(model_.styling());
    if (!scans_.grows() && !is_preparing(model_.lighting())) draw_convergence(model_.view);
    follow_bookmarks();  // after the keys, so that a bookmark set in the last frame is saved
    draw_menu_bar(model_, actions_);
    if (scans_.rows().empty()) draw_start_page(model_);
    files_.draw();
    draw_closing_question(model_);
    draw_missing_scans(model_.missing_scans);
    draw_file_question("Save project", model_.project_name);
    export_.draw();
    measure_.draw(model_.measuring());
    draw_flythrough(model_.publishing());
    draw_side_bar(model_, placed_);
    if (!shot_ && placed_) draw_mood_bar(model_.lighting());
    if (!shot_) draw_status_line(model_);
    if (model_.show_help) draw_help(model_.show_help, actions_);
    if (model_.show_about) draw_about(model_.show_about);
    const auto error = worker_.error();
    model_.health.picture = error ? "" : error.error().line();
    if (!shot_) forget_message();
    draw_message(model_,
                 scans_.source() && (!model_.view.picture || model_.view.picture->request != sent_number_));
}

/// Clears a message that has been shown for a while. Problems stay, because they are not messages (Health).
void ViewSession::forget_message() {
    if (model_.view.message != message_) {
        message_ = model_.view.message;
        message_since_ = Clock::now();
    }
    if (Clock::now() - message_since_ > kMessageTime) model_.view.message.clear();
}

void ViewSession::send_request() {
    if (!scans_.source()) return;  // its camera is not known yet
    // Changes of lights count as motion; changes of display alone do not.
    const uint64_t moves = model_.view.scene_version - model_.view.shown_changes;
    const bool replaced = std::exchange(replaced_seen_, model_.view.replaced) != model_.view.replaced;
    if (scene_seen_ != moves && scene_seen_ != 0 && !replaced) moved_ = Clock::now();
    scene_seen_ = moves;
    if (replaced) relit_ = true, relit_seen_ = false;
    PictureRequest request;
    const double rest = seconds_at_rest();
    request.moving = rest < kRest;
    request.method = model_.view.method;
    request.frame.camera = model_.view.rig.camera();
    request.frame.front_only = looks_in_from_outside(model_.view.site, request.frame.camera);
    request.frame.size = scaled_size(window_.framebuffer(), model_.view.resolution_scale);
    // Averages and slow light would take the processors from what replaces them.
    const bool sketch = scans_.grows();
    request.frame.accumulate = !request.moving && !sketch && !is_preparing(model_.lighting());
    if (shot_) request.pictures = shot_->pictures;
    relit_ = relit_ && !request.moving;
    request.frame.complete = relit_;
    request.small = relit_ && !relit_seen_ && !shot_ && !sketch && is_slow(request.method.engine);
    if (request.small) {
        request.frame.size = scaled_size(window_.framebuffer(), kQuickScale * model_.view.resolution_scale);
        request.pictures = 1;
    }
    request.frame.moving = request.moving;
    request.frame.stand_in = request.moving || sketch;
    // Something is seen at once, and light follows: of a sketch not before its first picture at rest.
    request.frame.colours_only = (!model_.view.picture || (sketch && request.moving && !lit_seen_)) &&
                                 !gi::engine_is(request.method.engine, &gi::EngineInfo::unlit);
    request.frame.stand_in_early = true;
    request.frame.prepares = engine_to_prepare(model_.lighting());
    request.frame.prepares_again = model_.lights.preparation.asked;
    request.frame.at_rest = model_.view.method;
    if (request.moving) {
        const ImageSize size = quality_.size(request.frame.size);
        request.sketch = rest >= kSharp && !(size == request.frame.size);
        quality_.reduce(request.method.settings, request.method.budgets);
        if (!request.sketch) request.frame.size = size;
        request.frame.light_budget = request.sketch
                                         ? gi::StepBudget::paused()
                                         : gi::StepBudget::timed(kLightShare * model_.view.frame_time);
    }
    if (is_sketch(scans_))
        request.frame.most_pixels =
            std::max(1.5f, scaled(kSketchDots) * request.frame.size.height / window_.framebuffer().height);
    const bool goes_on = sent_.moving && !sent_.sketch;
    if (request.moving && !request.sketch && !goes_on) last_moving_ = Clock::now();
    request.scene_version = model_.view.scene_version;
    request.shader_version = model_.health.shader_version;
    if (sent_number_ != 0 && request.content() == sent_.content()) return;
    request.scene = model_.view.scene;
    sent_ = request;
    sent_number_ = worker_.request(std::move(request));
    whole_pictures_ = 0;
}

/// Returns a text about an unfinished picture; empty once the picture does not improve further.
std::string ViewSession::unfinished() const {
    if (whole_pictures_ == 0) return ", preview quality";
    const uint32_t averaged = model_.view.picture->stats.accumulated;
    return averaged < kMostAccumulated ? fmt::format(", {} of {} frames", averaged, kMostAccumulated) : "";
}

Result<void> ViewSession::carry_out() {
    const Overloaded run{
        [&](SaveScene) {
            model_.scene_file.save(model_.view);
            log::info(model_.view.message);
        },
        [&](SavePicture) { save_picture(); },
        [&](Close) { closing_.request(); },
        [&](const OpenProject& open) { open_project_file(open.file); },
    };
    for (const auto& command : model_.commands.take()) std::visit(run, command);
    open_missing_scans();
    save_project();
    export_.follow();
    return save_shot();
}

void ViewSession::save_picture() {
    if (!model_.view.picture) return;
    const Picture& picture = *model_.view.picture;
    const std::string path = free_name(model_.view.pictures, "lucarne", {".png"}).string() + ".png";
    const auto saved = io::write_png(path, without_alpha(picture.rgba, picture.size), false);
    model_.view.message =
        saved ? fmt::format("saved {}{}", absolute_path(path), unfinished()) : saved.error().line();
    log::info(model_.view.message);
}

Result<void> ViewSession::save_shot() {
    const bool nothing = scans_.rows().empty() && scans_.settled();
    idle_frames_ = nothing ? idle_frames_ + 1 : 0;
    if (!shot_ || (whole_pictures_ < shot_->pictures && idle_frames_ < kIdleFrames)) return {};
    closing_.request();
    return io::write_png(shot_->file, without_alpha(window_.capture(), window_.framebuffer()),
                         shot_->overwrite);
}

Result<void> ViewSession::run() {
    auto done = guarded("window", [&] { return show_until_closed(); });
    if (!done) {
        if (project_.keep()) return done;
        if (const auto saved = save_unsaved(model_, SaveTo::free_names); !saved)
            log::warn("{}", saved.error().line());
        return done;
    }
    log::info("window: {} frames, each {:.1f} ms, 95 % of the last ones within {:.1f} ms",
              model_.health.frames.frames(), 1e3 * model_.health.frames.quantile(0.5),
              1e3 * model_.health.frames.quantile(0.95));
    const FrameTimes& pictures = model_.health.pictures;
    log::info("while moving: {} pictures, {:.1f} ms apart, 95 % within {:.1f} ms", pictures.frames(),
              1e3 * pictures.quantile(0.5), 1e3 * pictures.quantile(0.95));
    window_.hide();
    return {};
}

Result<void> ViewSession::show_until_closed() {
    Clock::time_point awake = Clock::now();
    while (!closing_.agreed(shot_.has_value())) {
        if (interrupt_.requested())
            return project_.keep() ? Result<void>() : save_unsaved(model_, SaveTo::free_names);
        const bool lively = seconds_at_rest() < 2 * kRest || ImGui::IsAnyMouseDown();
        // The interval counts from one frame's start to the next one's, so that a frame's own time is not
        // added.
        const double since = std::chrono::duration<double>(Clock::now() - awake).count();
        window_.wait((lively ? kStep : kRest) - since);
        awake = Clock::now();
        LUCARNE_TRY(recover());
        take_picture();
        window_.set_text_size(model_.settings.text_size);
        window_.begin_frame();
        if (model_.view.picture)
            window_.show(*model_.view.picture);
        else if (!scans_.rows().empty())
            draw_backdrop(model_.view.scene.look.backdrop);
        files_.take_files();
        follow_scans();
        light_.follow_sky(model_.lighting());
        if (light_.follow_day(model_.lighting(), ImGui::GetIO().DeltaTime)) moved_ = Clock::now();
        take_input();
        if (publish_.follow(model_.publishing(), scans_.source())) moved_ = Clock::now();
        draw_panels();
        const bool drawn = window_.draw(shot_.has_value());
        LUCARNE_TRY(carry_out());
        if (drawn) window_.swap();
        if (!ImGui::IsAnyMouseDown() && !ImGui::IsAnyItemActive() && !model_.lights.plays_day)
            model_.history.follow(model_);
        send_request();
        if (seconds_at_rest() > kRest) project_.follow(changed_by_user());
        if (drawn) model_.health.frames.add(std::chrono::duration<double>(Clock::now() - awake).count());
        if (!shot_) continue;
        if (given_up_) return tl::make_unexpected(*worker_.lost_device());
        LUCARNE_TRY(worker_.error());
        LUCARNE_TRY(scans_.error());
    }
    return {};
}

}  // namespace lucarne::viewer
