#include "io/core/machine.h"

#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

namespace lucarne {
namespace {

/// Returns the value of the first line of /proc/cpuinfo that begins with `key`.
std::string cpuinfo(const std::string& key) {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(key)) continue;
        const size_t colon = line.find(':');
        if (colon == std::string::npos || colon + 2 > line.size()) continue;
        return line.substr(colon + 2);
    }
    return {};
}

unsigned usable_cores() {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return static_cast<unsigned>(CPU_COUNT(&set));
    return std::thread::hardware_concurrency();
}

}  // namespace

BuildInfo build_info() {
    // CMakeLists.txt defines these macros for this file.
    return {LUCARNE_VERSION, LUCARNE_REVISION, LUCARNE_COMPILER, LUCARNE_BUILD_TYPE, LUCARNE_BUILD_FLAGS};
}

MachineInfo machine_info() {
    MachineInfo info;
    info.processor = cpuinfo("model name");
    info.cores = usable_cores();
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0) info.memory = static_cast<uint64_t>(pages) * static_cast<uint64_t>(page);
    utsname name{};
    if (uname(&name) == 0) info.system = fmt::format("{} {} {}", name.sysname, name.release, name.machine);
    return info;
}

}  // namespace lucarne
