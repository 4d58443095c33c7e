#pragma once

#include <nlohmann/json_fwd.hpp>

#include "gi/scene/look.h"
#include "io/files/json.h"

namespace lucarne::gi {

/// Reads the object `look` of a scene file (data/README.md). Errors name the place.
Result<Look> read_look(JsonObject object);
/// Writes JSON that read_look() reads back to an equal look. Default values are left out.
nlohmann::json write_look(const Look& look);

}  // namespace lucarne::gi
