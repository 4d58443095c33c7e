#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

/// What SIGINT, SIGTERM and SIGHUP do with files and folders that have a name while they are unfinished.
namespace lucarne {

/// Removes the file or folder, or keeps it and returns a line that says so. Runs on a thread of its own while
/// the others go on: it must hold copies of all that it uses.
using InterruptAction = std::function<std::string()>;

/// Sets what an interrupt does with `unfinished`, in place of what was set before.
void at_interrupt(const std::filesystem::path& unfinished, InterruptAction action);
/// Forgets the action of a path that is finished or removed.
void forget_interrupt(const std::filesystem::path& unfinished);

/// From now on the three signals run all actions, print their lines and then end the program as usual. A
/// signal that is ignored (nohup) stays ignored; a second signal ends the program at once. Call it in main
/// before any thread is started: a thread of its own receives the signals, and all others must inherit that
/// they are blocked.
void handle_interrupts();

/// Takes the first of the signals instead of ending the program: requested() reports it, so that a window can
/// save its work and close. A second signal ends the program as usual. Only one object may exist at a time.
class InterruptRequest {
 public:
    InterruptRequest();
    ~InterruptRequest();
    InterruptRequest(const InterruptRequest&) = delete;
    InterruptRequest& operator=(const InterruptRequest&) = delete;

    /// Whether a signal has asked the program to end.
    bool requested() const { return requested_; }

 private:
    friend bool hand_over_interrupt();
    std::atomic<bool> requested_ = false;
};

}  // namespace lucarne
