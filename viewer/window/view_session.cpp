#include "viewer/window/view_session.h"

#include <algorithm>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include "io/core/guarded.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "io/files/free_name.h"
#include "viewer/frame/rgba.h"
#include "viewer/light/edits.h"
#include "viewer/window/actions.h"
#include "viewer/window/panels/panels.h"
#include "viewer/window/unsaved.h"

namespace lucarne::viewer {
namespace {

constexpr double kRest = 0.25;       ///< s without motion until the picture is made at full quality
constexpr double kStep = 1.0 / 60;   ///< s between the window's frames while something moves
constexpr uint32_t kIdleFrames = 4;  ///< frames until ImGui's windows have their final sizes

bool same_request(const PictureRequest& a, const PictureRequest& b) {
    return a.frame.camera.position == b.frame.camera.position &&
           a.frame.camera.target == b.frame.camera.target &&
           a.frame.camera.vertical_fov == b.frame.camera.vertical_fov &&
           a.frame.camera.orthographic_height == b.frame.camera.orthographic_height &&
           a.frame.size.width == b.frame.size.width && a.frame.size.height == b.frame.size.height &&
           a.engine == b.engine && a.settings == b.settings && a.budgets == b.budgets &&
           a.scene_version == b.scene_version && a.shader_version == b.shader_version && a.moving == b.moving;
}

/// Returns the cursor in shares of the window's width and height.
glm::dvec2 cursor() {
    const ImGuiIO& io = ImGui::GetIO();
    return {io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y};
}

/// Returns the cursor's move in shares of the window's height.
glm::dvec2 cursor_move() {
    const ImGuiIO& io = ImGui::GetIO();
    return glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / static_cast<double>(io.DisplaySize.y);
}

double axis(int less, int more) {
    return (ImGui::IsKeyDown(more) ? 1.0 : 0.0) - (ImGui::IsKeyDown(less) ? 1.0 : 0.0);
}

/// Returns the window's title. Leaves out files that could not be opened.
std::string scans_title(const std::vector<ScanRow>& rows) {
    std::string title;
    size_t open = 0;
    for (const ScanRow& row : rows)
        if (row.state != ScanState::failed && ++open == 1) title = row.name();
    if (open == 0) return "nothing is open";
    if (open > 1) title += fmt::format(" and {} more", open - 1);
    for (const ScanRow& row : rows)
        if (row.state == ScanState::converting)
            title += fmt::format(" - {} {:.0f} %", row.stage, 100 * row.share);
    return title;
}

}  // namespace

double ViewSession::seconds_at_rest() const {
    return std::chrono::duration<double>(Clock::now() - moved_).count();
}

void ViewSession::take_picture() {
    if (!scans_.source()) return;  // the last scan was closed; the worker may not know it yet
    const auto latest = worker_.latest();
    if (!latest || (model_.picture && latest->number == model_.picture->number)) return;
    model_.picture = latest;
    if (latest->moving) {
        quality_.observe(latest->stats.seconds);
        budget_.observe(latest->stats, latest->size);
    }
    model_.scale = quality_.scale();
    model_.health.shaders = latest->shader_problem;
    const uint64_t lost = latest->stats.nodes_lost;
    model_.health.nodes =
        lost == 0 ? "" : fmt::format("left out of the picture: {}", latest->stats.lost_node);
    if (lost > 1) model_.health.nodes += fmt::format(" (and {} more)", lost - 1);
    const bool last_source = scans_.settled() && latest->source == scans_.source();
    const bool whole =
        latest->request == sent_number_ && !latest->moving && latest->stats.nodes_pending == 0 && last_source;
    whole_pictures_ = whole ? latest->stats.accumulated : 0;
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
    for (Bookmark& bookmark : model_.shell.bookmarks) bookmark.texture = 0;
    model_.shell.stale_textures.clear();
    return {};
}

/// Replaces the worker's device if it was lost. The last picture stays meanwhile, and also if no device can
/// be made.
void ViewSession::follow_device() {
    const auto lost = worker_.lost_device();
    if (!lost || given_up_) return;
    const log::Operation::Scope scope{log::Operation()};
    log::warn("{}", lost->line());
    model_.message = lost->why + ": the graphics device is set up again";
    if (tries_.take(Clock::now())) {
        if (auto device = window_.renew_worker_device(Window::Hidden::view))
            return worker_.set_device(std::move(*device));
    }
    given_up_ = true;
    model_.message.clear();
    model_.health.device = fmt::format(
        "There are no more pictures: the graphics device was lost repeatedly ({}). Restart Lucarne.",
        lost->why);
    log::warn("{}", model_.health.device);
}

/// Updates light and camera to the starting view of all open scans, unless the user has changed them.
void ViewSession::take_extent() {
    const auto& start = scans_.start();
    if (!start) return;
    model_.scene_size = start->scene_size();
    model_.box = start->box;
    model_.rig.set_clearance(model_.scene_size);
    const bool first = !std::exchange(placed_, true);
    if (first) model_.navigation.set_scene(start->scene_size(), start->metres_per_unit);
    if (!first && model_.scene_version != own_scene_) return;
    if (!first && start->camera.position == model_.home.position &&
        start->camera.target == model_.home.target)
        return;
    const auto camera = model_.rig.camera();
    const bool at_home = first || (CameraRig(model_.home).camera().position == camera.position &&
                                   CameraRig(model_.home).camera().target == camera.target);
    model_.scene = start->scene;
    model_.home = start->camera;
    if (at_home) model_.go_to(model_.home);
    model_.scene_changed();
    own_scene_ = model_.scene_version;
    model_.light_tools.saved.mark(model_.scene, model_.scene_version);
}

/// Applies changes of the open scans. Starts conversions, one after another, once there is something to see.
void ViewSession::follow_scans() {
    if (scans_.update()) {
        take_extent();
        worker_.set_source(scans_.source());
        if (!scans_.source()) model_.picture = nullptr;
        whole_pictures_ = 0;
    }
    const bool seen = model_.picture && model_.picture->stats.nodes_pending == 0;
    if (seen && !std::exchange(first_told_, true))
        log::info("first picture after {:.2f} s: {} points", seconds_since_start(),
                  model_.picture->stats.view_points);
    if (seen || (!scans_.source() && scans_.settled())) scans_.convert_next();
    window_.set_title("Lucarne - " + scans_title(scans_.rows()));
}

/// Starts and finishes loading of sky pictures that the panel requests.
void ViewSession::follow_sky() {
    LightTools& tools = model_.light_tools;
    if (std::exchange(tools.load_sky, false)) {
        tools.sky_problem.clear();
        skies_.load(tools.sky_image);
    }
    if (auto sky = skies_.take()) {
        if (*sky) {
            model_.scene.environment = std::move(**sky);
            model_.scene.environment_on = true;
            model_.scene_changed();
        } else {
            model_.message = tools.sky_problem = sky->error().line();
        }
    }
    tools.reading_sky = skies_.reading();
}

/// Lets the mouse move the light while Shift is held.
void ViewSession::take_light_gesture() {
    const glm::dvec2 move = cursor_move();
    if (move == glm::dvec2(0.0)) return;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left) && model_.picture) {
        if (const auto point = model_.picture->pick(cursor())) aim_light(model_, *point);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
        shift_light(model_, {move.x, -move.y});
    }
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
        const NavigationMode mode = model_.navigation.mode();
        const bool twice = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
        const bool starts = ImGui::IsMouseClicked(ImGuiMouseButton_Left) ||
                            ImGui::IsMouseClicked(ImGuiMouseButton_Right) ||
                            ImGui::IsMouseClicked(ImGuiMouseButton_Middle);
        const bool goes = io.MouseWheel != 0 && model_.navigation.turns_scene();
        if (model_.picture && (goes || twice || (starts && mode == NavigationMode::orbit)))
            if (const auto point = model_.picture->pick(cursor())) {
                model_.rig.set_pivot(*point);
                if (twice)
                    model_.message =
                        fmt::format("turning around {:.2f} {:.2f} {:.2f}", point->x, point->y, point->z);
            }
        input.rotate = ImGui::IsMouseDown(ImGuiMouseButton_Left);
        input.shift =
            ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle);
        if (!starts) input.drag = cursor_move();
        input.scroll = io.MouseWheel;
    }
    model_.navigation.set_floor(desk_.floor());
    return model_.navigation.apply(input, model_.rig);
}

