#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "io/core/job_queue.h"
#include "viewer/bookmarks/bookmarking.h"

namespace lucarne::viewer {

/// Loads and saves the bookmarks of the open scan, on a thread, and makes the textures of their thumbnails.
class BookmarkSession {
 public:
    BookmarkSession(std::function<unsigned(const io::Image8&)> make_texture,
                    std::function<void(unsigned)> free_texture)
        : make_texture_(std::move(make_texture)), free_texture_(std::move(free_texture)) {}

    /// Waits until all changes are saved.
    ~BookmarkSession() { jobs_.finish(); }
    BookmarkSession(const BookmarkSession&) = delete;
    BookmarkSession& operator=(const BookmarkSession&) = delete;

    /// Call once a frame. `folder`: that of the open scan's bookmarks (bookmark_folder()); empty: no scan.
    void follow(const Bookmarking& model, const std::filesystem::path& folder);
    /// Forgets textures that were lost with the window.
    void textures_lost(BookmarkModel& bookmarks);

 private:
    void take_loaded(const Bookmarking& model);
    void carry_out(BookmarkModel& bookmarks);

    std::function<unsigned(const io::Image8&)> make_texture_;
    std::function<void(unsigned)> free_texture_;
    std::filesystem::path folder_;  ///< empty: none yet
    struct Read {
        std::mutex mutex;
        std::optional<LoadedBookmarks> bookmarks;
    };
    std::shared_ptr<Read> read_ = std::make_shared<Read>();
    JobQueue jobs_;
};

}  // namespace lucarne::viewer
