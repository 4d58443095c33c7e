#include "viewer/shell/settings.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

#include "io/core/file.h"
#include "io/core/json.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "settings.json";
constexpr int64_t kLargestWindow = 16384;

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
    LUCARNE_ASSIGN(settings.panels, object.boolean("panels", true));
    if (const auto recent = json.find("recent"); recent != json.end()) {
        if (!recent->is_array()) return object.wrong("is no list", "recent");
        for (const auto& path : *recent) {
            if (!path.is_string()) return object.wrong("holds what is no text", "recent");
            if (settings.recent.size() < kMostRecent) settings.recent.push_back(path.get<std::string>());
        }
    }
    settings.others = json;
    for (const char* known : {"window", "navigation", "text_size", "panels", "recent"})
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

fs::path config_folder() {
    const auto folder = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value && *value == '/' ? fs::path(value) : fs::path();  // relative ones do not count (XDG 0.8)
    };
    if (const fs::path own = folder("LUCARNE_CONFIG"); !own.empty()) return own;
    if (const fs::path given = folder("XDG_CONFIG_HOME"); !given.empty()) return given / "lucarne";
    if (const fs::path home = folder("HOME"); !home.empty()) return home / ".config" / "lucarne";
    return {};
}

std::string put_aside(const fs::path& file, const Error& reason) {
    const fs::path aside = file.string() + ".broken";
    std::error_code error;
    fs::rename(file, aside, error);
    return fmt::format("{}; it is left out, the file is {}", reason.line(),
                       error ? "still there: " + error.message() : "now " + aside.string());
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
    json["panels"] = settings.panels;
    json["recent"] = settings.recent;
    // Names of files may hold any bytes.
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    LUCARNE_ASSIGN(auto file, OutputFile::create(folder / kFile, true));
    LUCARNE_TRY(file.append(text));
    return file.commit();
}

}  // namespace lucarne::viewer
