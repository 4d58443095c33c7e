#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

/// Returns a name such as "Bookmark 3" with the first free number.
std::string free_name(const std::vector<Bookmark>& bookmarks) {
    for (size_t number = 1;; ++number) {
        std::string name = fmt::format("Bookmark {}", number);
        const auto same = [&](const Bookmark& bookmark) { return bookmark.camera.name == name; };
        if (std::ranges::none_of(bookmarks, same)) return name;
    }
}

void add(ViewModel& model) {
    Shell& shell = model.shell;
    if (shell.bookmarks.size() >= kMostBookmarks) {
        model.message = "the list of bookmarks is full";
        return;
    }
    Bookmark bookmark{model.rig.camera(), thumbnail_of(*model.picture), 0};
    bookmark.camera.name = free_name(shell.bookmarks);
    model.message = bookmark.camera.name + " is set";
    shell.bookmark = shell.bookmarks.size();
    shell.bookmarks.push_back(std::move(bookmark));
    shell.bookmarks_changed = true;
}
bool has_picture(const ViewModel& model) {
    return model.picture != nullptr;
}

void go(ViewModel& model, size_t index) {
    Shell& shell = model.shell;
    if (index >= shell.bookmarks.size()) return;
    shell.bookmark = index;
    model.go_to(shell.bookmarks[index].camera);
    model.message = shell.bookmarks[index].camera.name;
}
void next(ViewModel& model) {
    go(model, (model.shell.bookmark + 1) % model.shell.bookmarks.size());
}
void previous(ViewModel& model) {
    const size_t count = model.shell.bookmarks.size();
    go(model, (model.shell.bookmark + count - 1) % count);
}
bool has_bookmarks(const ViewModel& model) {
    return !model.shell.bookmarks.empty();
}
template <size_t kIndex>
void go_to(ViewModel& model) {
    go(model, kIndex);
}
template <size_t kIndex>
bool there(const ViewModel& model) {
    return kIndex < model.shell.bookmarks.size();
}

}  // namespace

std::span<const Action> bookmark_actions() {
    static constexpr const char* kMenu = "View/Bookmarks";
    static constexpr int kCtrl = GLFW_MOD_CONTROL, kAlt = GLFW_MOD_ALT;
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_B, kCtrl}, kMenu, "Set a bookmark", add, has_picture},
        Action{{GLFW_KEY_PAGE_DOWN, kCtrl}, kMenu, "Next", next, has_bookmarks},
        Action{{GLFW_KEY_PAGE_UP, kCtrl}, kMenu, "Previous", previous, has_bookmarks},
        Action{{GLFW_KEY_1, kAlt}, kMenu, "First", go_to<0>, there<0>},
        Action{{GLFW_KEY_2, kAlt}, kMenu, "Second", go_to<1>, there<1>},
        Action{{GLFW_KEY_3, kAlt}, kMenu, "Third", go_to<2>, there<2>},
    };
    return kActions;
}

}  // namespace lucarne::viewer
