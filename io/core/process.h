#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <spawn.h>

namespace lucarne {

/// Returns the resident memory of this process in bytes, as the kernel counts it; 0 where it does not say.
uint64_t resident_memory();

/// Lowers the priority of the calling thread and of the threads that it starts afterwards: while another
/// thread of the program wants the same processor, they get a quarter of it. For background work that must
/// not delay the answer to a user's input.
void give_way();

/// Returns the seconds since this process was started (before main), to a hundredth of a second; 0 where the
/// kernel does not say.
double seconds_since_start();

/// Returns whether a folder in $PATH holds a program of this name that can be run.
bool program_installed(const std::string& program);

/// Starts the program `words[0]`, searched in $PATH. The other words are its arguments; no signal is blocked
/// in it. Returns 0 and sets `pid` to the new process, or returns an errno.
int spawn(const std::vector<std::string>& words, const posix_spawn_file_actions_t& actions, pid_t& pid);

}  // namespace lucarne
