#include "viewer/window/closing.h"

#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "io/core/log.h"
#include "viewer/scans/scan_set.h"
#include "viewer/window/unsaved.h"

namespace lucarne::viewer {

/// Returns why the user must be asked before closing; empty if nothing would be lost.
std::string Closing::reason_to_ask() {
    std::string all;
    model_.closing.kept = keep_();
    for (const Unsaved& one : work_to_lose(model_)) all += (all.empty() ? "not saved: " : ", ") + one.what;
    const auto add = [&](std::string_view reason) { all += (all.empty() ? "" : "; ") + std::string(reason); };
    if (model_.publish.rendering.running) add("a picture or flight is being rendered");
    if (model_.exporting.running) add("points are being exported");
    if (model_.scans->converting()) add("a scan is being converted");
    return all;
}

bool Closing::agreed(bool at_once) {
    ClosingQuestion& question = model_.closing;
    bool now = false;
    const Overloaded run{
        [&](const SaveAndClose&) {
            const auto saved = save_unsaved(model_);
            question.problem = saved ? "" : saved.error().line();
            now |= saved.has_value();
        },
        [&](const DiscardAndClose&) { now = true; },
    };
    for (const auto& answer : question.answers.take()) std::visit(run, answer);
    if (now) return true;
    if (!std::exchange(requested_, false) && !window_.closing()) return false;
    const std::string reason = at_once ? "" : reason_to_ask();
    if (reason.empty()) return true;
    window_.stay();
    question.problem.clear();
    if (!std::exchange(question.shown, true)) log::info("{}: asked whether to close anyway", reason);
    return false;
}

void Closing::answer(std::span<const KeyChord> keys) {
    ClosingQuestion& question = model_.closing;
    for (const KeyChord& chord : keys) {
        if (!question.shown) return;
        const bool enter = chord.key == GLFW_KEY_ENTER || chord.key == GLFW_KEY_KP_ENTER;
        const bool save = enter && !work_to_lose(model_).empty();
        const bool discard = chord.key == GLFW_KEY_D && chord.modifiers == GLFW_MOD_CONTROL;
        if (chord.key == GLFW_KEY_ESCAPE) question.shown = false;
        if (save) question.answers.push(SaveAndClose{});
        if (discard || (enter && !save)) question.answers.push(DiscardAndClose{});
    }
}

}  // namespace lucarne::viewer
