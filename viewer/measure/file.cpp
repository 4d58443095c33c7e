#include "viewer/measure/file.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/file.h"
#include "io/files/json.h"

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;

constexpr JsonRange kCoordinate{-1e30, 1e30}, kThickness{0, 1e30}, kUnit{1e-9, 1e9};
constexpr size_t kMostFields = 1000;

std::string fields_text(const ExactPoint& point) {
    std::string text;
    for (const PointField& field : point.fields)
        text += fmt::format("{}{}={}", text.empty() ? "" : "; ", field.name, field.value);
    return text;
}

Json point_json(const ExactPoint& point) {
    Json fields = Json::array();
    for (const PointField& field : point.fields)
        fields.push_back({{"name", field.name}, {"value", field.value}});
    const auto& [x, y, z] = point.coordinates;
    const glm::dvec3& p = point.position;
    return {{"position", {p.x, p.y, p.z}},
            {"coordinates", {{"x", x}, {"y", y}, {"z", z}}},
            {"attributes", std::move(fields)}};
}

Result<ExactPoint> read_point(JsonObject object) {
    ExactPoint point;
    LUCARNE_ASSIGN(point.position, object.vector("position", kCoordinate));
    for (int axis = 0; axis < 3; ++axis)
        point.coordinates[static_cast<size_t>(axis)] = fmt::format("{}", point.position[axis]);
    LUCARNE_ASSIGN(auto coordinates, object.object("coordinates"));
    if (coordinates) {
        LUCARNE_ASSIGN(point.coordinates[0], coordinates->text("x"));
        LUCARNE_ASSIGN(point.coordinates[1], coordinates->text("y"));
        LUCARNE_ASSIGN(point.coordinates[2], coordinates->text("z"));
        LUCARNE_TRY(coordinates->finish());
    }
    LUCARNE_ASSIGN(const auto fields, object.objects("attributes", kMostFields));
    for (JsonObject field : fields) {
        PointField& read = point.fields.emplace_back();
        LUCARNE_ASSIGN(read.name, field.text("name"));
        LUCARNE_ASSIGN(read.value, field.text("value"));
        LUCARNE_TRY(field.finish());
    }
    LUCARNE_TRY(object.finish());
    return point;
}

Result<Measurement> read_measurement(JsonObject object) {
    std::vector<std::string_view> names;
    for (const MeasureKindInfo& kind : measure_kinds()) names.push_back(kind.name);
    Measurement measurement;
    LUCARNE_ASSIGN(const size_t kind, object.choice("kind", names));
    measurement.kind = static_cast<MeasureKind>(kind);
    LUCARNE_ASSIGN(measurement.name, object.text("name", std::string(info_of(measurement.kind).title)));
    LUCARNE_ASSIGN(const auto points, object.objects("points", kMostMeasuredPoints));
    for (const JsonObject& point : points) {
        LUCARNE_ASSIGN(ExactPoint read, read_point(point));
        measurement.points.push_back(std::move(read));
    }
    const MeasureKindInfo& info = info_of(measurement.kind);
    if (points.size() < info.least || points.size() > info.most)
        return object.wrong(fmt::format("{} points; it takes {}", points.size(), info.hint), "points");
    if (measurement.kind == MeasureKind::section) {
        LUCARNE_ASSIGN(measurement.thickness, object.number("thickness", kThickness));
    }
    LUCARNE_TRY(object.object("results"));
    LUCARNE_TRY(object.finish());
    return measurement;
}

}  // namespace

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string measurements_csv(std::span<const Measurement> all, const UnitChoice& units) {
    std::string csv = "measurement,kind,what,value,unit,x,y,z,attributes\n";
    for (const Measurement& m : all) {
        const std::string head = fmt::format("{},{}", csv_field(m.name), info_of(m.kind).name);
        for (size_t i = 0; i < m.points.size(); ++i) {
            const auto& [x, y, z] = m.points[i].coordinates;
            csv += fmt::format("{},point {},,,{},{},{},{}\n", head, i + 1, csv_field(x), csv_field(y),
                               csv_field(z), csv_field(fields_text(m.points[i])));
        }
        for (const Quantity& q : quantities(m))
            csv += fmt::format("{},{},{},{},,,,\n", head, q.name, units.convert(q.value, q.dimension),
                               csv_field(units.name(q.dimension)));
    }
    return csv;
}

std::string measurements_text(std::span<const Measurement> all, const UnitChoice& units) {
    std::string text;
    for (const Measurement& m : all) {
        text += m.name + "\n";
        for (const ExactPoint& point : m.points) {
            const auto& [x, y, z] = point.coordinates;
            const std::string fields = fields_text(point);
            text += fmt::format("    {} {} {}{}{}\n", x, y, z, fields.empty() ? "" : "  ", fields);
        }
        for (const Quantity& q : quantities(m))
            text += fmt::format("    {}: {}\n", q.name, units.text(q.value, q.dimension));
    }
    return text;
}

std::string measurements_json(std::span<const Measurement> all, double metres_per_unit) {
    Json list = Json::array();
    for (const Measurement& m : all) {
        Json points = Json::array(), results = Json::object();
        for (const ExactPoint& point : m.points) points.push_back(point_json(point));
        const UnitChoice own{false, metres_per_unit};
        for (const Quantity& q : quantities(m)) results[q.name] = own.convert(q.value, q.dimension);
        Json one = {{"kind", info_of(m.kind).name}, {"name", m.name}, {"points", std::move(points)}};
        if (m.kind == MeasureKind::section) one["thickness"] = m.thickness;
        one["results"] = std::move(results);
        list.push_back(std::move(one));
    }
    const Json document = {{"metres_per_unit", metres_per_unit},
                           {"unit", unit_name(metres_per_unit)},
                           {"measurements", std::move(list)}};
    return json_text(document);
}

Result<std::vector<Measurement>> parse_measurements(std::string_view text, const std::string& name,
                                                    std::optional<double> metres_per_unit) {
    LUCARNE_ASSIGN(const nlohmann::json document, parse_json(text, name));
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, name));
    LUCARNE_ASSIGN(const double unit, root.number("metres_per_unit", kUnit, metres_per_unit.value_or(1)));
    if (metres_per_unit && std::abs(unit / *metres_per_unit - 1) > 1e-7)
        return root.wrong(fmt::format("measured in {}, but the scan is in {}", unit_name(unit),
                                      unit_name(*metres_per_unit)),
                          "metres_per_unit");
    LUCARNE_TRY(root.text("unit", ""));
    LUCARNE_ASSIGN(const auto objects, root.objects("measurements"));
    std::vector<Measurement> all;
    for (const JsonObject& object : objects) {
        LUCARNE_ASSIGN(Measurement measurement, read_measurement(object));
        all.push_back(std::move(measurement));
    }
    LUCARNE_TRY(root.finish());
    return all;
}

Result<std::vector<Measurement>> load_measurements(const std::filesystem::path& path,
                                                   std::optional<double> metres_per_unit) {
    LUCARNE_ASSIGN(const std::string text, load_text(path));
    return parse_measurements(text, path.string(), metres_per_unit);
}

Result<void> save_measurements(const std::filesystem::path& path, std::span<const Measurement> all,
                               const UnitChoice& units, bool overwrite) {
    const auto extension = path.extension();
    if (extension != ".csv" && extension != ".json")
        return bad_arguments(path.string(), "measurements are written as .csv or .json", "name it so");
    return write_file(
        path,
        extension == ".csv" ? measurements_csv(all, units) : measurements_json(all, units.metres_per_unit),
        overwrite);
}

}  // namespace lucarne::viewer
