#include "io/core/log.h"

#include <functional>
#include <mutex>
#include <set>
#include <string>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "io/core/log_silence.h"
#include "io/core/terminal.h"

namespace lucarne::log {

/// The warnings that an operation has printed. When there are very many, older ones are forgotten.
struct Said {
    std::mutex mutex;
    std::set<std::string, std::less<>> lines;

    bool is_new(const std::string& line) {
        constexpr size_t kMostKept = 1000;
        const std::lock_guard lock(mutex);
        if (lines.size() >= kMostKept) lines.clear();
        return lines.insert(line).second;
    }
};

namespace {

/// The printed warnings of the calling thread's operation; null where the thread is in none.
std::shared_ptr<Said>& said_by_thread() {
    thread_local std::shared_ptr<Said> said;
    return said;
}

bool& hushed() {
    thread_local bool hushed = false;
    return hushed;
}

spdlog::logger& logger() {
    static const auto instance = [] {
        auto made = std::make_shared<spdlog::logger>("lucarne",
                                                     std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        made->set_pattern("lucarne: %^%v%$");
        return made;
    }();
    return *instance;
}

constexpr size_t kMostBytes = 2000;  ///< of a line; a name in a file may be of any length

}  // namespace

void info(std::string_view text) {
    logger().info("{}", shown(text, kMostBytes));
}
void warn(std::string_view text) {
    if (hushed()) return;
    const std::string line = shown(text, kMostBytes);
    const auto& said = said_by_thread();
    if (!said || said->is_new(line)) logger().warn("{}", line);
}
void set_quiet(bool quiet) {
    logger().set_level(quiet ? spdlog::level::warn : spdlog::level::info);
}
void set_silent(bool silent) {
    logger().set_level(silent ? spdlog::level::off : spdlog::level::info);
}

Hush::Hush() : before_(std::exchange(hushed(), true)) {}
Hush::~Hush() {
    hushed() = before_;
}

Operation::Operation() : said_(std::make_shared<Said>()) {}

Operation Operation::current() {
    return Operation(said_by_thread());
}

Operation::Scope::Scope(const Operation& operation)
    : before_(std::exchange(said_by_thread(), operation.said_)) {}

Operation::Scope::~Scope() {
    said_by_thread() = std::move(before_);
}

}  // namespace lucarne::log
