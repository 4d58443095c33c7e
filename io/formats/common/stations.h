#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/points.h"

namespace lucarne::io {

/// Returns `{"stations":[{"id":1,"position":[x,y,z]}]}`, the content of Lucarne's LAS record.
std::string stations_to_json(const std::vector<Station>& stations);
/// Reads such a text. Rejects missing or non-finite numbers and more than kMostStations. `file` names the
/// file in errors.
Result<std::vector<Station>> stations_from_json(const std::string& file, std::string_view text);

inline constexpr size_t kMostStations = 65536;  ///< point_source_id has 16 bits

}  // namespace lucarne::io
