#include "viewer/scans/file_browser.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <tuple>

#include "viewer/inputs/scan_list.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

bool can_be_opened(const std::string& name) {
    std::string lower = name;
    std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    return lower.ends_with(".luc") || lower.ends_with(".json") ||
           std::ranges::any_of(scan_extensions(),
                               [&](const auto extension) { return lower.ends_with(extension); });
}

}  // namespace

FolderListing list_folder(const fs::path& folder, bool all) {
    FolderListing listing{folder, {}, {}};
    std::error_code error;
    fs::directory_iterator entry(folder, error), end;
    for (; !error && entry != end && listing.entries.size() < kMostEntries; entry.increment(error)) {
        std::error_code unknown;
        const std::string name = entry->path().filename().string();
        const bool is_folder = entry->is_directory(unknown);
        if (name.empty() || name[0] == '.' || (!is_folder && !entry->is_regular_file(unknown))) continue;
        if (!is_folder && !all && !can_be_opened(name)) continue;
        const uint64_t bytes = is_folder ? 0 : entry->file_size(unknown);
        listing.entries.push_back({name, is_folder, unknown ? 0 : bytes});
    }
    if (error) listing.problem = error.message();
    std::ranges::sort(listing.entries, {},
                      [](const FolderEntry& e) { return std::tuple(!e.folder, e.name); });
    return listing;
}

void FileBrowser::open(const fs::path& folder) {
    open_ = true;
    go(folder);
}

void FileBrowser::go(const fs::path& folder) {
    std::error_code unknown;
    const fs::path whole = fs::absolute(folder, unknown);
    folder_ = unknown ? folder : whole.lexically_normal();
    if (!folder_.has_filename() && folder_.has_relative_path()) folder_ = folder_.parent_path();
    chosen_.clear();
    problem_.clear();
    list();
}

std::optional<std::string> FileBrowser::enter(const std::string& typed) {
    problem_.clear();
    std::string text = typed;
    const char* home = std::getenv("HOME");
    if (home && (text == "~" || text.starts_with("~/"))) text = home + text.substr(1);
    const fs::path path = folder_ / text;  // an absolute path stays as it is
    std::error_code error;
    if (fs::is_directory(path, error)) return go(path), std::nullopt;
    if (fs::is_regular_file(path, error)) return path.string();
    problem_ = path.string() + ": " + (error ? error.message() : "neither a file nor a folder");
    return std::nullopt;
}

void FileBrowser::show_all(bool all) {
    all_ = all;
    list();
}

void FileBrowser::list() {
    jobs_.push(
        "the folder",
        [folder = folder_, all = all_]() -> Result<FolderListing> { return list_folder(folder, all); },
        [shared = shared_, folder = folder_](Result<FolderListing> listed) {
            FolderListing listing =
                listed ? std::move(*listed) : FolderListing{folder, {}, listed.error().line()};
            const std::lock_guard lock(shared->mutex);
            shared->listing = std::move(listing);
        });
}

void FileBrowser::toggle(const std::string& name) {
    if (!chosen_.erase(name)) chosen_.insert(name);
}

FolderListing FileBrowser::listing() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->listing;
}

std::vector<std::string> FileBrowser::chosen() const {
    std::vector<std::string> paths;
    for (const std::string& name : chosen_) paths.push_back((folder_ / name).string());
    return paths;
}

}  // namespace lucarne::viewer
