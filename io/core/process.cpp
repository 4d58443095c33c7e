#include "io/core/process.h"

#include <fstream>

#include <unistd.h>

namespace lucarne {

uint64_t resident_memory() {
    std::ifstream statm("/proc/self/statm");  // pages: of the whole address space, resident, ... (proc(5))
    uint64_t all = 0, resident = 0;
    if (!(statm >> all >> resident)) return 0;
    return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace lucarne
