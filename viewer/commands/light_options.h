#pragma once

#include <optional>
#include <string>

#include "gi/scene/scene.h"
#include "viewer/commands/arguments.h"

namespace lucarne::viewer {

/// What is shown of the light, over what the scene file says.
struct LightOptions {
    std::string tone_map, luminance, compare, compare_show;
    std::optional<double> border, difference_range, albedo, flatten;
};

/// Declares --tone-map --luminance --albedo --flatten --compare --compare-show --border --difference-range.
/// `options` outlives the command.
void add_light_options(Arguments& command, LightOptions& options);

/// Errors (ErrorKind::arguments): a text that is none of what its option takes.
Result<void> apply(const LightOptions& options, gi::Scene& scene);

}  // namespace lucarne::viewer
