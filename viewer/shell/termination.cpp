#include "viewer/shell/termination.h"

#include <ctime>

namespace lucarne::viewer {

Termination::Termination() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

Termination::~Termination() {
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool Termination::requested() {
    constexpr timespec kAtOnce{0, 0};
    return sigtimedwait(&signals_, nullptr, &kAtOnce) == SIGTERM;
}

}  // namespace lucarne::viewer
