#pragma once

#include <optional>
#include <string>

#include "gi/scene/scene.h"
#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// How light is shown; overrides the scene file.
struct LightOptions {
    std::string tone_map, luminance, compare, compare_show;
    std::optional<double> border, difference_range, albedo, flatten;
    bool unbalanced = false;
};

/// Declares --tone-map --luminance --albedo --flatten --unbalanced --beside --beside-show --border
/// --difference-range.
/// `options` must outlive the command.
void add_light_options(Arguments& command, LightOptions& options);

/// Applies the options to a scene. Errors (ErrorKind::arguments): an option has a value that it does not
/// take.
Result<void> apply(const LightOptions& options, gi::Scene& scene);

}  // namespace lucarne::viewer
