// The object `render` of a scene file.
#include "gi/scene/render_settings_file.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace lucarne::gi {
namespace {

// data/README.md states these limits; options of the same names have them as well.
constexpr int64_t kMostBounces = 64, kMostVpls = 65536, kMostSamples = 1 << 20;
constexpr std::array<int64_t, 3> kInterleaves = {1, 2, 4};
constexpr std::array<int64_t, 6> kAtlases = {256, 512, 1024, 2048, 4096, 8192};
constexpr std::array<int64_t, 7> kLightResolutions = {64, 128, 256, 512, 1024, 2048, 4096};

Result<std::optional<uint32_t>> integer(JsonObject& object, const char* key, int64_t least, int64_t most) {
    if (!object.has(key)) return std::optional<uint32_t>();
    LUCARNE_ASSIGN(const int64_t value, object.integer(key, least, most));
    return static_cast<uint32_t>(value);
}

Result<std::optional<uint32_t>> one_of(JsonObject& object, const char* key, std::span<const int64_t> values) {
    LUCARNE_ASSIGN(const auto value, integer(object, key, values.front(), values.back()));
    if (value && std::ranges::find(values, int64_t{*value}) == values.end())
        return object.wrong(fmt::format("is none of {}", fmt::join(values, ", ")), key);
    return value;
}

}  // namespace

Result<RenderSettings> read_render_settings(JsonObject object) {
    RenderSettings settings;
    LUCARNE_ASSIGN(settings.engine, object.text("engine", ""));
    LUCARNE_ASSIGN(settings.preset, object.text("preset", ""));
    LUCARNE_ASSIGN(settings.bounces, integer(object, "bounces", 0, kMostBounces));
    LUCARNE_ASSIGN(settings.only_bounce, integer(object, "only_bounce", 0, kMostBounces));
    LUCARNE_ASSIGN(settings.vpls, integer(object, "vpls", 1, kMostVpls));
    LUCARNE_ASSIGN(settings.interleave, one_of(object, "interleave", kInterleaves));
    LUCARNE_ASSIGN(settings.atlas, one_of(object, "atlas", kAtlases));
    LUCARNE_ASSIGN(settings.light_resolution, one_of(object, "light_resolution", kLightResolutions));
    LUCARNE_ASSIGN(settings.samples, integer(object, "samples", 1, kMostSamples));
    if (object.has("scale")) {
        LUCARNE_ASSIGN(settings.scale, object.number("scale", {kLeastPictureScale, 1}));
    }
    LUCARNE_TRY(object.finish());
    return settings;
}

nlohmann::ordered_json write_render_settings(const RenderSettings& settings) {
    nlohmann::ordered_json written = nlohmann::ordered_json::object();
    const auto put = [&](const char* key, const auto& value) {
        if (value) written[key] = *value;
    };
    if (!settings.engine.empty()) written["engine"] = settings.engine;
    if (!settings.preset.empty()) written["preset"] = settings.preset;
    put("bounces", settings.bounces);
    put("only_bounce", settings.only_bounce);
    put("vpls", settings.vpls);
    put("interleave", settings.interleave);
    put("atlas", settings.atlas);
    put("light_resolution", settings.light_resolution);
    put("samples", settings.samples);
    put("scale", settings.scale);
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
