#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gi/scene/look.h"
#include "io/core/error.h"
#include "viewer/commands/options/arguments.h"
#include "viewer/commands/options/clip_options.h"

namespace lucarne::viewer {

/// How points are shown; overrides `look` of the scene file.
struct LookOptions {
    std::string colour, map, range, shading, background;
    std::optional<double> point_size, point_pixels, shading_strength;
    ClipOptions clip;
    std::vector<int> hidden_classes;
    std::optional<uint32_t> outliers;
    bool reversed = false, clip_casts = false, single_discs = false, front_only = false, open_holes = false,
         legend = false, axes = false, scale_bar = false;
};

/// Declares --colour --colour-map --reverse-map --range --shading --shading-strength --point-size
/// --point-pixels --outliers --single-discs --background --hide-class --clip-box --clip-outside --clip-plane
/// --clip-casts --legend
/// --axes --scale-bar. `options` must outlive the command.
void add_look_options(Arguments& command, LookOptions& options);

/// Applies the options to a look. Errors (ErrorKind::arguments): an option has a value that it does not take.
Result<void> apply(const LookOptions& options, gi::Look& look);

}  // namespace lucarne::viewer
