#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lucarne::io::e57 {

/// Computes CRC-32C (Castagnoli 1993, polynomial 0x1EDC6F41 reflected), with SSE4.2 where the processor has
/// it.
uint32_t crc32c(std::span<const std::byte> bytes);
/// The same with a table, for processors without SSE4.2. Public so that a test can compare the two.
uint32_t crc32c_by_table(std::span<const std::byte> bytes);

}  // namespace lucarne::io::e57
