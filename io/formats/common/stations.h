#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/points.h"

namespace lucarne::io {

/// `{"stations":[{"id":1,"position":[x,y,z]}]}`, as our LAS record holds it.
std::string stations_to_json(const std::vector<Station>& stations);
/// `file` names the file in errors. Missing or non-finite numbers and more than kMostStations are rejected.
Result<std::vector<Station>> stations_from_json(const std::string& file, std::string_view text);

inline constexpr size_t kMostStations = 65536;  ///< point_source_id has 16 bits

}  // namespace lucarne::io
