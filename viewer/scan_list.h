#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/core/error.h"
#include "io/formats/scan.h"

namespace lucarne::viewer {

/// Of the files that may be scans: ".las", in lower case.
std::span<const std::string_view> scan_extensions();
/// Whether the name ends like that of a scan, text and meshes among them.
bool names_scan(const std::filesystem::path& path);

/// The files that are meant: a folder stands for the scans in it and below (by their extension: .las .laz
/// .e57 .ply .pcd .ptx .pts .xyz .asc), sorted by name; anything else for itself. Errors: folders that cannot
/// be read or hold none.
Result<std::vector<std::string>> expand_folders(const std::vector<std::string>& inputs);

/// Inputs that were left out, and why: one broken file of many stops only itself.
class SetAside {
 public:
    SetAside(size_t inputs, io::ReadOptions options) : inputs_(inputs), options_(std::move(options)) {}

    /// Takes the input whose bytes are not what they claim to be out of several and notes it, with how many
    /// points could be saved of it. Any other error is given back, with the same advice.
    Result<void> take(Error error, std::vector<std::string>& inputs);
    /// Fails with the summary where any input was left out.
    Result<void> result(const std::string& output, std::string_view fate = "are not in it") const;

 private:
    size_t inputs_;
    io::ReadOptions options_;
    std::vector<std::string> lines_;
};

}  // namespace lucarne::viewer
