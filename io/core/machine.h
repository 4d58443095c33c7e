#pragma once

#include <cstdint>
#include <string>

namespace lucarne {

/// What this program was built from and with, as it was when the build was configured.
struct BuildInfo {
    std::string version,
        revision;  ///< "0.1.0"; git's short hash, "-dirty" behind it with changes, or "unknown"
    std::string compiler, type, flags;
};
BuildInfo build_info();

/// The machine that the program runs on, as its kernel describes it; what is not said is empty or 0.
struct MachineInfo {
    std::string processor;  ///< "Intel(R) Xeon(R) ..."
    unsigned cores = 0;     ///< that this process may use
    uint64_t memory = 0;    ///< bytes
    std::string system;     ///< "Linux 6.1.0 x86_64"
};
MachineInfo machine_info();

}  // namespace lucarne
