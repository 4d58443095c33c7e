#pragma once

#include <cstdint>
#include <string>

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

}  // namespace lucarne
