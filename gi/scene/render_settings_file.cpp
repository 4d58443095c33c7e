// The object `render` of a scene file.
#include "gi/scene/render_settings_file.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lucarne::gi {
namespace {

Result<OptionValue> read_option(JsonObject& object, const OptionInfo& option) {
    const std::string_view key = option.key;
    switch (option.kind) {
        case OptionKind::flag: {
            LUCARNE_ASSIGN(const bool value, object.boolean(key));
            return value;
        }
        case OptionKind::integer: {
            LUCARNE_ASSIGN(const int64_t value, object.integer(key, static_cast<int64_t>(option.least),
                                                               static_cast<int64_t>(option.most)));
            if (!option.values.empty() && std::ranges::find(option.values, value) == option.values.end())
                return object.wrong(fmt::format("is none of {}", range_text(option)), key);
            return value;
        }
        case OptionKind::number: {
            LUCARNE_ASSIGN(const double value, object.number(key, {option.least, option.most}));
            return value;
        }
        case OptionKind::choice: {
            const std::vector<std::string_view> names(option.choices.begin(), option.choices.end());
            LUCARNE_ASSIGN(const size_t index, object.choice(key, names));
            return static_cast<int64_t>(index);
        }
        case OptionKind::colour:
            break;
    }
    LUCARNE_ASSIGN(const glm::dvec3 colour, object.vector(key, {0, 1}));
    return colour;
}

}  // namespace

nlohmann::ordered_json option_json(const OptionInfo& option, const OptionValue& value) {
    switch (option.kind) {
        case OptionKind::flag:
            return std::get<bool>(value);
        case OptionKind::integer:
            return std::get<int64_t>(value);
        case OptionKind::number:
            return std::get<double>(value);
        case OptionKind::choice:
            return std::string(option.choices[static_cast<size_t>(std::get<int64_t>(value))]);
        case OptionKind::colour:
            break;
    }
    const auto& colour = std::get<glm::dvec3>(value);
    return {colour.x, colour.y, colour.z};
}

Result<RenderSettings> read_render_settings(JsonObject object) {
    RenderSettings settings;
    LUCARNE_ASSIGN(settings.engine, object.text("engine", ""));
    LUCARNE_ASSIGN(settings.preset, object.text("preset", ""));
    for (const OptionInfo* option : engine_options()) {
        if (!object.has(option->key)) continue;
        LUCARNE_ASSIGN(OptionValue value, read_option(object, *option));
        settings.options.set(*option, std::move(value));
    }
    if (object.has("scale")) {
        LUCARNE_ASSIGN(settings.scale, object.number("scale", {kLeastPictureScale, 1}));
    }
    LUCARNE_TRY(object.finish());
    return settings;
}

nlohmann::ordered_json write_render_settings(const RenderSettings& settings) {
    nlohmann::ordered_json written = nlohmann::ordered_json::object();
    if (!settings.engine.empty()) written["engine"] = settings.engine;
    if (!settings.preset.empty()) written["preset"] = settings.preset;
    for (const OptionInfo* option : engine_options())
        if (settings.options.has(*option))
            written[std::string(option->key)] = option_json(*option, settings.options.get(*option));
    if (settings.scale) written["scale"] = *settings.scale;
    return written;
}

Result<RenderSettings> load_render_settings(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const nlohmann::json document, load_json(path));
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, path.string()));
    LUCARNE_ASSIGN(auto object, root.object("render"));
    if (!object) return RenderSettings();
    return read_render_settings(std::move(*object));
}

}  // namespace lucarne::gi
