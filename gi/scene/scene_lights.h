#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "gi/scene/environment.h"
#include "gi/scene/scene.h"
#include "io/files/json.h"

namespace lucarne::gi {

// The parts of a scene file that emit light (data/README.md); load_scene() calls these functions.

Result<SceneLight> read_light(JsonObject object);
/// Turns a directional light that has a place and a time to the sun's position then.
void follow_sun(SceneLight& light);
/// Paths of pictures are relative to `folder`. `sun` is the direction to the scene's sun. A sky of the
/// daylight model gets its picture from update_daylight().
Result<std::shared_ptr<const Environment>> read_environment(JsonObject object,
                                                            const std::filesystem::path& folder,
                                                            const std::optional<glm::dvec3>& sun);

}  // namespace lucarne::gi
