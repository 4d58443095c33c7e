#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/core/error.h"
#include "io/formats/scan.h"

namespace lucarne::viewer {

/// "a, b and 3 more": the first five.
std::string some_of(const std::vector<std::string>& names);

/// Of the files that may be scans: ".las", in lower case.
std::span<const std::string_view> scan_extensions();
/// Whether the name ends in one of them.
bool names_scan(const std::filesystem::path& path);

/// Each file once, however often and by whatever names, links and spellings it is there; the others are
/// named.
std::vector<std::string> once_each(const std::vector<std::string>& paths);

/// What inputs stand for.
struct ScanList {
    std::vector<std::string> files;
    std::vector<Error> problems;  ///< of folders; `what` is the folder
};

/// A folder stands for the scans in it and below, sorted by name: files that are named so, and .txt where
/// their rows are numbers; anything else stands for itself. Links to folders are not followed. What a folder
/// holds besides is named, and so is what was given twice. Folders that cannot be read or hold no scan are
/// problems among several inputs, and an error where nothing is left.
Result<ScanList> expand_folders(const std::vector<std::string>& inputs, const io::ReadOptions& options);

/// Inputs that were left out, and why: one broken file of many stops only itself.
class SetAside {
 public:
    /// `list.problems` are such already.
    SetAside(const ScanList& list, io::ReadOptions options);

    /// Takes the input whose bytes are not what they claim to be out of several and notes it, with how many
    /// points could be saved of it. Any other error is given back, with the same advice.
    Result<void> take(Error error, std::vector<std::string>& inputs);
    /// Fails with the summary where any input was left out.
    Result<void> result(const std::string& output, std::string_view fate = "are not in it") const;
    /// A list of {"kind": "rejected", "path", "reason"}.
    nlohmann::ordered_json json() const;

 private:
    size_t inputs_;
    io::ReadOptions options_;
    std::vector<Error> errors_;
};

}  // namespace lucarne::viewer
