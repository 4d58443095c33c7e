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

/// Returns the first five names as text: "a, b and 3 more".
std::string some_of(const std::vector<std::string>& names);

/// Returns the extensions of scan files in lower case, for example ".las".
std::span<const std::string_view> scan_extensions();
/// Returns whether the name has one of these extensions.
bool names_scan(const std::filesystem::path& path);

/// Returns each file once, even if it is listed several times under different names, links or spellings.
/// Warns of the duplicates.
std::vector<std::string> once_each(const std::vector<std::string>& paths);

/// The files that the inputs stand for.
struct ScanList {
    std::vector<std::string> files;
    std::vector<Error> problems;  ///< problems of folders; `what` is the folder
};

/// Replaces each folder by the scans in it and below, sorted by name: files with a scan's extension, and .txt
/// files whose rows are numbers. Any other input stands for itself. Links to folders are not followed. Warns
/// of other files in folders and of duplicates. A folder that cannot be read or contains no scan is noted in
/// `problems` if there are other inputs; it is an error if nothing is left.
Result<ScanList> expand_folders(const std::vector<std::string>& inputs, const io::ReadOptions& options);

/// Inputs that were left out, and why. One broken file does not stop the other inputs.
class SetAside {
 public:
    /// Begins with `list.problems`.
    SetAside(const ScanList& list, io::ReadOptions options);

    /// If the error rejects one of several inputs, removes that input from `inputs` and notes it, with the
    /// number of points that could be salvaged. Returns any other error, with the same advice.
    Result<void> take(Error error, std::vector<std::string>& inputs);
    /// Returns an error with a summary if any input was left out.
    Result<void> result(const std::string& output, std::string_view fate = "are not in it") const;
    /// Returns a list of {"kind": "rejected", "path", "reason"}.
    nlohmann::ordered_json json() const;

 private:
    size_t inputs_;
    io::ReadOptions options_;
    std::vector<Error> errors_;
};

}  // namespace lucarne::viewer
