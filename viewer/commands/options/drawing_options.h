#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gi/scene/scene.h"
#include "io/core/options.h"
#include "octree/tree/source.h"
#include "viewer/commands/options/arguments.h"
#include "viewer/commands/options/light_options.h"
#include "viewer/commands/options/look_options.h"
#include "viewer/frame/pipeline.h"
#include "viewer/opening/moods.h"

namespace lucarne::viewer {

/// The options that `render`, `view` and `fly` share: lighting, picture size and memory caps.
struct DrawingOptions {
    std::string scene;  ///< path; empty: light and cameras for what the scan shows
    std::string mood;   ///< replaces the scene's light; empty: the scene's, else the scan's own colours
    gi::RenderSettings render;    ///< engine, preset, and single settings that override the preset
    bool engine_by_mood = false;  ///< the engine is that of the mood, for want of another choice
    std::string size = "1280x720";
    std::string points;
    std::optional<double> exposure;
    std::string memory, device_memory;  ///< caps; empty: the defaults of PipelineOptions
    LookOptions look;
    LightOptions light;
    bool no_prefetch = false;
};

/// Declares --scene --mood --engine --preset --size --points --exposure --memory --device-memory
/// --no-prefetch, the options of every engine, and those of add_look_options() and add_light_options().
/// `options` must outlive the command.
void add_drawing_options(Arguments& command, DrawingOptions& options);

/// Completes options.render: what the command line leaves open comes from the scene file, else from the
/// defaults. Afterwards engine and preset are set; load_scene_for() may choose another engine if
/// `engine_by_mood` is true. Errors: those of reading the scene file.
Result<void> take_render_settings(DrawingOptions& options);

/// Drawing options after look-up and checks.
struct Drawing {
    Preset preset;  ///< with the single settings applied
    ImageSize size;
    PipelineOptions caps;
};
/// Looks up and checks the options. Call after take_render_settings(). Errors (ErrorKind::arguments): an
/// unknown preset or engine, a malformed size or amount of memory.
Result<Drawing> resolve(const DrawingOptions& options);

/// A scene made for a scan.
struct SceneForScan {
    gi::Scene scene;
    std::optional<Site> site;  ///< what the scan shows; none if the scene file has said it all
    std::optional<Mood> mood;  ///< the light is this mood's; set together with `site`
    bool first_view = false;   ///< the first camera is the first view of what the scan shows
    std::string engine;        ///< the options' or, with `engine_by_mood`, that of the mood for this site
};

/// Loads the scene file. Without one the scan is shown by its own colours, or by the light that suits it if
/// the engine lights it. The scene has at least one camera. A mood in the options replaces the light of the
/// file. With a mood, or without a file, the first camera is the first view of what the scan shows, unless
/// the file has cameras, and an overview follows. `size` in the options is the picture's, `render.engine` is
/// set (take_render_settings()). `is_prepared`: see engine_of(). With a mood, or without a file, loads a
/// sample of the coarsest nodes. Errors: those of reading the file; ErrorKind::arguments if no point has the
/// attribute that colours are requested from.
Result<SceneForScan> load_scene_for(const DrawingOptions& options, const octree::NodeSource& source,
                                    bool is_prepared = false);

/// Returns what was chosen for the scan: "interior: camera 'inside' at 1.20 3.40 1.60, mood evening". Empty
/// if the scene file has chosen it all.
std::string chosen_text(const SceneForScan& loaded);

/// Returns the camera called `name`, or the first camera if `name` is empty. Errors (ErrorKind::arguments):
/// there is no camera of that name; the message lists the cameras.
Result<gi::SceneCamera> find_camera(const gi::Scene& scene, const std::string& name);

/// Returns a text about the used share of the caps: "memory 12 of 512 MiB, device 31 of 64 MiB".
std::string memory_text(const PipelineOptions& caps, const MemoryUse& used);

/// Opens a pipeline on `source` and applies all options. Warns if the cloud has no normals.
Result<std::unique_ptr<Pipeline>> open_pipeline(gi::Device& device,
                                                std::shared_ptr<const octree::NodeSource> source,
                                                const DrawingOptions& options, const Drawing& drawing,
                                                gi::Scene scene);

}  // namespace lucarne::viewer
