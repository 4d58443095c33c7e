#include "viewer/scan_list.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/format.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 9> kExtensions = {".las", ".laz", ".e57", ".ply", ".pcd",
                                                         ".ptx", ".pts", ".xyz", ".asc"};

bool is_scan(const fs::path& path) {
    return std::ranges::find(kExtensions, io::lower_extension(path)) != kExtensions.end();
}

}  // namespace

std::span<const std::string_view> scan_extensions() {
    return kExtensions;
}

bool names_scan(const fs::path& path) {
    const std::string extension = io::lower_extension(path);
    return is_scan(path) || extension == ".csv" || extension == ".txt" || extension == ".obj";
}

Result<std::vector<std::string>> expand_folders(const std::vector<std::string>& inputs) {
    std::vector<std::string> files;
    for (const std::string& input : inputs) {
        std::error_code error;
        if (!fs::is_directory(input, error)) {
            files.push_back(input);
            continue;
        }
        const size_t first = files.size();
        fs::recursive_directory_iterator entry(input, error), end;
        for (; !error && entry != end; entry.increment(error))
            if (entry->is_regular_file() && is_scan(entry->path())) files.push_back(entry->path().string());
        if (error) return rejected(input, "cannot be looked through: " + error.message());
        if (files.size() == first) return rejected(input, "is a folder without scans");
        std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
    }
    return files;
}

Result<void> SetAside::take(Error error, std::vector<std::string>& inputs) {
    const auto broken = std::ranges::find(inputs, error.what);
    if (error.kind != ErrorKind::input_rejected || broken == inputs.end())
        return tl::unexpected(std::move(error));
    error = io::with_salvage_advice(std::move(error), *broken, options_);
    if (inputs_ < 2) return tl::unexpected(std::move(error));
    log::warn("{}; it is left out", error.line());
    lines_.push_back(error.line());
    inputs.erase(broken);
    return {};
}

Result<void> SetAside::result(const std::string& output, std::string_view fate) const {
    if (lines_.empty()) return {};
    std::string all;
    for (const std::string& line : lines_) all += (all.empty() ? "" : "; ") + line;
    return rejected(output, fmt::format("{} of {} inputs {}: {}", lines_.size(), inputs_, fate, all));
}

}  // namespace lucarne::viewer
