#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "viewer/bookmarks/bookmarking.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Bookmarking>;

/// Returns a name such as "Bookmark 3" with the first free number.
std::string free_name(const std::vector<Bookmark>& bookmarks) {
    for (size_t number = 1;; ++number) {
        std::string name = fmt::format("Bookmark {}", number);
        const auto same = [&](const Bookmark& bookmark) { return bookmark.camera.name == name; };
        if (std::ranges::none_of(bookmarks, same)) return name;
    }
}

void add(const Bookmarking& model) {
    BookmarkModel& bookmarks = model.bookmarks;
    if (bookmarks.all.size() >= kMostBookmarks) {
        model.view.message = "the list of bookmarks is full";
        return;
    }
    Bookmark bookmark{model.view.rig.camera(), thumbnail_of(*model.view.picture), 0};
    bookmark.camera.name = free_name(bookmarks.all);
    model.view.message = bookmark.camera.name + " is set";
    bookmarks.visited = bookmarks.all.size();
    bookmarks.all.push_back(std::move(bookmark));
    bookmarks.commands.push(SaveBookmarks{});
}
bool has_picture(const Bookmarking& model) {
    return model.view.picture != nullptr;
}

void go(const Bookmarking& model, size_t index) {
    BookmarkModel& bookmarks = model.bookmarks;
    if (index >= bookmarks.all.size()) return;
    bookmarks.visited = index;
    model.view.go_to(bookmarks.all[index].camera);
    model.view.message = bookmarks.all[index].camera.name;
}
void next(const Bookmarking& model) {
    go(model, (model.bookmarks.visited + 1) % model.bookmarks.all.size());
}
void previous(const Bookmarking& model) {
    const size_t count = model.bookmarks.all.size();
    go(model, (model.bookmarks.visited + count - 1) % count);
}
bool has_bookmarks(const Bookmarking& model) {
    return !model.bookmarks.all.empty();
}
template <size_t kIndex>
void go_to(const Bookmarking& model) {
    go(model, kIndex);
}
template <size_t kIndex>
bool there(const Bookmarking& model) {
    return kIndex < model.bookmarks.all.size();
}

}  // namespace

std::span<const Action<const Bookmarking>> bookmark_actions() {
    static constexpr const char* kMenu = "View/Bookmarks";
    static constexpr int kCtrl = GLFW_MOD_CONTROL, kAlt = GLFW_MOD_ALT;
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_B, kCtrl}, kMenu, "Set a bookmark", add, has_picture},
        Entry{{GLFW_KEY_PAGE_DOWN, kCtrl}, kMenu, "Next", next, has_bookmarks},
        Entry{{GLFW_KEY_PAGE_UP, kCtrl}, kMenu, "Previous", previous, has_bookmarks},
        Entry{{GLFW_KEY_1, kAlt}, kMenu, "First", go_to<0>, there<0>},
        Entry{{GLFW_KEY_2, kAlt}, kMenu, "Second", go_to<1>, there<1>},
        Entry{{GLFW_KEY_3, kAlt}, kMenu, "Third", go_to<2>, there<2>},
    };
    return kActions;
}

}  // namespace lucarne::viewer
