#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/core/job_queue.h"

namespace lucarne::viewer {

/// An entry of a folder that can be opened.
struct FolderEntry {
    std::string name;
    bool folder = false;
    uint64_t bytes = 0;
};
struct FolderListing {
    std::filesystem::path folder;
    std::vector<FolderEntry> entries;  ///< folders first, each by name; at most kMostEntries
    std::string problem;               ///< why it cannot be listed; empty otherwise
};
inline constexpr size_t kMostEntries = 10000;

/// Lists a folder without hidden files. Unless `all` is set, also leaves out files without a scan's
/// extension.
FolderListing list_folder(const std::filesystem::path& folder, bool all);

/// The state of a dialog for opening files, for desktops without one. file_browser_panel.cpp draws it. A
/// thread lists the folders.
class FileBrowser {
 public:
    void open(const std::filesystem::path& folder);
    void close() { open_ = false; }
    bool is_open() const { return open_; }
    void go(const std::filesystem::path& folder);
    /// Goes to a folder that was typed, relative to folder() or with ~ for the home folder. Returns the path
    /// of a file that was typed. Sets problem() if there is neither.
    std::optional<std::string> enter(const std::string& typed);
    const std::string& problem() const { return problem_; }
    void show_all(bool all);
    bool shows_all() const { return all_; }
    void toggle(const std::string& name);  ///< chooses a file, or removes it from the choice
    bool is_chosen(const std::string& name) const { return chosen_.contains(name); }

    /// Returns the newest listing. While folder() is still being listed, this is the listing of an earlier
    /// folder.
    FolderListing listing() const;
    const std::filesystem::path& folder() const { return folder_; }
    std::vector<std::string> chosen() const;  ///< full paths

 private:
    struct Shared {
        std::mutex mutex;
        FolderListing listing;
    };
    void list();

    bool open_ = false, all_ = false;
    std::string problem_;
    std::filesystem::path folder_;
    std::set<std::string> chosen_;
    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
    JobQueue jobs_;
};

}  // namespace lucarne::viewer
