#include "viewer/project/project.h"

#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/json.h"
#include "io/files/put_aside.h"
#include "io/files/user_folder.h"
#include "viewer/measure/file.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kVersion = 1;

/// Reads everything but the version. `whole` is the document of `object`.
Result<Project> parse(const nlohmann::json& whole, JsonObject& object, const std::string& name,
                      const fs::path& folder, double metres_per_unit) {
    Project project;
    const auto part = [&](const char* key) {
        return whole.contains(key) ? whole[key].dump() : std::string();
    };
    const auto label = [&](const char* key) { return fmt::format("{}: {}", name, key); };
    for (const char* key : {"scene", "measurements", "flythrough"})
        LUCARNE_TRY(object.object(key));  // the parts have readers of their own
    LUCARNE_ASSIGN(project.scene, gi::parse_scene(part("scene"), label("scene"), folder));
    if (const std::string text = part("measurements"); !text.empty()) {
        LUCARNE_ASSIGN(project.measurements,
                       parse_measurements(text, label("measurements"), metres_per_unit));
    }
    if (const std::string text = part("flythrough"); !text.empty()) {
        LUCARNE_ASSIGN(project.flythrough, parse_path(text, label("flythrough")));
    }
    LUCARNE_ASSIGN(const std::string mood, object.text("mood", ""));
    if (!mood.empty()) {
        LUCARNE_ASSIGN(project.mood, find_mood(mood));
    }
    if (const auto scans = whole.find("scans"); scans != whole.end() && scans->is_array())
        for (const auto& scan : *scans)
            if (scan.is_string()) project.scans.push_back(scan.get<std::string>());
    if (project.scene.cameras.empty()) return object.wrong("has no camera", "scene");
    return project;
}

}  // namespace

fs::path project_file(const fs::path& config, const std::string& scan) {
    return config.empty() ? fs::path() : config / "projects" / (kept_name(scan) + ".json");
}

std::string project_text(const Project& project, double metres_per_unit, const fs::path& folder) {
    using Json = nlohmann::ordered_json;
    Json json = {{"version", kVersion}, {"scans", project.scans}};
    json["scene"] = Json::parse(gi::write_scene(project.scene, folder));
    if (project.mood) json["mood"] = mood_name(*project.mood);
    if (!project.measurements.empty())
        json["measurements"] = Json::parse(measurements_json(project.measurements, metres_per_unit));
    if (project.flythrough && !project.flythrough->keys.empty())
        json["flythrough"] = Json::parse(path_text(*project.flythrough));
    return json_text(json);
}

LoadedProject load_project(const fs::path& file, double metres_per_unit) {
    LoadedProject loaded;
    std::error_code error;
    if (file.empty() || !fs::exists(file, error)) return loaded;
    const auto read = [&]() -> Result<Project> {
        LUCARNE_ASSIGN(const nlohmann::json whole, load_json(file));
        LUCARNE_ASSIGN(JsonObject object, JsonObject::of(whole, file.string()));
        LUCARNE_ASSIGN(const int64_t version, object.integer("version", 1, 1'000'000));
        loaded.may_write = version <= kVersion;
        if (!loaded.may_write)
            return rejected(file.string(), fmt::format("version {} is newer than this program", version));
        return parse(whole, object, file.string(), file.parent_path(), metres_per_unit);
    };
    auto project = read();
    if (project)
        loaded.project = std::move(*project);
    else if (!loaded.may_write)
        loaded.problem = project.error().line() + ": your work on this scan is neither shown nor kept";
    else
        loaded.problem = put_aside(file, project.error());
    loaded.may_write = loaded.may_write && (project || !fs::exists(file, error));
    return loaded;
}

}  // namespace lucarne::viewer
