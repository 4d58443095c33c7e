// The list of formats that Lucarne knows; a file's content tells which one it has.
#include <array>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/files/json.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"
#include "io/formats/copc/copc.h"
#include "io/formats/las/extras.h"
#include "io/formats/load_mesh.h"

namespace lucarne::io {
namespace {

// Text comes last: other formats are text as well.
auto formats() {
    return std::array{&las_format(), &laz_format(), &ply_format(),  &e57_format(), &pcd_format(),
                      &ptx_format(), &obj_format(), &text_format(), &txt_format(), &csv_format()};
}

/// A format that Lucarne does not read, for a better message than "unknown".
struct Foreign {
    std::string_view what, todo;
};
Foreign foreign_format(std::string_view head, uint64_t file_bytes) {
    constexpr std::string_view kConvert = "convert it to LAS or PLY";
    if (head.starts_with("\x89PNG") || head.starts_with("\xff\xd8\xff"))
        return {"an image, not a scan", kConvert};
    if (head.starts_with("\x1f\x8b")) return {"compressed by gzip", "unpack it with gunzip"};
    if (head.starts_with("PK\x03\x04")) return {"a zip archive", "unpack it"};
    if (head.starts_with("7z\xbc\xaf\x27\x1c")) return {"a 7z archive", "unpack it"};
    // STL: text, or 80 bytes of anything, the number of triangles and 50 bytes for each.
    constexpr size_t kStlHead = 84, kStlTriangle = 50;
    constexpr std::string_view kMesh = "convert it to PLY or OBJ";
    auto rest = without_mark(head);
    const auto word = next_word(rest);
    if (same_letters(word, "solid") && lower(head).find("facet normal") != head.npos)
        return {"an STL mesh", kMesh};
    if (head.size() > kStlHead &&
        file_bytes ==
            kStlHead + kStlTriangle * uint64_t{load<uint32_t>(reinterpret_cast<const std::byte*>(&head[80]))})
        return {"an STL mesh", kMesh};
    if (same_letters(word, "ncols") && lower(head).find("cellsize") != head.npos)
        return {"a raster grid (ESRI ASCII)",
                "convert its cells to points, for example with gdal_translate -of XYZ"};
    return {};
}

/// What a file's first bytes and its name say of its format.
struct Candidates {
    const Format *told = nullptr, *named = nullptr;  ///< by the content; by the extension
    std::string head;
    /// Any text may be rows of numbers, whatever its name says.
    bool rows() const { return told && told->open == text_format().open; }
};
Result<Candidates> candidates_for(const ByteSource& file) {
    const std::filesystem::path& path = file.path();
    if (file.size() == 0) return rejected(path.string(), "is empty");
    std::array<std::byte, kHeadBytes> bytes{};
    LUCARNE_ASSIGN(const size_t got, file.read_some(0, bytes));
    Candidates found{.head = std::string(reinterpret_cast<const char*>(bytes.data()), got)};
    if (found.head.starts_with("\xff\xfe") || found.head.starts_with("\xfe\xff"))
        return rejected(path.string(), "is UTF-16 text", "save it as UTF-8");
    const std::string extension = lower_extension(path);
    for (const Format* format : formats()) {
        if (!found.told && format->recognises(found.head)) found.told = format;
        if (!found.named && format->extension == extension) found.named = format;
    }
    return found;
}

/// Returns why a file named .json is no scan.
tl::unexpected<Error> json_error(const std::filesystem::path& path) {
    const auto document = load_json(path);
    if (!document) return tl::make_unexpected(document.error());
    return rejected(path.string(), "is no scan", "give a scene to --scene; lucarne view opens projects");
}

/// Opens a scan in the axes of its file.
Result<std::unique_ptr<PointSource>> open_as_it_is(std::shared_ptr<const ByteSource> file,
                                                   const ReadOptions& options) {
    const std::filesystem::path& path = file->path();
    LUCARNE_ASSIGN(const Candidates found, candidates_for(*file));
    const auto& [told, named, head] = found;
    // Rows whose name belongs to another format count as that format, unless the user has described the
    // columns.
    const bool rows = found.rows();
    const Foreign foreign = told && !rows ? Foreign{} : foreign_format(head, file->size());
    if (!foreign.what.empty())
        return rejected(path.string(), fmt::format("is {}", foreign.what), std::string(foreign.todo));
    if (named && (!told || (rows && options.columns.empty() && named->open != told->open))) {
        auto scan = named->by_name ? named->open(file, options)
                                   : rejected(path.string(), fmt::format("is named {} and has no such header",
                                                                         named->extension));
        if (!scan && rows && scan.error().todo.empty())
            scan.error().todo = "if it holds rows of numbers, say what they are with --columns";
        return scan;
    }
    if (told) {
        auto scan = told->open(file, options);
        if (!scan && rows && lower_extension(path) == ".json") return json_error(path);
        return scan;
    }
    if (lower_extension(path) == ".json") return json_error(path);
    return rejected(path.string(), "has an unrecognised format", "convert it to LAS or PLY");
}

}  // namespace

Result<std::unique_ptr<PointSource>> open_scan(const std::filesystem::path& path,
                                               const ReadOptions& options) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    return open_scan(std::move(file), options);
}

Result<std::unique_ptr<PointSource>> open_scan(std::shared_ptr<const ByteSource> file,
                                               const ReadOptions& options) {
    LUCARNE_ASSIGN(auto scan, open_as_it_is(std::move(file), options));
    return turned(std::move(scan), options.up);
}

Result<mesh::Mesh> load_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    LUCARNE_ASSIGN(const Candidates found, candidates_for(*file));
    const Format* format = found.told && !(found.rows() && found.named) ? found.told : found.named;
    if (!format || !format->load_mesh) return mesh::Mesh{};
    return format->load_mesh(std::move(file), options);
}

Result<std::unique_ptr<PointWriter>> create_scan(const std::filesystem::path& path, const Schema& schema,
                                                 const ScanInfo& info, const WriteOptions& options) {
    if (copc::is_name(path))
        return bad_arguments(path.string(), "COPC is an octree, which this input is not yet",
                             "convert to a cache and export that");
    const std::string extension = lower_extension(path);
    for (const Format* format : formats()) {
        if (!format->create || format->extension != extension) continue;
        const bool scales = format == &las_format() || format == &laz_format();
        if (const auto scaled = scales ? std::string() : las::scaled_extras(info, schema); !scaled.empty())
            log::warn("{}: holds the whole numbers that LAS stores, not the scaled values: {}", path.string(),
                      scaled);
        return format->create(path, schema, info, options);
    }
    return bad_arguments(path.string(), fmt::format("cannot export '{}'", extension),
                         "use .las, .laz, .ply, .pcd, .csv, .txt or .xyz, or .copc.laz to export a cache");
}

}  // namespace lucarne::io
