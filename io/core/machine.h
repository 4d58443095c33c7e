#pragma once

#include <cstdint>
#include <string>

namespace lucarne {

/// What the program was built from and with, as recorded when the build was configured.
struct BuildInfo {
    std::string version,
        revision;  ///< "0.1.0"; git's short hash with "-dirty" after it if there were changes, or "unknown"
    std::string compiler, type, flags;
};
BuildInfo build_info();

/// The machine that the program runs on, as its kernel describes it. Unknown entries are empty or 0.
struct MachineInfo {
    std::string processor;  ///< "Intel(R) Xeon(R) ..."
    unsigned cores = 0;     ///< cores that this process may use
    uint64_t memory = 0;    ///< bytes
    std::string system;     ///< "Linux 6.1.0 x86_64"
};
MachineInfo machine_info();

}  // namespace lucarne
