#include "io/core/interrupt.h"

#include <csignal>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "io/core/log.h"
#include "io/core/progress.h"

namespace lucarne {
namespace {

/// There is one object for the whole process, because signals belong to the process.
struct Actions {
    std::mutex mutex;
    std::map<std::filesystem::path, InterruptAction> of;
    InterruptRequest* request = nullptr;  ///< takes the first signal
};
Actions& actions() {
    static auto* all = new Actions;  // outlives every other static object: their destructors may use it
    return *all;
}

void run_actions() {
    auto& all = actions();
    all.mutex.lock();  // never unlocked: from here on no file may be finished or begun
    for (const auto& [unfinished, action] : all.of) {
        const std::string line = action();
        if (line.empty()) continue;
        Progress::end_line();
        log::warn("{}", line);
    }
}

}  // namespace

/// Returns whether an InterruptRequest takes the signal, in which case the program goes on.
bool hand_over_interrupt() {
    const std::lock_guard lock(actions().mutex);
    InterruptRequest* request = actions().request;
    return request && !request->requested_.exchange(true);
}

void at_interrupt(const std::filesystem::path& unfinished, InterruptAction action) {
    const std::lock_guard lock(actions().mutex);
    actions().of[unfinished] = std::move(action);
}

void forget_interrupt(const std::filesystem::path& unfinished) {
    const std::lock_guard lock(actions().mutex);
    actions().of.erase(unfinished);
}

void handle_interrupts() {
    sigset_t caught;
    sigemptyset(&caught);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now {};
        if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaddset(&caught, number);
    }
    ::pthread_sigmask(SIG_BLOCK, &caught, nullptr);
    const auto receive = [caught] {
        int number = SIGTERM;
        do {
            if (::sigwait(&caught, &number) != 0) return;
        } while (hand_over_interrupt());
        ::pthread_sigmask(SIG_UNBLOCK, &caught, nullptr);
        run_actions();
        ::raise(number);
    };
    try {
        std::thread(receive).detach();
    } catch (const std::system_error&) {  // without a thread the signals end the program
        ::pthread_sigmask(SIG_UNBLOCK, &caught, nullptr);
    }
}

InterruptRequest::InterruptRequest() {
    const std::lock_guard lock(actions().mutex);
    actions().request = this;
}

InterruptRequest::~InterruptRequest() {
    const std::lock_guard lock(actions().mutex);
    actions().request = nullptr;
}

}  // namespace lucarne
