#pragma once

#include <string>

#include "io/formats/scan.h"
#include "tests/fuzz/fuzz.h"
#include "tests/temporary_folder.h"

// What every fuzzer of a scan format does: opens the scan, reads it to the end, writes what was read in every
// format; and then reads it again with `salvage`.
namespace lucarne::fuzz {

/// Reading stops after so many points: by then the reader has accepted the file, and a few KiB may hold
/// millions.
inline constexpr size_t kMostPoints = 200'000;

inline void write_unfinished(const io::PointSource& source, std::span<const std::byte> records,
                             const char* extension) {
    static const test::Folder folder;
    const auto path = folder / (std::string("scan") + extension);
    const auto writer = io::create_scan(path, source.schema(), source.info(), {});
    if (writer) (void)(*writer)->write(records);
}

inline void read_and_write(std::shared_ptr<const ByteSource> file, bool salvage) {
    const auto source =
        io::open_scan(std::move(file), {"", true, {0, 500, false}, salvage});  // few samples of a mesh
    if (!source) return;
    const auto reader = (*source)->open();
    if (!reader) return;
    io::PointBatch batch;
    for (size_t points = 0; points < kMostPoints; points += batch.count) {
        const auto got = (*reader)->read(batch, 1000);
        if (!got || *got == 0) break;
        if (points > 0) continue;
        const auto records = std::span<const std::byte>(batch.bytes).first(*got * (*source)->schema().stride);
        for (const char* extension : {".las", ".laz", ".ply", ".pcd", ".csv"})
            write_unfinished(**source, records, extension);
    }
}

/// Runs this on a file with these bytes.
inline bool scan(std::string_view bytes) {
    const auto file = memory_source(bytes);
    for (const bool salvage : {false, true}) read_and_write(file, salvage);
    return true;
}

/// The same with `magic` in place of the first bytes, so that every input reaches the format's own parser.
inline bool scan(std::string_view magic, const uint8_t* data, size_t size) {
    if (size < magic.size()) return false;
    std::string bytes(reinterpret_cast<const char*>(data), size);
    return scan(bytes.replace(0, magic.size(), magic));
}

}  // namespace lucarne::fuzz
