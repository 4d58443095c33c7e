#include "viewer/window/pointer_input.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostEvents = 64;    // that wait; beyond it the oldest is skipped
constexpr double kDoubleClick = 0.3;  // s between presses, as ImGui has it

}  // namespace

void PointerInput::push(const Event& event) {
    if (events_.size() == kMostEvents) next();
    events_.push_back(event);
}

void PointerInput::move(double x, double y) {
    x_ = x, y_ = y;
    // Motions that follow each other become one; a path between two frames is not needed.
    if (!events_.empty() && events_.back().button == kButtons)
        events_.back() = {x, y};
    else
        push({x, y});
}

void PointerInput::set_button(size_t button, bool down, const Time& time) {
    if (button < kButtons) push({x_, y_, button, down, time});
}

const PointerInput::State& PointerInput::next() {
    state_.soon = false;
    if (events_.empty()) return state_;
    const Event event = events_.front();
    events_.pop_front();
    state_.x = event.x, state_.y = event.y;
    if (event.button == kButtons) return state_;
    state_.down[event.button] = event.down;
    if (event.down) {
        state_.soon = event.time.earliest - pressed_at_ < kDoubleClick;
        pressed_at_ = event.time.latest;
    }
    return state_;
}

void PointerInput::clear() {
    events_.clear();
    state_.down = {};
}

}  // namespace lucarne::viewer
