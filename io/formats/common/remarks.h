#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/points.h"

// What Lucarne's own comments in a text header say: "lucarne station ID X Y Z", "lucarne color_bits N",
// "lucarne metres_per_unit M".
namespace lucarne::io {

struct Remarks {
    std::vector<Station> stations;
    std::optional<uint32_t> color_bits;
    std::optional<double> metres_per_unit;
};
/// Comments of others are passed over. `file` names the file in errors: a comment of ours that makes no
/// sense.
Result<Remarks> remarks_of(const std::string& file, const std::vector<std::string>& comments);
/// The lines that say the same of `info`, each behind `prefix` ("comment ").
std::string remark_lines(const ScanInfo& info, std::string_view prefix);

}  // namespace lucarne::io
