#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "gi/scene/render_settings.h"
#include "io/files/json.h"

namespace lucarne::gi {

/// Reads the object `render` of a scene file (data/README.md). Errors name the place. Does not check that
/// the engine and the preset exist.
Result<RenderSettings> read_render_settings(JsonObject object);
/// Writes JSON that read_render_settings() reads back to equal settings.
nlohmann::ordered_json write_render_settings(const RenderSettings& settings);

/// Returns an option's value in the form that scene files and reports use.
nlohmann::ordered_json option_json(const OptionInfo& option, const OptionValue& value);

/// Reads the object `render` of a scene file and ignores the file's other keys. Returns empty settings if
/// there is no such object. Errors: reading the file, its syntax, this object.
Result<RenderSettings> load_render_settings(const std::filesystem::path& path);

}  // namespace lucarne::gi
