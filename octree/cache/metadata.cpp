#include "octree/cache/metadata.h"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/formats/notes_json.h"
#include "octree/cache/format.h"

namespace lucarne::octree {
namespace {

using nlohmann::json;

constexpr int kMaxNesting = 32;
constexpr uint32_t kMostDoublings = 20;
constexpr double kFarthest = 1e31;  // readers drop coordinates above 1e30: no square overflows

/// Thrown and caught in this file only. nlohmann's accessors throw as well, so one handler catches both.
struct Mistake : std::runtime_error {
    using std::runtime_error::runtime_error;
};
void require(bool condition, const char* text) {
    if (!condition) throw Mistake(text);
}

json vector_json(const glm::dvec3& v) {
    return json::array({v.x, v.y, v.z});
}

double number(const json& value) {
    require(value.is_number() && std::isfinite(value.get<double>()), "a finite number is expected");
    return value.get<double>();
}

glm::dvec3 vector_of(const json& value) {
    require(value.is_array() && value.size() == 3, "three numbers are expected");
    return {number(value[0]), number(value[1]), number(value[2])};
}

std::string_view position_name(io::PositionType type) {
    switch (type) {
        case io::PositionType::i32_scaled:
            return "i32_scaled";
        case io::PositionType::f32:
            return "f32";
        case io::PositionType::f64:
            break;
    }
    return "f64";
}

json schema_json(const io::Schema& schema) {
    json attributes = json::array();
    for (const auto& a : schema.attributes)
        attributes.push_back(
            {{"name", a.name}, {"type", io::scalar_name(a.type)}, {"components", a.components}});
    json result{{"position", position_name(schema.position)}, {"attributes", std::move(attributes)}};
    if (schema.position == io::PositionType::i32_scaled) {
        result["scale"] = vector_json(schema.scale);
        result["offset"] = vector_json(schema.offset);
    }
    return result;
}

io::Schema schema_of(const json& value) {
    io::Schema schema;
    const auto position = value.at("position").get<std::string>();
    if (position == "i32_scaled") {
        schema.position = io::PositionType::i32_scaled;
        schema.scale = vector_of(value.at("scale"));
        schema.offset = vector_of(value.at("offset"));
    } else {
        require(position == "f32" || position == "f64", "an unknown position type");
        schema.position = position == "f32" ? io::PositionType::f32 : io::PositionType::f64;
    }
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    std::set<std::string> seen;
    for (const auto& item : value.at("attributes")) {
        const auto type = io::scalar_type(item.at("type").get<std::string>());
        const auto& components = item.at("components");
        require(type.has_value(), "an unknown attribute type");
        require(components.is_number_unsigned() && components >= 1 && components <= format::kMaxStride,
                "an attribute with an impossible number of components");
        const auto name = item.at("name").get<std::string>();
        require(seen.insert(name).second, "two attributes of one name");
        schema.add(name, *type, components.get<uint32_t>());
        require(schema.stride <= format::kMaxStride, "records of more than 64 KiB");
    }
    return schema;
}

json scan_json(const io::ScanInfo& scan) {
    json stations = json::array();
    for (const auto& s : scan.stations)
        stations.push_back({{"id", s.id}, {"position", vector_json(s.position)}});
    json result{{"path", scan.path},
                {"format", scan.format},
                {"declared_points", scan.declared_points},
                {"file_bytes", scan.file_bytes},
                {"modified", scan.modified},
                {"metres_per_unit", scan.metres_per_unit},
                {"color_bits", scan.color_bits},
                {"stations", std::move(stations)},
                {"details", io::notes_text(scan.notes)}};
    if (!scan.coordinate_system.empty()) result["coordinate_system"] = scan.coordinate_system;
    if (scan.epsg) result["epsg"] = scan.epsg;
    for (const auto& loss : scan.losses)
        result["losses"].push_back({{"what", loss.what}, {"count", loss.count}});
    return result;
}

io::ScanInfo scan_of(const json& value) {
    io::ScanInfo scan;
    scan.path = value.at("path").get<std::string>();
    scan.format = value.at("format").get<std::string>();
    scan.declared_points = value.at("declared_points").get<uint64_t>();
    scan.file_bytes = value.value("file_bytes", uint64_t{0});
    scan.modified = value.value("modified", int64_t{0});
    scan.metres_per_unit = number(value.at("metres_per_unit"));
    scan.color_bits = value.value("color_bits", scan.color_bits);
    require(scan.color_bits == 0 || scan.color_bits == 8 || scan.color_bits == 16,
            "colours of an unknown width");
    for (const auto& s : value.at("stations"))
        scan.stations.push_back({s.at("id").get<uint32_t>(), vector_of(s.at("position"))});
    scan.notes = io::notes_of_text(value.at("details").get_ref<const std::string&>());
    scan.coordinate_system = value.value("coordinate_system", std::string());
    scan.epsg = value.value("epsg", uint32_t{0});
    if (value.contains("losses"))
        for (const auto& loss : value.at("losses"))
            scan.losses.push_back({loss.at("what").get<std::string>(), loss.at("count").get<uint64_t>()});
    return scan;
}

json colour_json(const StationColour& colour) {
    json result{{"scan", colour.scan}, {"gain", vector_json(colour.gain)}};
    if (colour.station) result["station"] = *colour.station;
    if (colour.unphotographed) result["unphotographed"] = vector_json(*colour.unphotographed);
    return result;
}

uint32_t index_of(const json& value, uint64_t end) {
    require(value.is_number_unsigned() && value.get<uint64_t>() < end, "an index that is too large");
    return value.get<uint32_t>();
}

std::vector<StationColour> colours_of(const json& value, size_t scans) {
    require(value.is_array() && value.size() <= kMostStationColours, "a list of colours is expected");
    std::vector<StationColour> colours;
    for (const auto& item : value) {
        StationColour colour{.scan = index_of(item.at("scan"), scans)};
        if (item.contains("station")) colour.station = index_of(item.at("station"), UINT16_MAX + 1);
        colour.gain = vector_of(item.at("gain"));
        if (item.contains("unphotographed")) colour.unphotographed = vector_of(item.at("unphotographed"));
        for (int c = 0; c < 3; ++c) {
            require(colour.gain[c] >= 1 / kMostGain && colour.gain[c] <= kMostGain, "an impossible gain");
            require(!colour.unphotographed ||
                        ((*colour.unphotographed)[c] >= 0 && (*colour.unphotographed)[c] <= 1),
                    "an impossible colour");
        }
        const auto key = [](const StationColour& c) { return std::pair(c.scan, c.station); };
        require(colours.empty() || key(colours.back()) < key(colour), "colours in a wrong order");
        colours.push_back(colour);
    }
    return colours;
}

std::vector<EstimatedStation> estimated_stations_of(const json& value,
                                                    const std::vector<io::ScanInfo>& scans) {
    require(value.is_array() && value.size() <= kMostEstimatedStations, "a list of stations is expected");
    std::vector<EstimatedStation> stations;
    for (const auto& item : value) {
        const EstimatedStation station{index_of(item.at("scan"), scans.size()),
                                       vector_of(item.at("position")), item.value("saw_all", false)};
        require(scans[station.scan].stations.empty(), "estimated stations of a scan that states its own");
        require(stations.empty() || stations.back().scan <= station.scan, "stations in a wrong order");
        const bool alone = stations.empty() || stations.back().scan != station.scan;
        require(alone || !(stations.back().saw_all || station.saw_all), "two stations, of which one saw all");
        for (int axis = 0; axis < 3; ++axis)
            require(std::abs(station.position[axis]) <= kFarthest, "a station too far from the origin");
        stations.push_back(station);
    }
    return stations;
}

json filling_json(const FillingSection& filling) {
    json result{{"points", filling.points}};
    if (filling.points == 0) return result;
    result["schema"] = schema_json(filling.schema);
    result["offset"] = filling.offset;
    result["bytes"] = filling.bytes;
    result["codec"] = filling.codec;
    result["checksum"] = filling.checksum;
    return result;
}

uint64_t unsigned_of(const json& value) {
    require(value.is_number_unsigned(), "a number that is not negative is expected");
    return value.get<uint64_t>();
}

FillingSection filling_of(const json& value) {
    FillingSection filling;
    filling.points = unsigned_of(value.at("points"));
    require(filling.points <= kMostFilled, "more synthetic surfels than a cache can have");
    if (filling.points == 0) return filling;
    filling.schema = schema_of(value.at("schema"));
    require(filling.schema.position == io::PositionType::i32_scaled,
            "synthetic surfels with an impossible position");
    filling.offset = unsigned_of(value.at("offset"));
    filling.bytes = unsigned_of(value.at("bytes"));
    filling.checksum = unsigned_of(value.at("checksum"));
    filling.codec = static_cast<uint8_t>(index_of(value.at("codec"), format::kCodecColumns + 1));
    return filling;
}

DirectoryPages directory_pages_of(const json& value) {
    DirectoryPages pages;
    pages.nodes = index_of(value.at("nodes"), format::kMostPageNodes + 1);
    require(pages.nodes >= format::kLeastPageNodes, "pages of too few nodes");
    pages.offset = unsigned_of(value.at("offset"));
    pages.checksum = unsigned_of(value.at("checksum"));
    return pages;
}

json root_json(const Cube& root) {
    json result{{"min", vector_json(root.min)}, {"size", root.size}};
    if (root.doublings)
        result["first"] = {
            {"min", vector_json(root.first_min)}, {"doublings", root.doublings}, {"cell", root.first_cell}};
    return result;
}

/// Whether places in the cube can be computed (Cube::place).
bool has_places(const Cube& root) {
    return root.size <= kFarthest && root.first_size() > 0 && std::isfinite(0x1p32 / root.first_size());
}

Cube root_of(const json& value) {
    Cube root{vector_of(value.at("min")), number(value.at("size"))};
    require(has_places(root), "a root cube of an impossible size");
    if (!value.contains("first")) return root;
    const json& first = value.at("first");
    root.first_min = vector_of(first.at("min"));
    const auto& doublings = first.at("doublings");
    require(doublings.is_number_unsigned() && doublings >= 1 && doublings <= kMostDoublings,
            "an impossible number of doublings");
    root.doublings = doublings.get<uint32_t>();
    const auto& cell = first.at("cell");
    require(cell.is_array() && cell.size() == 3, "three numbers are expected");
    for (size_t axis = 0; axis < 3; ++axis) {
        require(cell[axis].is_number_unsigned() && cell[axis] < uint64_t{1} << root.doublings,
                "a first cube outside the root cube");
        root.first_cell[axis] = cell[axis].get<uint32_t>();
        require(std::abs(root.first_min[static_cast<int>(axis)]) <= kFarthest,
                "a first cube too far from the origin");
    }
    require(has_places(root), "a root cube of an impossible size");
    return root;
}

}  // namespace

std::string metadata_text(const SourceHeader& header) {
    json scans = json::array();
    for (const auto& scan : header.scans) scans.push_back(scan_json(scan));
    json layouts = json::array();
    for (const auto& layout : header.layouts) layouts.push_back(schema_json(layout));
    json root{{"schema", schema_json(header.schema)},
              {"root", root_json(header.root)},
              {"bounds", {{"min", vector_json(header.min)}, {"max", vector_json(header.max)}}},
              {"points", header.points},
              {"metres_per_unit", header.metres_per_unit},
              {"scans", std::move(scans)}};
    if (!header.options.empty()) root["options"] = header.options;
    if (!header.layouts.empty()) root["layouts"] = std::move(layouts);
    for (const auto& colour : header.station_colours) root["station_colours"].push_back(colour_json(colour));
    for (const auto& station : header.estimated_stations) {
        auto& entry = root["estimated_stations"].emplace_back(
            json{{"scan", station.scan}, {"position", vector_json(station.position)}});
        if (station.saw_all) entry["saw_all"] = true;
    }
    if (header.filling) root["filling"] = filling_json(*header.filling);
    if (const auto& pages = header.directory_pages)
        root["directory_pages"] = {
            {"nodes", pages->nodes}, {"offset", pages->offset}, {"checksum", pages->checksum}};
    // File names are bytes and not always UTF-8. Invalid sequences become U+FFFD instead of an exception.
    return root.dump(1, ' ', false, json::error_handler_t::replace);
}

Result<SourceHeader> parse_metadata(const std::string& file, std::string_view text) {
    try {
        const auto shallow = [](int depth, json::parse_event_t, json&) {
            require(depth <= kMaxNesting, "nested too deep");
            return true;
        };
        const json root = json::parse(text.begin(), text.end(), shallow);
        SourceHeader header;
        header.schema = schema_of(root.at("schema"));
        if (root.contains("layouts"))
            for (const auto& layout : root.at("layouts")) header.layouts.push_back(schema_of(layout));
        require(header.layouts.size() <= kMostLayouts, "more layouts than a node can refer to");
        header.root = root_of(root.at("root"));
        header.min = vector_of(root.at("bounds").at("min"));
        header.max = vector_of(root.at("bounds").at("max"));
        for (int axis = 0; axis < 3; ++axis)
            require(header.min[axis] <= header.max[axis] && std::abs(header.root.min[axis]) <= kFarthest,
                    "impossible bounds");
        header.points = root.at("points").get<uint64_t>();
        header.metres_per_unit = number(root.at("metres_per_unit"));
        require(header.metres_per_unit > 0, "a unit whose length is not positive");
        header.options = root.value("options", std::string());
        for (const auto& scan : root.at("scans")) header.scans.push_back(scan_of(scan));
        if (root.contains("station_colours"))
            header.station_colours = colours_of(root.at("station_colours"), header.scans.size());
        if (root.contains("estimated_stations"))
            header.estimated_stations = estimated_stations_of(root.at("estimated_stations"), header.scans);
        if (root.contains("filling")) header.filling = filling_of(root.at("filling"));
        if (root.contains("directory_pages"))
            header.directory_pages = directory_pages_of(root.at("directory_pages"));
        return header;
    } catch (const std::exception& error) {
        return rejected(file, fmt::format("its metadata is damaged ({})", error.what()),
                        "convert the scan again");
    }
}

}  // namespace lucarne::octree
