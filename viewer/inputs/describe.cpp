#include "viewer/inputs/describe.h"

#include <fmt/format.h>

#include "io/core/counted.h"
#include "io/formats/mesh/source.h"
#include "io/formats/notes_json.h"
#include "viewer/inputs/units.h"

namespace lucarne::viewer {

using json = nlohmann::ordered_json;

json vector_json(const glm::dvec3& v) {
    return json::array({v.x, v.y, v.z});
}

json attributes_json(const io::Schema& schema) {
    json list = json::array();
    for (const auto& a : schema.attributes)
        list.push_back({{"name", a.name}, {"type", io::scalar_name(a.type)}, {"components", a.components}});
    return list;
}

json losses_json(const io::Losses& losses) {
    json list = json::array();
    for (const auto& loss : losses) list.push_back({{"count", loss.count}, {"what", loss.what}});
    return list;
}

std::string losses_text(const io::Losses& losses) {
    std::string text;
    for (const auto& loss : losses) text += (text.empty() ? "" : ", ") + counted(loss.count, loss.what);
    return text;
}

json scan_json(const io::ScanInfo& info, const io::Schema& schema, const io::Contents* contents) {
    json stations = json::array();
    for (const auto& s : info.stations)
        stations.push_back({{"id", s.id}, {"position", vector_json(s.position)}});
    json described = {{"kind", "scan"}, {"path", info.path}, {"format", info.format}};
    if (contents) described["points"] = contents->points;
    described["declared_points"] = info.declared_points;
    if (contents && contents->points > 0) {
        described["min"] = vector_json(contents->min);
        described["max"] = vector_json(contents->max);
    }
    if (!contents && io::mesh::is_sampled(info)) {
        const auto& samples = *info.notes.mesh->samples;
        described.update({{"expected_points", samples.count},
                          {"min", vector_json(samples.min)},
                          {"max", vector_json(samples.max)}});
    }
    if (info.stated_box) {
        described["stated_min"] = vector_json(info.stated_box->front());
        described["stated_max"] = vector_json(info.stated_box->back());
    }
    described["bytes_per_point"] = schema.stride;
    described["coordinate_system"] = info.coordinate_system;
    described["epsg"] = info.epsg ? json(info.epsg) : json();
    described["unit"] = unit_name(info.metres_per_unit);
    described["metres_per_unit"] = info.metres_per_unit;
    described["unit_stated"] = info.unit_stated;
    described["stations"] = std::move(stations);
    described["attributes"] = attributes_json(schema);
    if (schema.find(io::names::color))
        described["color_bits"] = std::max(info.color_bits, contents ? contents->color_bits : 0u);
    described["left_out"] = losses_json(contents ? contents->losses : info.losses);
    const json notes = json::parse(io::notes_text(info.notes));
    for (const char* list : {"scans", "images", "mesh"})
        if (notes.contains(list)) described[list] = notes[list];
    return described;
}

}  // namespace lucarne::viewer
