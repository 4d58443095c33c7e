#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gi/scene/scene.h"
#include "io/image/image.h"

namespace lucarne::viewer {

struct Picture;

/// A place to come back to.
struct Bookmark {
    gi::SceneCamera camera;  ///< with the bookmark's name
    io::Image8 thumbnail;    ///< empty: there is none
    unsigned texture = 0;    ///< of it, in the window
};

inline constexpr size_t kMostBookmarks = 100;

/// The bookmarks of a scan, in the folder of settings: bookmarks.json, a scene file that has cameras alone
/// (data/README.md; `lucarne render --scene` takes it), and their thumbnails as 1.png, 2.png...
std::filesystem::path bookmark_folder(const std::filesystem::path& config, const std::string& scan);

struct LoadedBookmarks {
    std::filesystem::path folder;
    std::vector<Bookmark> bookmarks;
    std::string problem;  ///< for people; empty: none
};
/// A broken file is put aside, see put_aside(); a thumbnail that cannot be read is left out.
LoadedBookmarks load_bookmarks(const std::filesystem::path& folder);
Result<void> save_bookmarks(const std::vector<Bookmark>& bookmarks, const std::filesystem::path& folder);

/// The picture, small.
io::Image8 thumbnail_of(const Picture& picture);

}  // namespace lucarne::viewer
