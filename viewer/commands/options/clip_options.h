#pragma once

#include <string>
#include <vector>

#include "gi/scene/clip.h"
#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// --clip-box, --clip-outside and --clip-plane, as given.
struct ClipOptions {
    std::vector<std::string> boxes, outside, planes;
};
void add_clip_options(Arguments& command, ClipOptions& options);

/// Adds the boxes and planes to `clip`. Errors (arguments): not numbers, an empty box, a normal of length 0,
/// more than gi::kMostClips in all.
Result<void> apply(const ClipOptions& options, gi::Clip& clip);

}  // namespace lucarne::viewer
