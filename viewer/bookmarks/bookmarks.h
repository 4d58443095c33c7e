#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gi/scene/scene.h"
#include "io/image/image.h"

namespace lucarne::viewer {

struct Picture;

/// A saved view that the user can return to.
struct Bookmark {
    gi::SceneCamera camera;  ///< its name is the bookmark's name
    io::Image8 thumbnail;    ///< empty: no thumbnail
    unsigned texture = 0;    ///< the window's texture of the thumbnail; 0: none
};

inline constexpr size_t kMostBookmarks = 100;

/// Returns the folder under `config` (the folder of settings) that holds a scan's bookmarks: bookmarks.json,
/// a scene file that contains only cameras (data/README.md; `lucarne render --scene` reads it), and the
/// thumbnails 1.png, 2.png and so on.
std::filesystem::path bookmark_folder(const std::filesystem::path& config, const std::string& scan);

struct LoadedBookmarks {
    std::filesystem::path folder;
    std::vector<Bookmark> bookmarks;
    std::string problem;  ///< a message for the user; empty: no problem
};
/// Reads a folder of bookmarks. Moves a broken file aside (see put_aside()). Leaves out thumbnails that
/// cannot be read.
LoadedBookmarks load_bookmarks(const std::filesystem::path& folder);
Result<void> save_bookmarks(const std::vector<Bookmark>& bookmarks, const std::filesystem::path& folder);

/// Returns a small copy of the picture.
io::Image8 thumbnail_of(const Picture& picture);

}  // namespace lucarne::viewer
