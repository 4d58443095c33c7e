#include "io/formats/common/stations.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/formats/common/format.h"

namespace lucarne::io {

std::string stations_to_json(const std::vector<Station>& stations) {
    nlohmann::json list = nlohmann::json::array();
    for (const Station& s : stations)
        list.push_back({{"id", s.id}, {"position", {s.position.x, s.position.y, s.position.z}}});
    return nlohmann::json{{"stations", list}}.dump();
}

Result<std::vector<Station>> stations_from_json(const std::string& file, std::string_view text) {
    const auto wrong = [&](std::string_view why) {
        return rejected(file, fmt::format("its station poses {}", why));
    };
    if (text.size() > 256 * kMostStations) return wrong("are too many");
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("stations") || !json["stations"].is_array())
        return wrong("are not a JSON object with a list of stations");
    if (json["stations"].size() > kMostStations) return wrong("are too many");
    std::vector<Station> stations;
    for (const auto& entry : json["stations"]) {
        if (!entry.is_object() || !entry.contains("id") || !entry["id"].is_number_unsigned() ||
            entry["id"].get<uint64_t>() > 0xffffffffu || !entry.contains("position"))
            return wrong("lack an id or a position");
        const auto& at = entry["position"];
        Station station{static_cast<uint32_t>(entry["id"].get<uint64_t>()), {}};
        if (!at.is_array() || at.size() != 3) return wrong("have a position that is not three numbers");
        for (int axis = 0; axis < 3; ++axis) {
            const auto& value = at[static_cast<size_t>(axis)];
            if (!value.is_number() || !usable(value.get<double>()))
                return wrong("have a position that is not finite");
            station.position[axis] = value.get<double>();
        }
        stations.push_back(station);
    }
    return stations;
}

}  // namespace lucarne::io
