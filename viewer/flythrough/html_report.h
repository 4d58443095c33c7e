#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace lucarne::viewer {

/// Returns reports of flights (flight_report) as one HTML page: figures, plots over the path, machine and
/// build. The page opens from disk and loads nothing from the network.
std::string html_report(const std::vector<nlohmann::ordered_json>& flights);

/// Returns a name that distinguishes a flight from the others on a page, for example "vpl, cold".
std::string flight_name(const nlohmann::ordered_json& flight);

}  // namespace lucarne::viewer
