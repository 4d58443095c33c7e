#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gi/scene/scene.h"
#include "io/core/options.h"
#include "octree/tree/source.h"
#include "viewer/commands/arguments.h"
#include "viewer/commands/light_options.h"
#include "viewer/commands/look_options.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// What `render`, `view` and `fly` ask for alike: how the picture is lit, how large it is and what it may
/// take.
struct DrawingOptions {
    std::string scene;          ///< path; empty: gi::default_scene
    gi::RenderSettings render;  ///< engine, preset and single settings over the preset's
    std::string size = "1280x720";
    std::string points;
    std::optional<double> exposure;
    std::string memory, device_memory;  ///< caps; empty: PipelineOptions' own
    LookOptions look;
    LightOptions light;
    bool no_prefetch = false;
};

/// Declares --scene --engine --preset --size --points --exposure --memory --device-memory --no-prefetch, the
/// options of every engine, and those of add_look_options() and add_light_options(). `options` outlives the
/// command.
void add_drawing_options(Arguments& command, DrawingOptions& options);

/// What the command line leaves open of `render`, as the scene file says it, else the defaults; engine and
/// preset are there from then on. Errors: the file's.
Result<void> take_render_settings(DrawingOptions& options);

/// The same, looked up and checked.
struct Drawing {
    Preset preset;  ///< with the single settings in place
    ImageSize size;
    PipelineOptions caps;
};
/// After take_render_settings(). Errors (ErrorKind::arguments): an unknown preset or engine, a size or an
/// amount of memory that is none.
Result<Drawing> resolve(const DrawingOptions& options);

/// The scene file, or the default scene for this cloud; the first camera is there in any case. Errors: the
/// file's; ErrorKind::arguments where no point has the attribute that colours are asked of.
Result<gi::Scene> load_scene_for(const DrawingOptions& options, const octree::NodeSource& source);

/// Errors (ErrorKind::arguments): no camera of that name; the message lists those there are. Empty: the
/// first.
Result<gi::SceneCamera> find_camera(const gi::Scene& scene, const std::string& name);

/// What is used of the caps, for people: "memory 12 of 512 MiB, device 31 of 64 MiB".
std::string memory_text(const PipelineOptions& caps, const MemoryUse& used);

/// Opens a pipeline on `source` with all of it set. Warns where the cloud has no normals.
Result<std::unique_ptr<Pipeline>> open_pipeline(gi::Device& device,
                                                std::shared_ptr<const octree::NodeSource> source,
                                                const DrawingOptions& options, const Drawing& drawing,
                                                gi::Scene scene);

}  // namespace lucarne::viewer
