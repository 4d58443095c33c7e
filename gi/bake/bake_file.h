#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "gi/bake/precomputation.h"
#include "io/files/byte_source.h"

namespace lucarne::gi {

/// Says what a bake file contains.
struct BakeHeader {
    std::string engine;    ///< its name
    uint32_t version = 0;  ///< Precomputes::version
    uint64_t key = 0;      ///< bake_key()
    double share = 0;      ///< the finished share, 0..1
    bool operator==(const BakeHeader&) const = default;
};

/// A bake file's content. gi/bake/README.md describes its bytes.
struct BakeFile {
    BakeHeader header;
    BakeSections sections;
};

/// Writes a bake file, whole or not at all, over an older one. Errors: it cannot be written; a section's name
/// is longer than 64 bytes.
Result<void> write_bake(const std::filesystem::path& path, const BakeFile& bake);

/// Read a bake file, or what it contains. Every size is checked against the file and `most_bytes` before
/// memory is asked for. Errors: unreadable, no bake file, another version of the format, damaged, larger than
/// `most_bytes` when unpacked.
Result<BakeFile> read_bake(const ByteSource& file, uint64_t most_bytes);
Result<BakeHeader> read_bake_header(const ByteSource& file);
Result<BakeHeader> read_bake_header(const std::filesystem::path& path);

/// Returns the name of an engine's bake beside its cache: "scan.luc.paths.bake" for "scan.luc".
std::filesystem::path bake_beside(const std::filesystem::path& cache, std::string_view engine);
/// Returns where the bake of an engine is kept for a cache: beside it, else in the user's cache folder under
/// a name made of the cache's path, which is created. Empty if neither can be written.
std::filesystem::path bake_place(const std::filesystem::path& cache, std::string_view engine);

}  // namespace lucarne::gi
