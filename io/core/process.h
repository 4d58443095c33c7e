#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <spawn.h>

namespace lucarne {

/// Memory of this process that is resident, bytes, as the kernel counts it; 0 where it does not say.
uint64_t resident_memory();

/// The calling thread, and those it starts from then on, take a quarter of a processor while another of the
/// program's wants it as well. For work that must not hold up what answers a person.
void give_way();

/// Since this process was started, before main: to a hundredth of a second; 0 where the kernel does not say.
double seconds_since_start();

/// Whether a program of this name can be run from one of the folders in $PATH.
bool program_installed(const std::string& program);

/// Starts `words[0]`, looked for in $PATH, with the other words as its arguments and no signal blocked.
/// Returns 0 or an errno; `pid` is the new process.
int spawn(const std::vector<std::string>& words, const posix_spawn_file_actions_t& actions, pid_t& pid);

}  // namespace lucarne
