#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/files/file.h"
#include "io/formats/scan.h"

namespace lucarne::io {

namespace mesh {
struct Mesh;
}

inline constexpr size_t kHeadBytes = 4096;  ///< the first bytes of a file, which tell its format

/// One scan file format. To add a format, write a file that exports such a function, and a line in
/// registry.cpp.
struct Format {
    std::string_view name;  ///< "LAS"
    /// ".las", lower case. `create` is chosen by it; so is the format of a file whose content tells nothing.
    std::string_view extension;
    bool (*recognises)(std::string_view head);  ///< by the first bytes of the file (up to kHeadBytes)
    Result<std::unique_ptr<PointSource>> (*open)(std::shared_ptr<const ByteSource> file,
                                                 const ReadOptions& options);
    /// Null if the format can only be read.
    Result<std::unique_ptr<PointWriter>> (*create)(const std::filesystem::path& path, const Schema& schema,
                                                   const ScanInfo& info, const WriteOptions& options);
    /// The files may begin with anything, so the extension is enough if no other format is recognised.
    bool by_name = false;
    /// Reads the triangles of a file, finished (mesh::Mesh::finish()); null if the format has none.
    Result<mesh::Mesh> (*load_mesh)(std::shared_ptr<const ByteSource> file,
                                    const ReadOptions& options) = nullptr;
};

const Format& las_format();
const Format& laz_format();
const Format& ply_format();
const Format& e57_format();
const Format& pcd_format();
const Format& ptx_format();
const Format& obj_format();
const Format& text_format();  ///< XYZ, PTS and similar
const Format& txt_format();
const Format& csv_format();

/// A batch holds at most this many bytes of records, however large a record is.
inline constexpr size_t kLargestBatch = size_t{64} << 20;
inline size_t batch_limit(const Schema& schema, size_t most) {
    return std::min(most, std::max<size_t>(1, kLargestBatch / schema.stride));
}

/// Returns whether one can compute with a coordinate: it is finite, and so far from overflow that squares and
/// differences stay finite. (NaN compares false.)
inline bool usable(double coordinate) {
    return coordinate <= 1e30 && coordinate >= -1e30;
}

/// Returns the first whole line of a file's first bytes that is neither blank nor a comment (#); empty if
/// there is none.
std::string_view first_statement(std::string_view head);

/// Sets the unit: the user's choice, otherwise what the file states, otherwise metres.
void set_unit(ScanInfo& info, const ReadOptions& options, std::optional<double> stated);

/// Returns the path's extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// Returns `name` in printable UTF-8: at most 64 bytes, never empty.
std::string printable(std::string_view name);
/// Returns the same, changed so that it differs from the name of every attribute of the schema.
std::string unique_name(const Schema& schema, std::string_view name);

}  // namespace lucarne::io
