#include "io/formats/notes_json.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "io/formats/common/base64.h"
#include "io/formats/las/header.h"
#include "io/formats/ply/header.h"

namespace lucarne::io {
namespace {

using json = nlohmann::json;

json vector_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

json records_json(const std::vector<LasRecord>& records) {
    json list = json::array();
    for (const LasRecord& record : records)
        list.push_back({{"user_id", record.user_id},
                        {"record_id", record.record_id},
                        {"description", record.description},
                        {"extended", record.extended},
                        {"data", to_base64(record.data)}});
    return list;
}

void add_las(const LasNotes& h, json& to) {
    to["minor_version"] = h.minor;
    to["point_format"] = h.point_format;
    to["record_length"] = h.record_length;
    to["file_source_id"] = h.file_source_id;
    to["global_encoding"] = h.global_encoding;
    to["guid"] = to_base64(std::as_bytes(std::span(h.guid)));
    to["system_id"] = h.system_id;
    to["software"] = h.software;
    to["creation_day"] = h.creation_day;
    to["creation_year"] = h.creation_year;
    to["scale"] = vector_json(h.scale);
    to["offset"] = vector_json(h.offset);
    to["records"] = records_json(h.vlrs);
}

void add_ply(const PlyNotes& ply, json& to) {
    json properties = json::array();
    for (const auto& p : ply.properties)
        properties.push_back({{"name", p.name}, {"type", ply::word_of(p.type)}});
    to["properties"] = std::move(properties);
    to["comments"] = ply.comments;
    to["obj_info"] = ply.infos;
}

void add_pcd(const PcdNotes& pcd, json& to) {
    to["width"] = pcd.width;
    to["height"] = pcd.height;
    to["viewpoint"] = pcd.viewpoint;
}

json scan_json(const E57Notes::Scan& scan) {
    json to = {{"name", scan.name}, {"guid", scan.guid}, {"points", scan.points}, {"fields", scan.fields}};
    if (scan.position) to["position"] = vector_json(*scan.position);
    if (scan.rotation) {
        json rows = json::array();
        for (const glm::dvec3& row : *scan.rotation) rows.push_back(vector_json(row));
        to["rotation"] = std::move(rows);
    }
    if (scan.intensity_limits) to["intensity_limits"] = *scan.intensity_limits;
    if (scan.color_maximum) to["color_maximum"] = *scan.color_maximum;
    if (scan.stated_min) to["stated_min"] = vector_json(*scan.stated_min);
    if (scan.stated_max) to["stated_max"] = vector_json(*scan.stated_max);
    return to;
}

void add_e57(const E57Notes& e57, json& to) {
    json scans = json::array(), images = json::array();
    for (const auto& scan : e57.scans) scans.push_back(scan_json(scan));
    for (const auto& image : e57.images)
        images.push_back({{"name", image.name},
                          {"representation", image.representation},
                          {"encoding", image.encoding},
                          {"bytes", image.bytes},
                          {"width", image.width},
                          {"height", image.height}});
    to["guid"] = e57.guid;
    to["library"] = e57.library;
    to["coordinate_system"] = e57.coordinate_system;
    to["scans"] = std::move(scans);
    to["images"] = std::move(images);
    to["image_count"] = e57.image_count;
}

json mesh_json(const MeshNotes& mesh) {
    json to = {{"vertices", mesh.vertices}, {"triangles", mesh.triangles}, {"textures", mesh.textures}};
    const auto add = [&](const char* key, uint64_t count) {
        if (count > 0) to[key] = count;
    };
    add("faces", mesh.faces);
    add("left_out_lines_points_curves", mesh.other_statements);
    add("coordinates_and_normals_not_there", mesh.missing_corners);
    add("left_out_without_area", mesh.without_area);
    add("left_out_not_finite", mesh.not_finite);
    if (!mesh.samples) return to;
    to["area_m2"] = mesh.samples->area_m2;
    to["spacing_m"] = mesh.samples->spacing_m;
    to["samples"] = mesh.samples->count;
    to["min"] = vector_json(mesh.samples->min);
    to["max"] = vector_json(mesh.samples->max);
    return to;
}

/// Returns a member of an object; null if it is missing.
const json* member(const json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

std::string text_at(const json& object, const char* key) {
    const json* value = member(object, key);
    return value && value->is_string() ? value->get<std::string>() : std::string();
}

uint64_t whole_at(const json& object, const char* key) {
    const json* value = member(object, key);
    return value && value->is_number_unsigned() ? value->get<uint64_t>() : 0;
}

/// Returns a list, which is empty if there is none.
const json& list_at(const json& object, const char* key) {
    static const json kEmpty = json::array();
    const json* value = member(object, key);
    return value && value->is_array() ? *value : kEmpty;
}

/// Numbers that are not finite are null in JSON.
std::optional<double> number_of(const json& value) {
    if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

template <size_t kCount>
std::optional<std::array<double, kCount>> numbers_of(const json* value) {
    if (!value || !value->is_array() || value->size() != kCount) return std::nullopt;
    std::array<double, kCount> numbers{};
    for (size_t i = 0; i < kCount; ++i) {
        const auto number = number_of((*value)[i]);
        if (!number) return std::nullopt;
        numbers[i] = *number;
    }
    return numbers;
}

std::optional<glm::dvec3> vector_of(const json* value) {
    const auto numbers = numbers_of<3>(value);
    return numbers ? std::optional(glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2])) : std::nullopt;
}

std::vector<std::string> texts_at(const json& object, const char* key) {
    std::vector<std::string> texts;
    for (const json& text : list_at(object, key))
        if (text.is_string()) texts.push_back(text.get<std::string>());
    return texts;
}

/// Returns the records of a list; empty if it is not a list of records.
std::optional<std::vector<LasRecord>> records_of(const json& list) try {
    if (!list.is_array()) return std::nullopt;
    std::vector<LasRecord> records;
    for (const json& record : list) {
        auto data = from_base64(record.at("data").get_ref<const std::string&>());
        const json& id = record.at("record_id");
        if (!data || !id.is_number_unsigned() || id.get<uint64_t>() > 0xffff) return std::nullopt;
        records.push_back({record.at("user_id").get<std::string>(), id.get<uint16_t>(),
                           record.at("description").get<std::string>(), record.at("extended").get<bool>(),
                           std::move(*data)});
    }
    return records;
} catch (const json::exception&) {
    return std::nullopt;
}

/// Fills in the valid fields. Returns why no header can be made of them; empty if one can.
std::string read_las(const json& from, LasNotes& h) try {
    // These three count even if the rest of the header does not: lattice_of, projection_records and
    // extras_record use them.
    h.scale = vector_of(member(from, "scale")).value_or(glm::dvec3(0.0));
    h.offset = vector_of(member(from, "offset")).value_or(glm::dvec3(0.0));
    auto records = records_of(list_at(from, "records"));
    if (records) h.vlrs = std::move(*records);

    // Each number must fit its field: add_las wrote none that does not.
    const auto number = [&](const char* key, uint64_t largest) {
        const json& value = from.at(key);
        if (!value.is_number_unsigned() || value.get<uint64_t>() > largest) throw std::out_of_range(key);
        return value.get<uint64_t>();
    };
    h.minor = static_cast<uint8_t>(number("minor_version", 4));
    h.point_format = static_cast<uint8_t>(number("point_format", 8));
    h.record_length = static_cast<uint16_t>(number("record_length", 0xffff));
    h.file_source_id = static_cast<uint16_t>(number("file_source_id", 0xffff));
    h.global_encoding = static_cast<uint16_t>(number("global_encoding", 0xffff));
    h.creation_day = static_cast<uint16_t>(number("creation_day", 0xffff));
    h.creation_year = static_cast<uint16_t>(number("creation_year", 0xffff));
    h.system_id = from.at("system_id").get<std::string>();
    h.software = from.at("software").get<std::string>();
    const auto guid = from_base64(from.at("guid").get_ref<const std::string&>());
    if (!guid || guid->size() != h.guid.size()) throw std::out_of_range("guid");
    std::memcpy(h.guid.data(), guid->data(), h.guid.size());
    if (!records || !from.at("records").is_array()) throw std::out_of_range("records");
    const uint16_t least = las::record_bytes(h.point_format);
    if (least == 0 || h.record_length < least) throw std::out_of_range("point_format");
    return {};
} catch (const std::exception& error) {  // from nlohmann's library, or the out_of_range above
    return error.what();
}

PlyNotes ply_of(const json& from) {
    PlyNotes ply;
    ply.comments = texts_at(from, "comments");
    ply.infos = texts_at(from, "obj_info");
    for (const json& p : list_at(from, "properties")) {
        const auto type = ply::type_of(text_at(p, "type"));
        std::string name = text_at(p, "name");
        if (!type || name.empty() || name.find_first_of(" \t\r\n") != name.npos) {
            ply.properties.clear();  // one wrong entry discards the whole list
            break;
        }
        ply.properties.push_back({std::move(name), *type});
    }
    return ply;
}

std::optional<PcdNotes> pcd_of(const json& from) {
    const json& viewpoint = list_at(from, "viewpoint");
    PcdNotes pcd{whole_at(from, "width"), whole_at(from, "height")};
    if (viewpoint.size() != pcd.viewpoint.size()) return std::nullopt;
    for (size_t i = 0; i < viewpoint.size(); ++i)
        pcd.viewpoint[i] = viewpoint[i].is_number() ? viewpoint[i].get<double>() : 0.0;
    return pcd;
}

E57Notes::Scan scan_of(const json& from) {
    E57Notes::Scan scan{text_at(from, "name"), text_at(from, "guid"), whole_at(from, "points"),
                        texts_at(from, "fields")};
    scan.position = vector_of(member(from, "position"));
    const json& rows = list_at(from, "rotation");
    if (rows.size() == 3) {
        scan.rotation.emplace();
        for (size_t row = 0; row < 3 && scan.rotation; ++row) {
            if (const auto values = vector_of(&rows[row]))
                (*scan.rotation)[row] = *values;
            else
                scan.rotation.reset();
        }
    }
    scan.intensity_limits = numbers_of<2>(member(from, "intensity_limits"));
    if (const json* most = member(from, "color_maximum")) scan.color_maximum = number_of(*most);
    scan.stated_min = vector_of(member(from, "stated_min"));
    scan.stated_max = vector_of(member(from, "stated_max"));
    return scan;
}

std::optional<E57Notes> e57_of(const json& from) {
    bool any = false;
    for (const char* key : {"library", "coordinate_system", "scans", "images", "image_count"})
        any = any || from.contains(key);
    if (!any) return std::nullopt;
    E57Notes e57{
        text_at(from, "guid"),        text_at(from, "library"), text_at(from, "coordinate_system"), {}, {},
        whole_at(from, "image_count")};
    for (const json& scan : list_at(from, "scans")) e57.scans.push_back(scan_of(scan));
    for (const json& image : list_at(from, "images"))
        e57.images.push_back({text_at(image, "name"), text_at(image, "representation"),
                              text_at(image, "encoding"), whole_at(image, "bytes"), whole_at(image, "width"),
                              whole_at(image, "height")});
    return e57;
}

std::optional<MeshNotes> mesh_of(const json* from) {
    if (!from || !from->is_object()) return std::nullopt;
    MeshNotes mesh{.faces = whole_at(*from, "faces"),
                   .vertices = whole_at(*from, "vertices"),
                   .triangles = whole_at(*from, "triangles"),
                   .textures = whole_at(*from, "textures"),
                   .without_area = whole_at(*from, "left_out_without_area"),
                   .not_finite = whole_at(*from, "left_out_not_finite"),
                   .other_statements = whole_at(*from, "left_out_lines_points_curves"),
                   .missing_corners = whole_at(*from, "coordinates_and_normals_not_there"),
                   .samples = {}};
    const json *area = member(*from, "area_m2"), *spacing = member(*from, "spacing_m");
    const auto min = vector_of(member(*from, "min")), max = vector_of(member(*from, "max"));
    if (area && spacing && min && max && number_of(*area) && number_of(*spacing))
        mesh.samples = {*number_of(*area), *number_of(*spacing), whole_at(*from, "samples"), *min, *max};
    return mesh;
}

std::optional<IntensityLimits> limits_of(const json* from) {
    const auto numbers = numbers_of<2>(from);
    if (!numbers) return std::nullopt;
    constexpr double kMostWhole = 0x1p53;  // doubles hold every integer up to here
    const auto whole = [&](size_t i) {
        return (*from)[i].is_number_integer() && std::abs((*numbers)[i]) <= kMostWhole;
    };
    return IntensityLimits{(*numbers)[0], (*numbers)[1], whole(0) && whole(1)};
}

}  // namespace

std::string notes_text(const FormatNotes& notes) {
    json to = json::object();
    if (notes.las) {
        to["format"] = "las";
        // A damaged header is left out, so that it counts as damaged when it is read again as well.
        if (notes.las_damage.empty()) add_las(*notes.las, to);
    } else if (notes.ply) {
        to["format"] = "ply";
        add_ply(*notes.ply, to);
    } else if (notes.pcd) {
        to["format"] = "pcd";
        add_pcd(*notes.pcd, to);
    } else if (notes.e57) {
        add_e57(*notes.e57, to);
    }
    if (notes.mesh) to["mesh"] = mesh_json(*notes.mesh);
    if (notes.color_bits) to["color_bits"] = *notes.color_bits;
    if (const auto& limits = notes.intensity_limits) {
        if (limits->whole)
            to["intensity_limits"] = {static_cast<int64_t>(limits->low), static_cast<int64_t>(limits->high)};
        else
            to["intensity_limits"] = {limits->low, limits->high};
    }
    if (notes.projection) to["projection"] = records_json(*notes.projection);
    if (notes.extras) to["extras"] = records_json(*notes.extras);
    if (!notes.system_note.empty()) to["system_note"] = notes.system_note;
    if (!notes.extras_note.empty()) to["extras_note"] = notes.extras_note;
    return to.dump(-1, ' ', false, json::error_handler_t::replace);
}

FormatNotes notes_of_text(std::string_view text) {
    const json from = json::parse(text, nullptr, false);
    FormatNotes notes;
    if (!from.is_object()) return notes;
    const std::string format = text_at(from, "format");
    if (format == "las")
        notes.las_damage = read_las(from, notes.las.emplace());
    else if (format == "ply")
        notes.ply = ply_of(from);
    else if (format == "pcd")
        notes.pcd = pcd_of(from);
    else
        notes.e57 = e57_of(from);
    notes.mesh = mesh_of(member(from, "mesh"));
    if (const json* bits = member(from, "color_bits"); bits && bits->is_number_unsigned())
        notes.color_bits = bits->get<uint32_t>();
    notes.intensity_limits = limits_of(member(from, "intensity_limits"));
    // An invalid list still says that the coordinate system is not the header's.
    if (const json* records = member(from, "projection"))
        notes.projection = records_of(*records).value_or(std::vector<LasRecord>());
    if (const json* records = member(from, "extras"))
        notes.extras = records_of(*records).value_or(std::vector<LasRecord>());
    notes.system_note = text_at(from, "system_note");
    notes.extras_note = text_at(from, "extras_note");
    return notes;
}

}  // namespace lucarne::io
