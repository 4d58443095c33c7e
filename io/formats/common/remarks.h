#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/points.h"

// Lucarne's own comments in a text header: "lucarne station ID X Y Z", "lucarne color_bits N", "lucarne
// metres_per_unit M".
namespace lucarne::io {

struct Remarks {
    std::vector<Station> stations;
    std::optional<uint32_t> color_bits;
    std::optional<double> metres_per_unit;
};
/// Reads these comments and skips all others. Errors: a comment of Lucarne that is malformed; `file` names
/// the file in the error.
Result<Remarks> remarks_of(const std::string& file, const std::vector<std::string>& comments);
/// Returns the lines with these comments for `info`, each after `prefix` ("comment ").
std::string remark_lines(const ScanInfo& info, std::string_view prefix);

}  // namespace lucarne::io
