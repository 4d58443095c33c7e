#include "viewer/bookmarks/session.h"

#include <iterator>

#include "io/core/log.h"

namespace lucarne::viewer {

void BookmarkSession::follow(const Bookmarking& model, const std::filesystem::path& folder) {
    BookmarkModel& bookmarks = model.bookmarks;
    carry_out(bookmarks);  // first, since the commands are about the bookmarks of `folder_`
    if (folder != folder_) {
        for (const Bookmark& bookmark : bookmarks.all) free_texture_(bookmark.texture);
        bookmarks.all.clear();
        folder_ = folder;
        if (!folder.empty())
            jobs_.push(
                "the bookmarks", [folder]() -> Result<LoadedBookmarks> { return load_bookmarks(folder); },
                [read = read_, folder](Result<LoadedBookmarks> loaded) {
                    const std::lock_guard lock(read->mutex);
                    read->bookmarks =
                        loaded ? std::move(*loaded) : LoadedBookmarks{folder, {}, loaded.error().line()};
                });
    }
    take_loaded(model);
    for (Bookmark& bookmark : bookmarks.all)
        if (!bookmark.texture && bookmark.thumbnail.width)
            bookmark.texture = make_texture_(bookmark.thumbnail);
}

void BookmarkSession::take_loaded(const Bookmarking& model) {
    std::optional<LoadedBookmarks> loaded;
    {
        const std::lock_guard lock(read_->mutex);
        loaded.swap(read_->bookmarks);
    }
    if (!loaded || loaded->folder != folder_) return;
    if (!loaded->problem.empty()) log::warn("{}", model.view.message = loaded->problem);
    auto& all = model.bookmarks.all;
    // The file has only those that the user has set meanwhile, if there are any.
    if (!all.empty()) model.bookmarks.commands.push(SaveBookmarks{});
    all.insert(all.begin(), std::make_move_iterator(loaded->bookmarks.begin()),
               std::make_move_iterator(loaded->bookmarks.end()));
}

void BookmarkSession::carry_out(BookmarkModel& bookmarks) {
    const Overloaded run{
        [&](const SaveBookmarks&) {
            jobs_.push("the bookmarks",
                       [all = bookmarks.all, folder = folder_] { return save_bookmarks(all, folder); });
        },
        [&](const FreeThumbnail& thumbnail) { free_texture_(thumbnail.texture); },
    };
    for (const auto& command : bookmarks.commands.take()) std::visit(run, command);
}

void BookmarkSession::textures_lost(BookmarkModel& bookmarks) {
    for (Bookmark& bookmark : bookmarks.all) bookmark.texture = 0;
    for (const auto& command : bookmarks.commands.take())
        if (!std::holds_alternative<FreeThumbnail>(command)) bookmarks.commands.push(command);
}

}  // namespace lucarne::viewer
