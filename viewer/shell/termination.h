#pragma once

#include <csignal>

namespace lucarne::viewer {

/// While this lives SIGTERM does not end the program: it waits until requested() takes it, so that the window can save
/// what is in no file. To be made before other threads, which inherit it.
class Termination {
 public:
    Termination();
    ~Termination();
    Termination(const Termination&) = delete;
    Termination& operator=(const Termination&) = delete;

    /// Whether the program was told to end since the last call.
    bool requested();

 private:
    sigset_t signals_{}, before_{};
};

}  // namespace lucarne::viewer
