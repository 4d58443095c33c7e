#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "io/formats/scan.h"

// What every fuzzer of a scan format does: open, read to the end, write what was read in every format.
namespace lucarne::io {

inline void write_unfinished(const PointSource& source, std::span<const std::byte> records,
                             const char* extension) {
    const auto path = std::filesystem::temp_directory_path() / (std::string("lucarne-fuzz") + extension);
    const auto writer = create_scan(path, source.schema(), source.info(), {});
    if (writer) (void)(*writer)->write(records);
}

/// `magic` replaces the first bytes, so that every input reaches the format's own parser.
inline int fuzz_scan(std::string_view magic, const uint8_t* data, size_t size) {
    static const int file = memfd_create("lucarne-fuzz", MFD_CLOEXEC);
    if (size < magic.size() || ftruncate(file, 0) != 0) return -1;
    if (pwrite(file, data, size, 0) < 0 || pwrite(file, magic.data(), magic.size(), 0) < 0) return -1;
    const auto source = open_scan("/proc/self/fd/" + std::to_string(file), {"", true});
    if (!source) return 0;
    const auto reader = (*source)->open();
    PointBatch batch;
    for (bool first = true;; first = false) {
        const auto got = (*reader)->read(batch, 1000);
        if (!got || *got == 0) return 0;
        if (!first) continue;
        const auto records = std::span<const std::byte>(batch.bytes).first(*got * (*source)->schema().stride);
        write_unfinished(**source, records, ".las");
        write_unfinished(**source, records, ".ply");
        write_unfinished(**source, records, ".pcd");
    }
}

}  // namespace lucarne::io
