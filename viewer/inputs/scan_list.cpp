#include "viewer/inputs/scan_list.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <sys/stat.h>

#include "io/core/log.h"
#include "io/formats/common/format.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kText = ".txt";  ///< may also be other text, for example a licence
constexpr std::array<std::string_view, 12> kExtensions = {".las", ".laz", ".e57", ".ply", ".pcd", ".ptx",
                                                          ".pts", ".xyz", ".asc", ".csv", ".obj", kText};
constexpr size_t kNamed = 5;  ///< names shown of a long list

/// Decides by the rows whether a text file contains points, so that licences and notes do not count as broken
/// scans.
bool holds_points(const fs::path& text, io::ReadOptions options) {
    options.quiet = true;
    return io::open_scan(text, options).has_value();
}

/// Lists the scans in a folder and below. Only one folder is open at a time, whatever the depth.
void look_through(const std::string& folder, const io::ReadOptions& options, ScanList& list) {
    std::vector<std::string> found, others;
    std::vector<fs::path> folders{folder};
    const size_t problems = list.problems.size();
    while (!folders.empty()) {
        const fs::path here = std::move(folders.back());
        folders.pop_back();
        std::error_code error, unknown;
        fs::directory_iterator entry(here, error), end;
        for (; !error && entry != end; entry.increment(error)) {
            const fs::path& path = entry->path();
            if (entry->is_directory(unknown) && !entry->is_symlink(unknown))
                folders.push_back(path);
            else if (io::lower_extension(path) == kText ? holds_points(path, options) : names_scan(path))
                found.push_back(path.string());
            else
                others.push_back(path.lexically_relative(folder).string() +
                                 (entry->is_directory(unknown) ? " (a link to a folder)" : ""));
        }
        if (error)
            list.problems.push_back(
                {ErrorKind::input_rejected, here.string(), "cannot be searched: " + error.message(), ""});
    }
    std::ranges::sort(found);
    std::ranges::sort(others);
    if (!others.empty())
        log::info("{}: {} other file{} skipped: {}", folder, others.size(),
                  others.size() == 1 ? " is" : "s are", some_of(others));
    if (found.empty() && list.problems.size() == problems)
        list.problems.push_back({ErrorKind::input_rejected, folder, "is a folder without scans", ""});
    list.files.insert(list.files.end(), found.begin(), found.end());
}

}  // namespace

std::string some_of(const std::vector<std::string>& names) {
    std::string text;
    for (size_t i = 0; i < std::min(names.size(), kNamed); ++i) text += (i ? ", " : "") + names[i];
    return names.size() > kNamed ? fmt::format("{} and {} more", text, names.size() - kNamed) : text;
}

std::span<const std::string_view> scan_extensions() {
    return kExtensions;
}

bool names_scan(const fs::path& path) {
    return std::ranges::find(kExtensions, io::lower_extension(path)) != kExtensions.end();
}

std::vector<std::string> once_each(const std::vector<std::string>& paths) {
    std::vector<std::string> once;
    std::map<std::pair<dev_t, ino_t>, std::string> taken;
    for (const std::string& path : paths) {
        struct stat status {};
        if (::stat(path.c_str(), &status) == 0) {
            const auto [first, is_new] = taken.try_emplace({status.st_dev, status.st_ino}, path);
            if (!is_new) {
                log::warn("{}: {}; it is taken once", path,
                          path == first->second ? "was given twice" : "is the same file as " + first->second);
                continue;
            }
        }
        once.push_back(path);
    }
    return once;
}

Result<ScanList> expand_folders(const std::vector<std::string>& inputs, const io::ReadOptions& options) {
    ScanList list;
    for (const std::string& input : once_each(inputs)) {
        std::error_code error;
        if (input.empty())
            list.problems.push_back({ErrorKind::input_rejected, "''", "is not a file name", ""});
        else if (fs::is_directory(input, error))
            look_through(input, options, list);
        else
            list.files.push_back(input);
    }
    list.files = once_each(list.files);
    if (list.files.empty() && list.problems.size() == 1) return tl::unexpected(list.problems.front());
    for (const Error& problem : list.problems) log::warn("{}; skipped", problem.line());
    if (list.files.empty()) return rejected("inputs", "none of them contains a scan");
    return list;
}

SetAside::SetAside(const ScanList& list, io::ReadOptions options)
    : inputs_(list.files.size() + list.problems.size()),
      options_(std::move(options)),
      errors_(list.problems) {}

Result<void> SetAside::take(Error error, std::vector<std::string>& inputs) {
    const auto broken = std::ranges::find(inputs, error.what);
    if (error.kind != ErrorKind::input_rejected || broken == inputs.end())
        return tl::unexpected(std::move(error));
    error = io::with_salvage_advice(std::move(error), *broken, options_);
    if (inputs_ < 2) return tl::unexpected(std::move(error));
    log::warn("{}; skipped", error.line());
    errors_.push_back(std::move(error));
    inputs.erase(broken);
    return {};
}

Result<void> SetAside::result(const std::string& output, std::string_view fate) const {
    if (errors_.empty()) return {};
    std::vector<std::string> names;
    for (const Error& error : errors_) names.push_back(error.what);
    return rejected(output,
                    fmt::format("{} of {} inputs {}: {}", names.size(), inputs_, fate, some_of(names)));
}

nlohmann::ordered_json SetAside::json() const {
    auto list = nlohmann::ordered_json::array();
    for (const Error& error : errors_)
        list.push_back({{"kind", "rejected"},
                        {"path", error.what},
                        {"reason", error.todo.empty() ? error.why : error.why + "; " + error.todo}});
    return list;
}

}  // namespace lucarne::viewer
