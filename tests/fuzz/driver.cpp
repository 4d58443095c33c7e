// The entry point of every fuzzer. libFuzzer's own limits count wall-clock time, which grows on a busy
// machine; these count processor time.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"

namespace lucarne::fuzz {
namespace {

/// Readers must refuse a bad file within a second. AddressSanitizer with UndefinedBehaviorSanitizer makes
/// them about five times slower, each input is read twice, and on a busy machine the same work takes more
/// than twice as much processor time (README.md).
constexpr double kMostSeconds = 30;

double cpu_seconds() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// A function of its own, so that the finding has a name in the report.
[[noreturn]] void refused_too_late() {
    std::abort();
}

/// Writes what the slowest input took, in seconds of CPU, to the file LUCARNE_FUZZ_SLOWEST.
void report_slowest(double seconds) {
    const char* path = std::getenv("LUCARNE_FUZZ_SLOWEST");
    if (path) std::ofstream(path) << seconds << '\n';
}

/// Returns LUCARNE_FUZZ_CPU: the fuzzer ends after so many seconds. 0 or unset means never.
double whole_seconds() {
    const char* text = std::getenv("LUCARNE_FUZZ_CPU");
    return text ? std::strtod(text, nullptr) : 0;
}

}  // namespace

std::optional<std::filesystem::path> memory_file(std::string_view bytes) {
    static const int file = memfd_create("lucarne-fuzz", MFD_CLOEXEC);
    if (ftruncate(file, 0) != 0) return std::nullopt;
    if (pwrite(file, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        return std::nullopt;
    return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace lucarne::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace lucarne::fuzz;
    static const double whole = whole_seconds();
    static double slowest = 0;
    const double begin = cpu_seconds();
    const bool useful = run(data, size);
    const double end = cpu_seconds();
    if (end - begin > kMostSeconds) refused_too_late();
    slowest = std::max(slowest, end - begin);
    if (whole > 0 && end > whole) {
        report_slowest(slowest);
        std::raise(SIGUSR1);  // libFuzzer ends and prints its figures
    }
    return useful ? 0 : -1;
}
