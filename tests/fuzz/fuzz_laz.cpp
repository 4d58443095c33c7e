#include "tests/fuzz/fuzz_scan.h"

/// Always sets the bit of the point format that means compressed.
bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    constexpr size_t kPointFormat = 104;
    if (size <= kPointFormat) return false;
    std::string bytes(reinterpret_cast<const char*>(data), size);
    bytes.replace(0, 4, "LASF");
    bytes[kPointFormat] = static_cast<char>(bytes[kPointFormat] | 0x80);
    return scan(bytes);
}
