#pragma once

#include <array>
#include <cstddef>
#include <deque>

namespace lucarne::viewer {

/// Keeps the mouse's events in their order and gives each frame at most one of them: a motion, or a change of
/// one button where it happened. Dear ImGui 1.86 samples the mouse once a frame, so a press and the motion
/// after it, when both came during one slow frame, would otherwise act at the motion's end. Main thread.
class PointerInput {
 public:
    static constexpr size_t kButtons = 5;  ///< as many as ImGui has

    struct State {
        double x = 0, y = 0;  ///< units of the window, y downward
        std::array<bool, kButtons> down{};
        /// Whether a press in this frame may have come soon enough after the last one to make a double-click.
        bool soon = false;
    };

    /// When a button changed, seconds on any clock. A frame that takes long receives the event late, so only
    /// an interval is known.
    struct Time {
        double earliest = 0, latest = 0;
    };

    void move(double x, double y);
    void set_button(size_t button, bool down, const Time& time);

    /// Whether events wait for the next frame.
    bool pending() const { return !events_.empty(); }
    /// Advances by one event and returns the state for a frame.
    const State& next();
    /// Forgets all events and releases all buttons.
    void clear();

 private:
    struct Event {
        double x = 0, y = 0;
        size_t button = kButtons;  ///< kButtons: a motion alone
        bool down = false;
        Time time;
    };
    void push(const Event& event);

    std::deque<Event> events_;
    double x_ = 0, y_ = 0;  ///< where the last event left the mouse
    State state_;
    double pressed_at_ = -1e9;
};

}  // namespace lucarne::viewer
