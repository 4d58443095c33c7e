#pragma once

#include <nlohmann/json_fwd.hpp>

#include "gi/scene/look.h"
#include "io/files/json.h"

namespace lucarne::gi {

/// The object `look` of a scene file, as data/README.md documents it. Errors name the place.
Result<Look> read_look(JsonObject object);
/// What read_look reads back to the same; what has its default value is left out.
nlohmann::json write_look(const Look& look);

}  // namespace lucarne::gi
