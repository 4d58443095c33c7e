// The formats that Lucarne knows, told apart by content.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/copc.h"
#include "io/formats/format.h"

namespace lucarne::io {
namespace {

// Text comes last: other formats are text as well.
auto formats() {
    return std::array{&las_format(), &laz_format(), &ply_format(), &e57_format(),
                      &pcd_format(), &ptx_format(), &text_format()};
}

constexpr size_t kHeadBytes = 4096;

/// What a file is that we do not read, for a better message than "unknown".
std::string_view foreign_format(std::string_view head) {
    if (head.starts_with("\x89PNG") || head.starts_with("\xff\xd8\xff")) return "a picture";
    if (head.starts_with("PK\x03\x04") || head.starts_with("\x1f\x8b")) return "a compressed archive";
    return {};
}

}  // namespace

Result<std::unique_ptr<PointSource>> open_scan(const std::filesystem::path& path,
                                               const ReadOptions& options) {
    LUCARNE_ASSIGN(auto opened, InputFile::open(path));
    const auto file = std::make_shared<const InputFile>(std::move(opened));
    if (file->size() == 0) return rejected(path.string(), "is empty");
    std::array<std::byte, kHeadBytes> bytes{};
    LUCARNE_ASSIGN(const size_t got, file->read_some(0, bytes));
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), got);
    for (const Format* format : formats())
        if (format->recognises(head)) return format->open(file, options);
    const auto foreign = foreign_format(head);
    return rejected(path.string(),
                    foreign.empty() ? "is in no format that can be read"
                                    : fmt::format("is {}, which cannot be read", foreign),
                    "convert it to LAS or PLY");
}

Result<std::unique_ptr<PointWriter>> create_scan(const std::filesystem::path& path, const Schema& schema,
                                                 const ScanInfo& info, const WriteOptions& options) {
    if (copc::is_name(path))
        return bad_arguments(path.string(), "COPC is an octree, and this is none yet",
                             "convert to a cache and export that");
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    for (const Format* format : formats())
        if (format->create && format->extension == extension)
            return format->create(path, schema, info, options);
    return bad_arguments(path.string(),
                         fmt::format("the extension '{}' names no format that can be written", extension),
                         "end the name in .las, .laz, .ply or .pcd");
}

std::string printable(std::string_view name) {
    std::string clean;
    for (const char c : name.substr(0, 64)) clean += c >= ' ' && c < 0x7f ? c : '?';
    return clean.empty() ? "unnamed" : clean;
}

std::string unique_name(const Schema& schema, std::string_view name) {
    const std::string clean = printable(name);
    std::string unique = clean;
    for (int n = 2; schema.find(unique); ++n) unique = fmt::format("{}_{}", clean, n);
    return unique;
}

}  // namespace lucarne::io
