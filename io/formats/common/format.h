#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/files/file.h"
#include "io/formats/scan.h"

namespace lucarne::io {

inline constexpr size_t kHeadBytes = 4096;  ///< of a file, by which its format is told

/// One scan file format. A new one is a file that exports such a function and a line in registry.cpp.
struct Format {
    std::string_view name;  ///< "LAS"
    /// ".las", lower case: what `create` is chosen by; what a file is that nothing else tells.
    std::string_view extension;
    bool (*recognises)(std::string_view head);  ///< by the first bytes of the file (up to kHeadBytes)
    Result<std::unique_ptr<PointSource>> (*open)(std::shared_ptr<const ByteSource> file,
                                                 const ReadOptions& options);
    /// Null for a format that is only read.
    Result<std::unique_ptr<PointWriter>> (*create)(const std::filesystem::path& path, const Schema& schema,
                                                   const ScanInfo& info, const WriteOptions& options);
    /// Its files may begin with anything: where no other format is recognised the extension is enough.
    bool by_name = false;
};

const Format& las_format();
const Format& laz_format();
const Format& ply_format();
const Format& e57_format();
const Format& pcd_format();
const Format& ptx_format();
const Format& obj_format();
const Format& text_format();  ///< XYZ, PTS and the like
const Format& txt_format();
const Format& csv_format();

/// A batch holds at most this many bytes of records, however wide they are.
inline constexpr size_t kLargestBatch = size_t{64} << 20;
inline size_t batch_limit(const Schema& schema, size_t most) {
    return std::min(most, std::max<size_t>(1, kLargestBatch / schema.stride));
}

/// Coordinates that can be computed with: finite, and far enough from overflow that squares and differences
/// stay finite. (NaN compares false.)
inline bool usable(double coordinate) {
    return coordinate <= 1e30 && coordinate >= -1e30;
}

/// The first whole line of a file's first bytes that is neither blank nor a comment behind #; empty where
/// there is none.
std::string_view first_statement(std::string_view head);

/// Sets the unit: the user's word, else what the file states; metres where neither states one.
void set_unit(ScanInfo& info, const ReadOptions& options, std::optional<double> stated);

/// The path's extension with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// `name` in printable UTF-8, at most 64 bytes, never empty.
std::string printable(std::string_view name);
/// The same, made different from every attribute of the schema.
std::string unique_name(const Schema& schema, std::string_view name);

}  // namespace lucarne::io
