#pragma once

#include <filesystem>
#include <memory>

#include "gi/scene/environment.h"
#include "gi/scene/scene.h"
#include "io/files/json.h"

namespace lucarne::gi {

// The parts of a scene file that give light, as data/README.md documents them; load_scene() calls these.

Result<SceneLight> read_light(JsonObject object);
/// Lets a directional light with a place and a time come from where the sun is then.
void follow_sun(SceneLight& light);
/// Paths of pictures are relative to `folder`.
Result<std::shared_ptr<const Environment>> read_environment(JsonObject object,
                                                            const std::filesystem::path& folder);

}  // namespace lucarne::gi
