#include "io/formats/mesh/textures.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/random.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::mesh {
namespace {

constexpr uint64_t kMostText = uint64_t{64} << 20;  ///< of a material file
constexpr size_t kMostTexts = 64, kMostTextures = 4096;
constexpr size_t kMostSearches = 256;                   ///< missing names that are looked for in another case
constexpr uint64_t kMostAllPixels = uint64_t{1} << 28;  ///< of all textures together, three bytes each

/// Returns the entry below `folder` whose name differs from this path's only in case, as on systems that do
/// not distinguish; the path itself if there is none.
std::filesystem::path in_any_case(const std::filesystem::path& path, const std::filesystem::path& folder) {
    constexpr size_t kMostEntries = 65536;
    std::error_code error;
    std::filesystem::path found = folder;
    for (const auto& part : path.lexically_relative(folder.empty() ? "." : folder)) {
        std::filesystem::path next = found / part;
        std::filesystem::directory_iterator entry(found.empty() ? "." : found, error), end;
        for (size_t i = 0;
             !error && !std::filesystem::exists(next, error) && entry != end && i < kMostEntries;
             ++i, entry.increment(error))
            if (same_letters(entry->path().filename().string(), part.string()))
                next = found / entry->path().filename();
        found = std::move(next);
    }
    return std::filesystem::exists(found, error) ? found : path;
}

}  // namespace

Companions::Companions(Mesh& mesh, const std::filesystem::path& mesh_file)
    : mesh_(mesh), folder_(mesh_file.parent_path().lexically_normal()) {}

std::filesystem::path Companions::place(std::string_view name, const std::filesystem::path& from) {
    std::string text(name);
    std::replace(text.begin(), text.end(), '\\', '/');
    std::filesystem::path wanted(text);
    const auto whole = (from / wanted).lexically_normal();
    const auto inside = whole.lexically_relative(folder_.empty() ? "." : folder_);
    const bool drive = text.size() > 1 && text[1] == ':';
    const bool below = !drive && wanted.is_relative() && !inside.empty() && *inside.begin() != "..";
    const std::filesystem::path found = below ? whole : from / wanted.filename();
    std::error_code error;
    if (std::filesystem::exists(found, error) || searches_ == kMostSearches) return found;
    ++searches_;
    return in_any_case(found, below ? folder_ : from);
}

void Companions::count(const ByteSource& file) {
    state_ = mix64(mix64(state_, file.size()), static_cast<uint64_t>(file.modified()));
}

uint32_t Companions::texture(std::string_view name, const std::filesystem::path& from) {
    const auto path = place(name, from);
    const auto known = textures_.find(path);
    if (known != textures_.end()) return known->second;
    uint32_t& number = textures_[path] = kNone;
    if (textures_.size() > kMostTextures || pixels_ >= kMostAllPixels) {
        log::warn("{}: the textures are too many or too large; it is left out", path.string());
        return kNone;
    }
    auto image = read_picture(path, std::min(kMostPixels, kMostAllPixels - pixels_));
    if (!image) {
        log::warn("{}; the mesh is sampled without this texture", image.error().line());
        return kNone;
    }
    if (const auto file = InputFile::open(path)) count(*file);
    pixels_ += uint64_t{image->width} * image->height;
    number = static_cast<uint32_t>(mesh_.textures.size());
    mesh_.textures.push_back(std::move(*image));
    return number;
}

std::optional<std::string> Companions::text(std::string_view name, std::filesystem::path& path) {
    path = place(name, folder_);
    if (texts_.size() == kMostTexts || !texts_.emplace(path, true).second) return std::nullopt;
    const auto read = [&]() -> Result<std::string> {
        LUCARNE_ASSIGN(const auto file, InputFile::open(path));
        if (file.size() > kMostText) return rejected(path.string(), "is too large for a file of materials");
        count(file);
        std::string bytes(static_cast<size_t>(file.size()), '\0');
        LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(bytes))));
        return bytes;
    };
    auto bytes = read();
    if (bytes) return std::move(*bytes);
    log::warn("{}; the mesh is sampled without these materials", bytes.error().line());
    return std::nullopt;
}

}  // namespace lucarne::io::mesh
