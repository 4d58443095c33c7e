#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

/// Decides what SIGINT, SIGTERM and SIGHUP do with files and folders that have a name but are unfinished.
namespace lucarne {

/// Removes the file or folder, or keeps it and returns a line that says so. The action runs on a thread of
/// its own while the other threads continue, so it must hold copies of everything that it uses.
using InterruptAction = std::function<std::string()>;

/// Sets what an interrupt does with `unfinished`. Replaces an earlier action for the same path.
void at_interrupt(const std::filesystem::path& unfinished, InterruptAction action);
/// Removes the action of a path. Call it once the file or folder is finished or removed.
void forget_interrupt(const std::filesystem::path& unfinished);

/// After this call the three signals run all actions, print their lines and then end the program as usual. A
/// signal that is ignored (nohup) stays ignored. A second signal ends the program at once. Call it in main
/// before any thread is started: one thread receives the signals, and all other threads must inherit a mask
/// that blocks them.
void handle_interrupts();

/// While an object lives, the first of the signals does not end the program. Instead requested() reports it,
/// so that a window can save its work and close. A second signal ends the program as usual. Only one object
/// may exist at a time.
class InterruptRequest {
 public:
    InterruptRequest();
    ~InterruptRequest();
    InterruptRequest(const InterruptRequest&) = delete;
    InterruptRequest& operator=(const InterruptRequest&) = delete;

    /// Returns whether a signal has asked the program to end.
    bool requested() const { return requested_; }

 private:
    friend bool hand_over_interrupt();
    std::atomic<bool> requested_ = false;
};

}  // namespace lucarne
