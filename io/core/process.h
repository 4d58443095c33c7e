#pragma once

#include <cstdint>

namespace lucarne {

/// Memory of this process that is resident, bytes, as the kernel counts it; 0 where it does not say.
uint64_t resident_memory();

}  // namespace lucarne
