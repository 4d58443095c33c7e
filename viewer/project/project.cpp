#include "viewer/project/project.h"

#include <algorithm>
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
constexpr size_t kMostScans = 100'000;

/// Reads the paths of scans: each a text, or an array of texts for a group.
Result<ScanGroups> parse_scans(const nlohmann::json& whole, const JsonObject& object) {
    ScanGroups groups;
    const auto scans = whole.find("scans");
    if (scans == whole.end()) return groups;
    if (!scans->is_array()) return object.wrong("is not an array", "scans");
    size_t count = 0;
    for (const nlohmann::json& entry : *scans) {
        std::vector<std::string> group;
        const auto take = [&](const nlohmann::json& path) {
            if (path.is_string() && !path.get_ref<const std::string&>().empty())
                group.push_back(path.get<std::string>());
        };
        if (entry.is_array())
            for (const nlohmann::json& path : entry) take(path);
        else
            take(entry);
        if (group.empty()) return object.wrong("has an entry that is no path", "scans");
        if ((count += group.size()) > kMostScans)
            return object.wrong(fmt::format("has more than {} paths", kMostScans), "scans");
        groups.push_back(std::move(group));
    }
    return groups;
}

/// Reads everything but the version. `whole` is the document of `object`.
Result<Project> parse(const nlohmann::json& whole, JsonObject& object, const std::string& name,
                      const fs::path& folder, std::optional<double> metres_per_unit) {
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
    LUCARNE_ASSIGN(project.scans, parse_scans(whole, object));
    if (project.scene.cameras.empty()) return object.wrong("has no camera", "scene");
    return project;
}

Result<int64_t> version_of(const nlohmann::json& whole, const std::string& name) {
    LUCARNE_ASSIGN(JsonObject object, JsonObject::of(whole, name));
    return object.integer("version", 1, 1'000'000);
}

nlohmann::ordered_json scans_json(const ScanGroups& scans) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& group : scans) {
        if (group.size() == 1)
            json.push_back(group.front());
        else
            json.push_back(group);
    }
    return json;
}

}  // namespace

fs::path project_file(const fs::path& config, const std::string& scan) {
    return config.empty() ? fs::path() : config / "projects" / (kept_name(scan) + ".json");
}

std::string project_text(const Project& project, double metres_per_unit, const fs::path& folder) {
    using Json = nlohmann::ordered_json;
    Json json = {{"version", kVersion}, {"scans", scans_json(project.scans)}};
    json["scene"] = Json::parse(gi::write_scene(project.scene, folder));
    if (project.mood) json["mood"] = mood_name(*project.mood);
    if (!project.measurements.empty())
        json["measurements"] = Json::parse(measurements_json(project.measurements, metres_per_unit));
    if (project.flythrough && !project.flythrough->keys.empty())
        json["flythrough"] = Json::parse(path_text(*project.flythrough));
    return json_text(json);
}

bool is_project(const fs::path& file) {
    const auto whole = load_json(file);
    return whole && whole->is_object() && whole->contains("version");  // no scene has that key
}

Result<Project> parse_project(std::string_view text, const std::string& name, const fs::path& folder,
                              std::optional<double> metres_per_unit) {
    LUCARNE_ASSIGN(const nlohmann::json whole, parse_json(text, name));
    LUCARNE_ASSIGN(const int64_t version, version_of(whole, name));
    if (version > kVersion)
        return rejected(name, fmt::format("version {} is newer than this program", version));
    LUCARNE_ASSIGN(JsonObject object, JsonObject::of(whole, name));
    return parse(whole, object, name, folder, metres_per_unit);
}

Result<Project> read_project(const fs::path& file, std::optional<double> metres_per_unit) {
    LUCARNE_ASSIGN(const std::string text, load_text(file));
    return parse_project(text, file.string(), file.parent_path(), metres_per_unit);
}

namespace {

/// Whether a path has bytes that no scan's path has. The system would end the path at a zero byte.
bool has_control_bytes(const std::string& path) {
    return std::ranges::any_of(path, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; });
}

}  // namespace

FoundScans find_scans(const ScanGroups& scans, const fs::path& folder) {
    FoundScans all;
    for (const auto& group : scans) {
        std::vector<std::string> found;
        for (const std::string& scan : group) {
            std::error_code error;
            const fs::path path(scan), moved = folder / path.filename();
            if (has_control_bytes(scan))
                all.missing.push_back(scan);
            else if (path.is_absolute() && fs::exists(path, error))
                found.push_back(scan);
            else if (path.has_filename() && fs::exists(moved, error))
                found.push_back(moved.string());
            else
                all.missing.push_back(scan);
        }
        if (!found.empty()) all.found.push_back(std::move(found));
    }
    return all;
}

std::string missing_text(const fs::path& file, const std::vector<std::string>& missing) {
    constexpr size_t kMostNamed = 3;
    if (missing.empty()) return "";
    std::string text;
    for (size_t i = 0; i < std::min(missing.size(), kMostNamed); ++i)
        text += (i == 0 ? "" : ", ") + missing[i];
    if (missing.size() > kMostNamed) text += fmt::format(" and {} more", missing.size() - kMostNamed);
    return Error{ErrorKind::failed, file.string(), "scans not found: " + text, "put them beside the project"}
        .line();
}

LoadedProject load_project(const fs::path& file, double metres_per_unit) {
    LoadedProject loaded;
    std::error_code error;
    if (file.empty() || !fs::exists(file, error)) return loaded;
    auto project = read_project(file, metres_per_unit);
    if (project) {
        loaded.project = std::move(*project);
        return loaded;
    }
    const auto whole = load_json(file);
    const auto version = whole ? version_of(*whole, file.string()) : 0;
    if (version && *version > kVersion) {
        loaded.problem = project.error().line() + ": your work on this scan is neither shown nor kept";
        loaded.may_write = false;
    } else {
        loaded.problem = put_aside(file, project.error());
        loaded.may_write = !fs::exists(file, error);
    }
    return loaded;
}

}  // namespace lucarne::viewer
