#pragma once

#include <span>

#include "viewer/bookmarks/bookmarks.h"
#include "viewer/ui/action.h"
#include "viewer/ui/command_queue.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

struct SaveBookmarks {};
/// A removed bookmark's thumbnail is not drawn any more.
struct FreeThumbnail {
    unsigned texture = 0;
};

/// The bookmarks of the open scan.
struct BookmarkModel {
    std::vector<Bookmark> all;
    size_t visited = 0;  ///< the bookmark that was visited last
    CommandQueue<SaveBookmarks, FreeThumbnail> commands;
};

/// What the actions and the panel of bookmarks act on.
struct Bookmarking {
    View& view;
    BookmarkModel& bookmarks;
};

std::span<const Action<const Bookmarking>> bookmark_actions();
void draw_bookmarks_panel(const Bookmarking& model);

}  // namespace lucarne::viewer
