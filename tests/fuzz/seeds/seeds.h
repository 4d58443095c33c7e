#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lucarne::fuzz {

/// Where the seeds of one target go.
class Seeds {
 public:
    explicit Seeds(std::filesystem::path folder);

    /// A seed of any kind.
    void add(std::string_view name, std::string_view bytes) const;
    /// A scan file, which must open and give points to its end: a seed that is refused seeds nothing.
    void add_scan(std::string_view name, std::string_view bytes) const;
    /// Reads what a writer of ours left at `path` as a seed.
    static std::string taken(const std::filesystem::path& path);
    const std::filesystem::path& folder() const { return folder_; }

 private:
    std::filesystem::path folder_;
};

// One of these a format, each in its own file: small valid files of every variant.
void cache_seeds(const Seeds& seeds);
void codec_seeds(const Seeds& seeds);
void copc_seeds(const Seeds& seeds);
void e57_seeds(const Seeds& seeds);
void las_seeds(const Seeds& seeds);
void laz_seeds(const Seeds& seeds);
void obj_seeds(const Seeds& seeds);
void pcd_seeds(const Seeds& seeds);
void picture_seeds(const Seeds& exr, const Seeds& hdr, const Seeds& png, const Seeds& jpeg);
void ply_seeds(const Seeds& seeds);
void text_seeds(const Seeds& seeds);

}  // namespace lucarne::fuzz
