#include "viewer/window/undo_history.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "viewer/window/view_model.h"

namespace lucarne::viewer {
namespace {

/// Calls `visit` with each pair of parts that differ.
template <class Visit>
void each_difference(UndoState& a, UndoState& b, const Visit& visit) {
    const auto of_a = a.parts(), of_b = b.parts();
    [&]<size_t... I>(std::index_sequence<I...>) {
        ((std::get<I>(of_a) != std::get<I>(of_b)
              ? visit(std::integral_constant<size_t, I>{}, std::get<I>(of_b))
              : void()),
         ...);
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(a.parts())>>{});
}

/// Names a change of a list: "light added". `change`: the word for a list of unchanged length.
std::string list_change(const char* what, size_t before, size_t after, const char* change) {
    return fmt::format("{} {}", what, after > before ? "added" : after < before ? "deleted" : change);
}

const char* change_of(const std::vector<gi::SceneLight>& before, std::vector<gi::SceneLight> after) {
    for (size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
        after[i].position = before[i].position;
        after[i].target = before[i].target;
    }
    return before == after ? "moved" : "changed";
}

const char* change_of(const gi::Clip& before, gi::Clip after) {
    if (before.casts != after.casts) return "changed";
    for (size_t i = 0; i < std::min(before.boxes.size(), after.boxes.size()); ++i)
        if (before.boxes[i].inverted != after.boxes[i].inverted) return "changed";
    for (size_t i = 0; i < std::min(before.planes.size(), after.planes.size()); ++i)
        if (before.planes[i].inverted != after.planes[i].inverted) return "changed";
    return "moved";
}

/// Names a step for the user.
std::string name_of(const UndoState& a, const UndoState& b) {
    if (a.measurements != b.measurements)
        return list_change("measurement", a.measurements->size(), b.measurements->size(), "changed");
    if (a.flythrough != b.flythrough)
        return list_change("key frame", a.flythrough->keys.size(), b.flythrough->keys.size(), "changed");
    if (a.mood != b.mood && b.mood) return "mood changed";
    const bool lights = a.lights != b.lights, clip = a.clip != b.clip;
    if (lights && clip) return "scene changed";
    if (lights) return list_change("light", a.lights.size(), b.lights.size(), change_of(a.lights, b.lights));
    const auto shapes = [](const gi::Clip& c) { return c.boxes.size() + c.planes.size(); };
    if (clip) return list_change("clip", shapes(a.clip), shapes(b.clip), change_of(a.clip, b.clip));
    if (a.look != b.look) return "appearance changed";
    if (a.sky != b.sky || a.sky_on != b.sky_on || a.background != b.background) return "sky changed";
    if (a.materials != b.materials) return "materials changed";
    if (a.comparison != b.comparison) return "comparison changed";
    if (a.engine != b.engine) return "lighting changed";
    if (a.albedo != b.albedo) return "albedo changed";
    return "exposure changed";
}

}  // namespace

UndoState UndoHistory::state_of(ViewModel& model) {
    const gi::Scene& scene = model.view.scene;
    UndoState state;
    state.lights = scene.lights;
    state.mood = model.lights.mood;
    state.materials = scene.materials;
    state.sky = scene.environment;
    state.sky_on = scene.environment_on;
    state.background = scene.background;
    state.albedo = scene.albedo;
    state.clip = scene.look.clip;
    state.look = scene.look;
    state.look.clip = {};
    state.exposure_ev = scene.exposure_ev;
    state.tone_map = scene.tone_map;
    state.white = scene.white;
    state.luminance = scene.luminance;
    state.comparison = scene.comparison;
    state.engine = model.view.method.engine;
    state.measurements = model.measure.list.state();
    state.flythrough = model.publish.editor.state();
    return state;
}

void UndoHistory::restart(ViewModel& model) {
    now_ = state_of(model);
    metres_per_unit_ = model.measure.metres_per_unit;
    done_.clear();
    undone_.clear();
}

void UndoHistory::accept(UndoState& before, UndoState after) {
    if (!now_) return;
    auto parts = now_->parts();
    each_difference(before, after, [&](auto i, auto& value) { std::get<i>(parts) = value; });
}

void UndoHistory::follow(ViewModel& model) {
    if (!now_ || metres_per_unit_ != model.measure.metres_per_unit) return restart(model);
    UndoState state = state_of(model);
    if (state == *now_) return;
    std::string what = name_of(*now_, state);
    done_.push_back({std::move(*now_), state, std::move(what)});
    now_ = std::move(state);
    undone_.clear();
    limit();
}

/// Drops the oldest steps of a history that is too large.
void UndoHistory::limit() {
    const auto too_large = [&] {
        std::set<const gi::Environment*> skies;
        for (const Step& step : done_) skies.insert({step.before.sky.get(), step.after.sky.get()});
        size_t bytes = 0;
        for (const gi::Environment* sky : skies)
            if (sky) bytes += sky->texels.size() * sizeof sky->texels.front();
        return done_.size() > kMostSteps || bytes > kMostSkyBytes;
    };
    while (!done_.empty() && too_large()) done_.erase(done_.begin());
}

/// Makes the model's parts that differ in `from` and `to` those of `to`.
void UndoHistory::change(ViewModel& model, UndoState& from, UndoState& to) {
    UndoState state = state_of(model);
    auto parts = state.parts();
    each_difference(from, to, [&](auto i, auto& value) { std::get<i>(parts) = value; });
    gi::Scene& scene = model.view.scene;
    const bool drawn = from.measurements == to.measurements && from.flythrough == to.flythrough;
    scene.lights = state.lights;
    model.lights.mood = state.mood;
    scene.materials = state.materials;
    scene.environment = state.sky;
    scene.environment_on = state.sky_on;
    scene.background = state.background;
    scene.albedo = state.albedo;
    scene.look = state.look;
    scene.look.clip = state.clip;
    scene.exposure_ev = state.exposure_ev;
    scene.tone_map = state.tone_map;
    scene.white = state.white;
    scene.luminance = state.luminance;
    scene.comparison = state.comparison;
    model.view.method.engine = state.engine;
    model.measure.list.become(state.measurements);
    model.publish.editor.become(state.flythrough);
    model.lights.selected = std::min(model.lights.selected, scene.lights.size());
    if (!model.measure.selected_one()) model.measure.selected.reset();
    if (from.mood != to.mood)
        model.view.light_replaced();
    else if (drawn)
        model.view.scene_changed();
    now_ = std::move(state);
}

void UndoHistory::step(ViewModel& model, std::vector<Step>& from, std::vector<Step>& to, bool back) {
    follow(model);
    if (from.empty()) return;
    Step step = std::move(from.back());
    from.pop_back();
    change(model, back ? step.after : step.before, back ? step.before : step.after);
    model.view.message = (back ? "Undone: " : "Redone: ") + step.what;
    to.push_back(std::move(step));
}

}  // namespace lucarne::viewer
