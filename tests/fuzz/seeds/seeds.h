#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lucarne::fuzz {

/// Writes the seeds of one target.
class Seeds {
 public:
    explicit Seeds(std::filesystem::path folder);

    /// Adds a seed of any kind.
    void add(std::string_view name, std::string_view bytes) const;
    /// Adds a scan file. It must open and give points to its end, because a seed that is refused is useless.
    void add_scan(std::string_view name, std::string_view bytes) const;
    /// Returns the file that a writer left at `path`, as a seed.
    static std::string taken(const std::filesystem::path& path);
    const std::filesystem::path& folder() const { return folder_; }

 private:
    std::filesystem::path folder_;
};

// One function for each format, each in its own file: small valid files of every variant.
void bake_seeds(const Seeds& seeds);
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
