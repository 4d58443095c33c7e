#include "viewer/window/settings/settings.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>

#include "io/files/file.h"
#include "io/files/json.h"
#include "io/files/put_aside.h"
#include "io/files/user_folder.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {
namespace {

/// The widest side bar of earlier versions, whose text was smaller, in heights of the text.
constexpr double kWidestKept = 80;

namespace fs = std::filesystem;

constexpr const char* kFile = "settings.json";
constexpr int64_t kLargestWindow = 16384;
constexpr double kMostDeviceMemory = 1 << 20;  ///< MiB

/// In the order of the mapping's axes.
constexpr std::array<const char*, io::SixDofMapping::kAxes> kAxes = {"right",   "up",        "forward",
                                                                     "nose_up", "nose_left", "roll_right"};

/// {"sensitivity": 1, "dead_zone": 0.05, "up": {"from": "forward", "scale": -1}}; axes that are not listed
/// keep the device's mapping.
Result<io::SixDofMapping> read_mapping(JsonObject& object) {
    io::SixDofMapping mapping;
    LUCARNE_ASSIGN(mapping.sensitivity, object.number("sensitivity", {0.01, 100}, mapping.sensitivity));
    LUCARNE_ASSIGN(mapping.dead_zone, object.number("dead_zone", {0, 0.9}, mapping.dead_zone));
    for (size_t i = 0; i < kAxes.size(); ++i) {
        LUCARNE_ASSIGN(auto axis, object.object(kAxes[i]));
        if (!axis) continue;
        LUCARNE_ASSIGN(const std::string from, axis->text("from", kAxes[i]));
        const auto at = std::ranges::find(kAxes, from);
        if (at == kAxes.end()) return axis->wrong("is no axis", "from");
        mapping.from[i] = static_cast<uint8_t>(at - kAxes.begin());
        LUCARNE_ASSIGN(mapping.scale[i], axis->number("scale", {-100, 100}, mapping.scale[i]));
    }
    return mapping;
}

nlohmann::json mapping_json(const io::SixDofMapping& mapping) {
    nlohmann::json json = {{"sensitivity", mapping.sensitivity}, {"dead_zone", mapping.dead_zone}};
    for (size_t i = 0; i < kAxes.size(); ++i)
        json[kAxes[i]] = {{"from", kAxes[mapping.from[i]]}, {"scale", mapping.scale[i]}};
    return json;
}

/// {"shown": true, "width": 24, "open": ["scans", "light"]}; unknown sections (of other versions) are
/// ignored.
Result<SideBar> read_side_bar(JsonObject& object, const nlohmann::json& json) {
    SideBar bar;
    LUCARNE_ASSIGN(bar.shown, object.boolean("shown", bar.shown));
    LUCARNE_ASSIGN(bar.width, object.number("width", {SideBar::kLeast, kWidestKept}, bar.width));
    bar.width = std::min(bar.width, SideBar::kMost);
    const auto open = json.find("open");
    if (open == json.end()) return bar;
    if (!open->is_array()) return object.wrong("is no list", "open");
    bar.open.fill(false);
    for (const auto& name : *open) {
        if (!name.is_string()) return object.wrong("contains a value that is not text", "open");
        const auto at = std::ranges::find(kSectionNames, name.get_ref<const std::string&>());
        if (at != kSectionNames.end()) bar.open[static_cast<size_t>(at - kSectionNames.begin())] = true;
    }
    return bar;
}

nlohmann::json side_bar_json(const SideBar& bar) {
    nlohmann::json open = nlohmann::json::array();
    for (size_t i = 0; i < kSections; ++i)
        if (bar.open[i]) open.push_back(kSectionNames[i]);
    return {{"shown", bar.shown}, {"width", bar.width}, {"open", std::move(open)}};
}

Result<Settings> parse(const nlohmann::json& json, const std::string& name) {
    Settings settings;
    LUCARNE_ASSIGN(JsonObject object, JsonObject::of(json, name));
    LUCARNE_ASSIGN(auto window, object.object("window"));
    if (window) {
        LUCARNE_ASSIGN(const int64_t width, window->integer("width", 1, kLargestWindow));
        LUCARNE_ASSIGN(const int64_t height, window->integer("height", 1, kLargestWindow));
        settings.window = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
    }
    LUCARNE_ASSIGN(settings.navigation, object.text("navigation", ""));
    LUCARNE_ASSIGN(settings.text_size, object.number("text_size", {0.5, 4}, 1.0));
    LUCARNE_ASSIGN(settings.device_memory, object.number("device_memory", {0, kMostDeviceMemory}, 0.0));
    LUCARNE_ASSIGN(auto side_bar, object.object("side_bar"));
    if (side_bar) {
        LUCARNE_ASSIGN(settings.side_bar, read_side_bar(*side_bar, json["side_bar"]));
    }
    LUCARNE_ASSIGN(auto controller, object.object("controller"));
    if (controller) {
        LUCARNE_ASSIGN(settings.controller, read_mapping(*controller));
    }
    if (const auto recent = json.find("recent"); recent != json.end()) {
        if (!recent->is_array()) return object.wrong("is no list", "recent");
        for (const auto& path : *recent) {
            if (!path.is_string()) return object.wrong("contains a value that is not text", "recent");
            if (settings.recent.size() < kMostRecent) settings.recent.push_back(path.get<std::string>());
        }
    }
    settings.others = json;
    for (const char* known :
         {"window", "navigation", "text_size", "device_memory", "side_bar", "controller", "recent"})
        settings.others.erase(known);
    return settings;
}

Result<Settings> read(const fs::path& file) {
    LUCARNE_ASSIGN(const nlohmann::json json, load_json(file));
    return parse(json, file.string());
}

}  // namespace

void Settings::opened(const std::string& path) {
    std::erase(recent, path);
    recent.insert(recent.begin(), path);
    if (recent.size() > kMostRecent) recent.resize(kMostRecent);
}

std::string absolute_path(const std::string& path) {
    return whole_path(path);
}

fs::path config_folder() {
    if (const fs::path own = absolute_folder("LUCARNE_CONFIG"); !own.empty()) return own;
    return user_folder("XDG_CONFIG_HOME", ".config");
}

LoadedSettings load_settings(const fs::path& folder) {
    std::error_code error;
    const fs::path file = folder / kFile;
    if (folder.empty() || !fs::exists(file, error)) return {};
    auto settings = read(file);
    if (settings) return {std::move(*settings), {}};
    return {{}, put_aside(file, settings.error())};
}

Result<void> save_settings(const Settings& settings, const fs::path& folder) {
    if (folder.empty())
        return failed("settings", "there is no folder for them",
                      "set HOME, XDG_CONFIG_HOME or LUCARNE_CONFIG");
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return failed(folder.string(), "cannot be made: " + error.message());
    nlohmann::json json = settings.others;
    if (settings.window.width)
        json["window"] = {{"width", settings.window.width}, {"height", settings.window.height}};
    if (!settings.navigation.empty()) json["navigation"] = settings.navigation;
    json["text_size"] = settings.text_size;
    if (settings.device_memory > 0) json["device_memory"] = settings.device_memory;
    json["side_bar"] = side_bar_json(settings.side_bar);
    if (!(settings.controller == io::SixDofMapping{})) json["controller"] = mapping_json(settings.controller);
    json["recent"] = settings.recent;
    return write_file(folder / kFile, json_text(json), true);
}

}  // namespace lucarne::viewer
