#include "viewer/inputs/kept_cache.h"

#include <algorithm>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/random.h"
#include "io/files/file.h"
#include "io/files/user_folder.h"
#include "octree/cache/cache.h"

namespace lucarne::viewer {
namespace {

using std::filesystem::path;

path absolute(const std::string& name) {
    std::error_code unknown;
    const path whole = std::filesystem::absolute(name, unknown);
    return unknown ? path(name) : whole.lexically_normal();
}

uint64_t hash_of(const KeptCache::Scans& scans) {
    uint64_t hash = 0;
    for (const auto& scan : scans) {
        for (const char c : absolute(scan.path).string()) hash = mix64(hash, static_cast<unsigned char>(c));
        hash = mix64(hash, 0x100);  // not a byte value: marks the end of a path
    }
    return hash;
}

/// Of the cache (6 to 27 bytes) and of the records that are sorted for it.
constexpr uint64_t kBytesPerPoint = 40;

/// Returns what is free on the disk of a folder; the largest number if that is not known.
uint64_t free_bytes(const path& folder) {
    std::error_code unknown;
    const auto space = std::filesystem::space(folder.empty() ? path(".") : folder, unknown);
    return unknown ? std::numeric_limits<uint64_t>::max() : space.available;
}

/// Returns the deepest folder that contains all scans.
path common_folder(const KeptCache::Scans& scans) {
    path common = absolute(scans.front().path).parent_path();
    for (const auto& scan : scans) {
        const path folder = absolute(scan.path).parent_path();
        const auto differs = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end()).first;
        path shared;
        for (auto part = common.begin(); part != differs; ++part) shared /= *part;
        common = std::move(shared);
    }
    return common;
}

bool same_file_name(const std::string& a, const std::string& b) {
    return path(a).filename() == path(b).filename();
}

}  // namespace

KeptCache::KeptCache(const Scans& scans, std::string options) : scans_(scans), options_(std::move(options)) {
    const path first = absolute(scans_.front().path);
    const uint64_t hash = hash_of(scans_);
    const std::string name = first.filename().string();
    const auto short_hash = static_cast<uint32_t>(hash);
    if (scans_.size() == 1) {
        beside_ = first.parent_path() / (name + ".luc");
    } else {
        among_ = first.parent_path() / fmt::format("{}+{}-{:08x}.luc", name, scans_.size() - 1, short_hash);
        const path folder = common_folder(scans_);
        beside_ =
            folder.has_filename()
                ? folder.parent_path() / fmt::format("{}-{:08x}.luc", folder.filename().string(), short_hash)
                : among_;
    }
    if (const path folder = user_folder("XDG_CACHE_HOME", ".cache"); !folder.empty())
        in_folder_ = folder / fmt::format("{}-{:016x}.luc", name.substr(0, 100), hash);
}

bool KeptCache::made_of(const octree::NodeSource& cache, bool same_state) const {
    const auto& made = cache.header().scans;
    if (same_state && cache.header().options != options_) return false;
    return std::equal(
        made.begin(), made.end(), scans_.begin(), scans_.end(), [&](const auto& was, const auto& is) {
            return same_file_name(was.path, is.path) &&
                   (!same_state ||
                    (was.file_bytes == is.file_bytes && was.modified == is.modified && is.file_bytes > 0));
        });
}

std::shared_ptr<const octree::NodeSource> KeptCache::find() const {
    for (const path& file : {beside_, in_folder_, among_}) {
        if (file.empty()) continue;
        auto input = InputFile::open_shared(file);
        if (!input || !octree::is_cache(**input)) continue;
        auto cache = octree::open_cache(std::move(*input));
        if (cache && made_of(**cache, true)) return std::move(*cache);
        log::info(
            "{}: {}; it is not used", file.string(),
            cache ? "was made from another state of the scan, or with other options" : cache.error().why);
    }
    return nullptr;
}

uint64_t KeptCache::bytes_needed() const {
    uint64_t points = 0;
    // Headers of damaged files declare any number of points.
    constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max() / kBytesPerPoint;
    for (const auto& scan : scans_)
        points = std::min(points + std::min(scan.declared_points, kMost / 2), kMost);
    return points * kBytesPerPoint;
}

std::optional<path> KeptCache::place(uint64_t bytes) const {
    for (const path& file : {beside_, in_folder_}) {
        if (file.empty()) continue;
        std::error_code ignored;
        if (file == in_folder_) std::filesystem::create_directories(file.parent_path(), ignored);
        if (!check_output(file, true)) continue;
        if (const uint64_t free = free_bytes(file.parent_path()); free < bytes) {
            log::warn("{}: its disk has {} left, and converting may take {}", file.string(), bytes_text(free),
                      bytes_text(bytes));
            continue;
        }
        if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) return file;
        const auto cache = octree::open_cache(file);
        if (cache && made_of(**cache, false)) return file;
    }
    return std::nullopt;
}

}  // namespace lucarne::viewer