void ViewSession::take_input() {
    const ImGuiIO& io = ImGui::GetIO();
    if (controller_.take(model_, io.DeltaTime)) moved_ = Clock::now();
    const std::vector<KeyChord> keys = window_.take_pressed_keys();
    // Do not test WantCaptureKeyboard: it is also set while the mouse holds an item, and one frame longer, so
    // keys would be lost.
    if (model_.shell.ask_to_close)
        desk_.answer(keys);
    else if (!io.WantTextInput)
        run_actions(model_, keys);
    if (legend_.take(model_) || take_clip_handles(model_) || take_light_handles(model_)) return;
    measure_.take_input(model_);
    const bool at_light = io.KeyShift && (ImGui::IsMouseDown(ImGuiMouseButton_Left) ||
                                          ImGui::IsMouseDown(ImGuiMouseButton_Right));
    if (at_light && !io.WantCaptureMouse) {
        take_light_gesture();
    } else if (take_navigation()) {
        moved_ = Clock::now();
    }
}

void ViewSession::draw_panels() {
    draw_overlay(model_);
    draw_convergence(model_);
    desk_.draw();
    measure_.draw(model_);
    draw_flythrough(model_);
    draw_side_bar(model_, placed_);
    if (model_.show_help) draw_help(model_);
    if (const auto error = worker_.error(); !error) model_.message = error.error().line();
    draw_message(model_, scans_.source() && (!model_.picture || model_.picture->request != sent_number_));
}

