#include "io/formats/common/remarks.h"

#include <fmt/format.h>

#include "io/formats/common/format.h"
#include "io/formats/common/stations.h"
#include "io/formats/common/text.h"

namespace lucarne::io {

Result<Remarks> remarks_of(const std::string& file, const std::vector<std::string>& comments) {
    Remarks remarks;
    for (const std::string& comment : comments) {
        std::string_view rest = comment;
        if (next_word(rest) != "lucarne") continue;
        const auto key = next_word(rest);
        bool good = true;
        if (key == "station") {
            const auto id = parse_number<uint32_t>(next_word(rest));
            Station station{id.value_or(0), {}};
            for (int axis = 0; axis < 3; ++axis) {
                const auto value = parse_number<double>(next_word(rest));
                good = good && value && usable(*value);
                station.position[axis] = value.value_or(0);
            }
            good = good && id && remarks.stations.size() < kMostStations;
            remarks.stations.push_back(station);
        } else if (key == "color_bits") {
            remarks.color_bits = parse_number<uint32_t>(next_word(rest));
            good = remarks.color_bits == 0u || remarks.color_bits == 8u || remarks.color_bits == 16u;
        } else if (key == "metres_per_unit") {
            remarks.metres_per_unit = parse_number<double>(next_word(rest));
            good =
                remarks.metres_per_unit && *remarks.metres_per_unit > 1e-9 && *remarks.metres_per_unit < 1e9;
        }
        if (!good)
            return rejected(
                file, fmt::format("has a comment that cannot be understood: '{}'", comment.substr(0, 80)));
    }
    return remarks;
}

std::string remark_lines(const ScanInfo& info, std::string_view prefix) {
    std::string lines;
    for (const Station& s : info.stations)
        lines += fmt::format("{}lucarne station {} {} {} {}\n", prefix, s.id, s.position.x, s.position.y,
                             s.position.z);
    lines += fmt::format("{}lucarne color_bits {}\n", prefix, info.color_bits);
    if (info.metres_per_unit != 1.0)
        lines += fmt::format("{}lucarne metres_per_unit {}\n", prefix, info.metres_per_unit);
    return lines;
}

}  // namespace lucarne::io
