#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace lucarne::viewer {

/// Reports of flights (flight_report) as one page: figures, plots over the path, machine and build. It opens
/// from disk and asks nothing of the network.
std::string html_report(const std::vector<nlohmann::ordered_json>& flights);

/// "vpl, cold": how a flight is told from the others of a page.
std::string flight_name(const nlohmann::ordered_json& flight);

}  // namespace lucarne::viewer
