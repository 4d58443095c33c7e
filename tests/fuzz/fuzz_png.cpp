#include <string>

#include <zlib.h>

#include "io/image/image.h"
#include "tests/fuzz/fuzz.h"

namespace {

uint32_t big_endian(const std::string& bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
    return value;
}

/// Corrects the checksum of every chunk, as long as chunks follow one another.
void reseal(std::string& bytes) {
    for (size_t at = 8; at + 12 <= bytes.size();) {
        const uint64_t length = big_endian(bytes, at);
        if (length > bytes.size() - at - 12) return;
        const uLong sum =
            crc32(0, reinterpret_cast<const Bytef*>(&bytes[at + 4]), static_cast<uInt>(length + 4));
        for (size_t i = 0; i < 4; ++i) bytes[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
        at += 12 + length;
    }
}

}  // namespace

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    std::string bytes(reinterpret_cast<const char*>(data), size);
    reseal(bytes);
    const auto path = memory_file(bytes);
    if (path) (void)io::read_png(*path);
    return path.has_value();
}
