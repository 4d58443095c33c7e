#include "viewer/bookmarks/bookmarks.h"

#include <algorithm>
#include <numbers>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/file.h"
#include "io/files/json.h"
#include "io/files/put_aside.h"
#include "io/files/user_folder.h"
#include "viewer/frame/picture_worker.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kThumbnailHeight = 72;  ///< pixels
constexpr uint32_t kWidestThumbnail = 160;

nlohmann::json json_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

fs::path thumbnail_file(const fs::path& folder, size_t index) {
    return folder / fmt::format("{}.png", index + 1);
}

}  // namespace

fs::path bookmark_folder(const fs::path& config, const std::string& scan) {
    return config.empty() ? fs::path() : config / "bookmarks" / kept_name(scan);
}

LoadedBookmarks load_bookmarks(const fs::path& folder) {
    LoadedBookmarks loaded{folder, {}, {}};
    const fs::path file = folder / "bookmarks.json";
    std::error_code error;
    if (!fs::exists(file, error)) return loaded;
    auto scene = gi::load_scene(file);
    if (!scene) {
        loaded.problem = put_aside(file, scene.error());
        return loaded;
    }
    for (gi::SceneCamera& camera : scene->cameras) {
        if (loaded.bookmarks.size() >= kMostBookmarks) break;
        Bookmark bookmark{std::move(camera), {}, 0};
        const fs::path picture = thumbnail_file(folder, loaded.bookmarks.size());
        if (auto thumbnail = io::read_png(picture);
            thumbnail && thumbnail->width <= kWidestThumbnail && thumbnail->height <= kThumbnailHeight)
            bookmark.thumbnail = std::move(*thumbnail);
        loaded.bookmarks.push_back(std::move(bookmark));
    }
    return loaded;
}

Result<void> save_bookmarks(const std::vector<Bookmark>& bookmarks, const fs::path& folder) {
    if (folder.empty()) return {};
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return failed(folder.string(), "cannot be made: " + error.message());
    nlohmann::json cameras = nlohmann::json::array();
    for (size_t i = 0; i < bookmarks.size(); ++i) {
        const gi::SceneCamera& camera = bookmarks[i].camera;
        nlohmann::json one = {{"name", camera.name},
                              {"position", json_of(camera.position)},
                              {"target", json_of(camera.target)},
                              {"up", json_of(camera.up)},
                              {"fov", camera.vertical_fov * 180 / std::numbers::pi}};
        if (camera.orthographic_height > 0) one["orthographic_height"] = camera.orthographic_height;
        cameras.push_back(std::move(one));
        if (bookmarks[i].thumbnail.width)
            LUCARNE_TRY(io::write_png(thumbnail_file(folder, i), bookmarks[i].thumbnail, true));
        else
            fs::remove(thumbnail_file(folder, i), error);  // left over from a bookmark that was removed
    }
    return write_file(folder / "bookmarks.json", json_text(nlohmann::json{{"cameras", cameras}}), true);
}

io::Image8 thumbnail_of(const Picture& picture) {
    const uint32_t width = picture.size.width, height = picture.size.height;
    io::Image8 small;
    if (!width || !height) return small;
    small.height = std::min(kThumbnailHeight, height);
    small.width = std::clamp(width * small.height / height, 1u, kWidestThumbnail);
    small.bytes.resize(size_t{3} * small.width * small.height);
    for (uint32_t y = 0; y < small.height; ++y)
        for (uint32_t x = 0; x < small.width; ++x) {
            const uint32_t x0 = x * width / small.width, x1 = std::max((x + 1) * width / small.width, x0 + 1);
            const uint32_t y0 = y * height / small.height,
                           y1 = std::max((y + 1) * height / small.height, y0 + 1);
            for (uint32_t channel = 0; channel < 3; ++channel) {
                uint64_t sum = 0;
                for (uint32_t v = y0; v < y1; ++v)
                    for (uint32_t u = x0; u < x1; ++u)
                        sum += std::to_integer<uint64_t>(picture.rgba[(size_t{v} * width + u) * 4 + channel]);
                small.bytes[(size_t{y} * small.width + x) * 3 + channel] =
                    static_cast<uint8_t>(sum / (uint64_t{x1 - x0} * (y1 - y0)));
            }
        }
    return small;
}

}  // namespace lucarne::viewer