void ViewSession::send_request() {
    // Changes of lights count as motion; changes of display alone do not.
    const uint64_t moves = model_.scene_version - model_.shown_changes;
    if (scene_seen_ != moves && scene_seen_ != 0) moved_ = Clock::now();
    scene_seen_ = moves;
    PictureRequest request;
    request.moving = seconds_at_rest() < kRest;
    request.engine = model_.engine;
    request.settings = model_.settings;
    request.budgets = model_.budgets;
    request.frame.camera = model_.rig.camera();
    request.frame.size = scaled_size(window_.framebuffer(), model_.resolution_scale);
    request.frame.accumulate = !request.moving;
    if (shot_) request.pictures = shot_->pictures;
    request.frame.moving = request.moving;
    if (request.moving) {
        request.frame.size = quality_.size(request.frame.size);
        quality_.reduce(request.settings, request.budgets);
        request.budgets = budget_.budgets(request.budgets);
    }
    request.scene_version = model_.scene_version;
    request.shader_version = model_.health.shader_version;
    if (sent_number_ != 0 && same_request(request, sent_)) return;
    if (request.engine != sent_.engine || !(request.settings == sent_.settings)) budget_.forget();
    request.scene = model_.scene;
    sent_ = request;
    sent_number_ = worker_.request(std::move(request));
    whole_pictures_ = 0;
}

/// Returns a text about an unfinished picture; empty once the picture does not improve further.
std::string ViewSession::unfinished() const {
    if (whole_pictures_ == 0) return ", a first sketch";
    const uint32_t averaged = model_.picture->stats.accumulated;
    return averaged < kMostAccumulated ? fmt::format(", {} of {} averaged", averaged, kMostAccumulated) : "";
}

Result<void> ViewSession::save() {
    if (std::exchange(model_.light_tools.save_scene, false)) {
        save_scene(model_);
        log::info(model_.message);
    }
    if (model_.save_picture && model_.picture) {
        model_.save_picture = false;
        const std::string path = free_name(model_.pictures, "lucarne", {".png"}).string() + ".png";
        const auto saved =
            io::write_png(path, without_alpha(model_.picture->rgba, model_.picture->size), false);
        model_.message = saved ? fmt::format("saved {}{}", path, unfinished()) : saved.error().line();
        log::info(model_.message);
    }
    return save_shot();
}

Result<void> ViewSession::save_shot() {
    const bool nothing = scans_.rows().empty() && scans_.settled();
    idle_frames_ = nothing ? idle_frames_ + 1 : 0;
    if (!shot_ || (whole_pictures_ < shot_->pictures && idle_frames_ < kIdleFrames)) return {};
    model_.close = true;
    return io::write_png(shot_->file, without_alpha(window_.capture(), window_.framebuffer()),
                         shot_->overwrite);
}

Result<void> ViewSession::run() {
    auto done = guarded("window", [&] { return show_until_closed(); });
    if (!done) {
        if (const auto saved = save_unsaved(model_, SaveTo::free_names); !saved)
            log::warn("{}", saved.error().line());
        return done;
    }
    log::info("window: {} frames, each {:.1f} ms, 95 % of the last ones within {:.1f} ms",
              model_.health.frames.frames(), 1e3 * model_.health.frames.quantile(0.5),
              1e3 * model_.health.frames.quantile(0.95));
    window_.hide();
    return {};
}

Result<void> ViewSession::show_until_closed() {
    Clock::time_point awake = Clock::now();
    while (!desk_.closing(shot_.has_value())) {
        if (interrupt_.requested()) return save_unsaved(model_, SaveTo::free_names);
        const bool lively = seconds_at_rest() < 2 * kRest || ImGui::IsAnyMouseDown();
        // The interval counts from one frame's start to the next one's, so that a frame's own time is not
        // added.
        const double since = std::chrono::duration<double>(Clock::now() - awake).count();
        window_.wait((lively ? kStep : kRest) - since);
        awake = Clock::now();
        LUCARNE_TRY(recover());
        take_picture();
        window_.set_text_size(model_.shell.settings.text_size);
        window_.begin_frame();
        if (model_.picture) window_.show(*model_.picture);
        desk_.take_files();
        follow_scans();
        follow_sky();
        take_input();
        if (show_.follow(model_, scans_.source())) moved_ = Clock::now();
        draw_panels();
        const bool drawn = window_.draw(shot_.has_value());
        LUCARNE_TRY(save());
        if (drawn) window_.swap();
        send_request();
        if (drawn) model_.health.frames.add(std::chrono::duration<double>(Clock::now() - awake).count());
        if (!shot_) continue;
        if (given_up_) return tl::make_unexpected(*worker_.lost_device());
        LUCARNE_TRY(worker_.error());
        LUCARNE_TRY(scans_.error());
    }
    return {};
}

}  // namespace lucarne::viewer
