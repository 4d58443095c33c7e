#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lucarne::io::e57 {

/// CRC-32C (Castagnoli 1993, polynomial 0x1EDC6F41 reflected), by SSE4.2 where the processor has it.
uint32_t crc32c(std::span<const std::byte> bytes);
/// The same by table, for processors without; public so that both can be held side by side.
uint32_t crc32c_by_table(std::span<const std::byte> bytes);

}  // namespace lucarne::io::e57
