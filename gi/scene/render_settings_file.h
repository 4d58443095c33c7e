#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "gi/scene/render_settings.h"
#include "io/files/json.h"

namespace lucarne::gi {

/// The object `render` of a scene file, as data/README.md documents it. Errors name the place; whether there
/// is such an engine or preset is not looked at.
Result<RenderSettings> read_render_settings(JsonObject object);
/// What read_render_settings() reads back to the same.
nlohmann::ordered_json write_render_settings(const RenderSettings& settings);

/// A value as scene files and reports have it.
nlohmann::ordered_json option_json(const OptionInfo& option, const OptionValue& value);

/// Of a scene file, whose other keys are not looked at; empty ones where it has none. Errors: those of the
/// file, its syntax and this object.
Result<RenderSettings> load_render_settings(const std::filesystem::path& path);

}  // namespace lucarne::gi
