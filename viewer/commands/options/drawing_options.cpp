#include "viewer/commands/options/drawing_options.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "gi/registry.h"
#include "gi/scene/render_settings_file.h"
#include "gi/surfels/colouring.h"
#include "io/core/log.h"
#include "octree/tree/robust_bounds.h"
#include "viewer/commands/options/shown_site.h"
#include "viewer/opening/first_view.h"

namespace lucarne::viewer {
namespace {

/// Fills unset fields of `settings` from `otherwise`.
void fill(gi::RenderSettings& settings, const gi::RenderSettings& otherwise) {
    if (settings.engine.empty()) settings.engine = otherwise.engine;
    if (settings.preset.empty()) settings.preset = otherwise.preset;
    settings.options.fill_from(otherwise.options);
    if (!settings.scale) settings.scale = otherwise.scale;
}

/// Whether an engine has all options that were given.
bool takes_all(std::string_view engine, const gi::EngineSettings& given) {
    const auto entry = gi::find_engine(engine);
    return entry && std::ranges::all_of(gi::engine_options(), [&](const gi::OptionInfo* option) {
               return !given.has(*option) ||
                      std::ranges::find((*entry)->info.options, option) != (*entry)->info.options.end();
           });
}

/// Returns a prefix such as "vpl, direct: " for the help of an option that not every engine has.
std::string owners(const gi::OptionInfo& option) {
    std::string names;
    size_t owners = 0, takers = 0;
    for (const auto& engine : gi::engines()) {
        takers += !engine.info.options.empty();
        if (std::ranges::find(engine.info.options, &option) == engine.info.options.end()) continue;
        ++owners;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", engine.info.name);
    }
    return owners == takers ? "" : names + ": ";
}

/// Returns the help of a flag that switches off what an option's help, an imperative, says.
std::string negated(std::string_view help) {
    std::string text = "Do not " + std::string(help);
    text[7] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[7])));
    return text;
}

/// Declares one argument --KEY for each option of each engine.
void add_engine_options(Arguments& command, gi::EngineSettings& settings) {
    for (const gi::OptionInfo* option : gi::engine_options()) {
        const std::string name = option->flag_name();
        if (option->kind == gi::OptionKind::flag) {
            const bool usual = std::get<bool>(option->defaults[size_t(gi::Effort::interactive)]);
            const std::string does = usual ? negated(option->help) : std::string(option->help);
            command.flag(
                name, [&settings, option, usual] { settings.set(*option, !usual); }, owners(*option) + does);
            continue;
        }
        const std::string help = owners(*option) + std::string(option->help);
        const auto take = [&settings, option](const std::string& text) -> std::optional<std::string> {
            auto value = gi::parse_option(*option, text);
            if (!value) return value.error().why;
            settings.set(*option, *value);
            return std::nullopt;
        };
        command.parsed(name, take, fmt::format("{} ({})", help, gi::range_text(*option)))
            .type_name(std::string(option->kind == gi::OptionKind::choice   ? "NAME"
                                   : option->kind == gi::OptionKind::colour ? "R,G,B"
                                                                            : option->placeholder));
    }
}

std::string engine_names() {
    std::string names;
    for (const auto& engine : gi::engines())
        names += fmt::format("\n  {:<13}{}", engine.info.name, engine.info.description);
    return names;
}

std::string preset_names() {
    std::string names;
    for (const auto& preset : presets())
        names += fmt::format("\n  {:<12}{}", preset.name, preset.description);
    return names;
}

std::string mood_names() {
    std::string names;
    for (const MoodInfo& mood : moods()) names += fmt::format("\n  {:<14}{}", mood.name, mood.help);
    return names;
}

/// Returns the first view of a scan, followed by the overview where that is another one.
std::vector<gi::SceneCamera> usual_cameras(const Site& site, double aspect) {
    const PictureShape shape{aspect, {}};
    std::vector<gi::SceneCamera> cameras{first_view(site, shape)};
    gi::SceneCamera outside = outside_view(site, shape);
    if (outside.name != cameras[0].name) cameras.push_back(std::move(outside));
    return cameras;
}

bool all_have_normals(const octree::NodeSource& source) {
    return std::ranges::all_of(source.roots(), [&](uint32_t root) {
        const io::Schema& schema = source.part_of(root).header.schema;
        return schema.find(io::names::normal) || schema.find(io::names::normal_oct);
    });
}

/// Warns of an extent for which lights, cameras and the device's floats are not made: they suit scans from
/// rooms up to countries.
void warn_of_extent(const octree::SourceHeader& header) {
    constexpr double kLeast = 0.01, kMost = 1e6;  // m
    const glm::dvec3 extent = (header.max - header.min) * header.metres_per_unit;
    const double widest = std::max({extent.x, extent.y, extent.z});
    if (widest >= kLeast && widest <= kMost) return;
    if (widest > 0)
        log::warn(
            "the points span {:.3g} m: pictures are right from 1 cm to 1000 km; convert with the right "
            "--unit, or "
            "remove outliers with lucarne delete",
            widest);
}

void add_exposure(Arguments& command, DrawingOptions& options) {
    command.add("--exposure", options.exposure, "Exposure in stops; by default the scene's, or automatic")
        .range(-100.0, 100.0)
        .type_name("EV");
}

void add_limits(Arguments& command, DrawingOptions& options) {
    const ArgumentGroup group(command, "Detail and memory");
    command.add("--points", options.points, "Largest number of points of a cut: 200000, 2M").type_name("N");
    command
        .add("--memory", options.memory,
             "Cap on host memory for the octree's directory and nodes on their way to the device (512M)")
        .type_name("SIZE");
    command
        .add("--device-memory", options.device_memory,
             "Cap on device memory for surfels, pictures and maps together (2G)")
        .type_name("SIZE");
    command.flag("--no-prefetch", options.no_prefetch,
                 "Do not load nodes ahead of a moving camera (for measurements)");
}

/// Finds wrong values of options that change the scene, which is not loaded yet.
Result<void> check_names(const DrawingOptions& options) {
    gi::Scene scene;
    if (!options.scene.empty()) scene.comparison.emplace();  // it may have one
    LUCARNE_TRY(apply(options.look, scene.look));
    return apply(options.light, scene);
}

}  // namespace

void add_drawing_options(Arguments& command, DrawingOptions& options) {
    command.add("--scene", options.scene, "Lights, materials, cameras and exposure (data/README.md)")
        .type_name("FILE");
    command
        .add(
            "--mood", options.mood,
            "Light for what the scan shows, and a camera to see it, see below; without a scene: scan-colours")
        .type_name("NAME");
    command
        .add("--engine", options.render.engine,
             "Method of lighting, see below; without scene, mood and options of an engine: " +
                 std::string(gi::engine_with(&gi::EngineInfo::unlit).name) +
                 ", under a mood's sky: environment, else " + std::string(gi::default_engine().name))
        .type_name("NAME");
    command.add("--preset", options.render.preset, "Quality against speed, see below")
        .show_default(std::string(kDefaultPreset))
        .type_name("NAME");
    command.add("--size", options.size, "Size of the picture in pixels").show_default().type_name("WxH");
    {
        const ArgumentGroup group(command, "Points and colours");
        add_look_options(command, options.look);
    }
    {
        const ArgumentGroup group(command, "Exposure, albedo and comparison");
        add_exposure(command, options);
        add_light_options(command, options.light);
    }
    add_limits(command, options);
    {
        const ArgumentGroup group(command, "Engines");
        add_engine_options(command, options.render.options);
    }
    command.footer("Engines:" + engine_names() + "\nPresets:" + preset_names() + "\nMoods:" + mood_names());
}

Result<void> take_render_settings(DrawingOptions& options) {
    if (!options.scene.empty()) {
        LUCARNE_ASSIGN(const gi::RenderSettings said, gi::load_render_settings(options.scene));
        if (!said.engine.empty() && !gi::find_engine(said.engine))
            return rejected(options.scene,
                            fmt::format("/render/engine: there is no engine '{}'", said.engine));
        if (!said.preset.empty() && !find_preset(said.preset))
            return rejected(options.scene,
                            fmt::format("/render/preset: there is no preset '{}'", said.preset));
        fill(options.render, said);
    }
    gi::RenderSettings usual;
    usual.engine = gi::default_engine().name;
    if (!options.mood.empty()) {
        LUCARNE_ASSIGN(const Mood mood, find_mood(options.mood));
        const std::string_view engine = engine_of(mood, SiteKind::interior);
        options.engine_by_mood = options.render.engine.empty() && takes_all(engine, options.render.options);
        if (options.engine_by_mood) usual.engine = engine;
    } else if (options.scene.empty() && options.render.options.empty()) {
        // Engines that light are asked for by their options.
        usual.engine = gi::engine_with(&gi::EngineInfo::unlit).name;
    }
    usual.preset = kDefaultPreset;
    fill(options.render, usual);
    return {};
}

Result<Drawing> resolve(const DrawingOptions& options) {
    Drawing drawing;
    LUCARNE_ASSIGN(drawing.preset, find_preset(options.render.preset));
    LUCARNE_ASSIGN(drawing.size, parse_size("--size", options.size));
    if (!options.memory.empty()) {
        LUCARNE_ASSIGN(drawing.caps.memory, parse_bytes("--memory", options.memory));
    }
    if (!options.device_memory.empty()) {
        LUCARNE_ASSIGN(drawing.caps.device_memory, parse_bytes("--device-memory", options.device_memory));
    }
    drawing.caps.prefetch = !options.no_prefetch;
    LUCARNE_TRY(gi::find_engine(options.render.engine));
    LUCARNE_TRY(check_names(options));
    apply(options.render, drawing.preset.engine);
    if (!options.points.empty()) {
        LUCARNE_ASSIGN(const uint64_t points, parse_count("--points", options.points));
        if (points == 0)
            return bad_arguments("--points", "a cut without points shows nothing", "allow 1 or more");
        drawing.preset.budgets.cap(points);
    }
    return drawing;
}

Result<SceneForScan> load_scene_for(const DrawingOptions& options, const octree::NodeSource& source,
                                    bool is_prepared) {
    SceneForScan loaded;
    loaded.engine = options.render.engine;
    gi::Scene& scene = loaded.scene;
    LUCARNE_ASSIGN(const ImageSize size, parse_size("--size", options.size));
    const double aspect = static_cast<double>(size.width) / size.height;
    const auto [low, high] = octree::robust_bounds(source);
    scene = gi::default_scene(low, high, source.header().metres_per_unit, aspect);
    bool own_cameras = false;
    if (!options.scene.empty()) {
        const auto overview = std::move(scene.cameras);
        LUCARNE_ASSIGN(scene, gi::load_scene(options.scene));
        own_cameras = !scene.cameras.empty();
        if (!own_cameras) scene.cameras = overview;
        if (scene.comparison && scene.comparison->engine.empty())
            scene.comparison->engine = gi::engine_with(&gi::EngineInfo::is_reference).name;
    }
    if (options.scene.empty() || !options.mood.empty()) {
        const Site& site = loaded.site.emplace(shown_site(source));
        if (!options.mood.empty()) {
            LUCARNE_ASSIGN(loaded.mood, find_mood(options.mood));
            const std::string_view engine = engine_of(*loaded.mood, site.kind, is_prepared);
            if (options.engine_by_mood && takes_all(engine, options.render.options)) loaded.engine = engine;
        } else {
            const bool lit = !gi::engine_is(options.render.engine, &gi::EngineInfo::unlit);
            loaded.mood = lit ? usual_mood(site) : Mood::scan_colours;
        }
        loaded.first_view = !own_cameras;
        if (loaded.first_view) scene.cameras = usual_cameras(site, aspect);
        // Scan colours leave the lights as they are; another engine may use them later.
        if (options.scene.empty()) set_mood(scene, usual_mood(site), site, scene.cameras[0]);
        set_mood(scene, *loaded.mood, site, scene.cameras[0]);
    }
    if (options.exposure) scene.exposure_ev = options.exposure;
    LUCARNE_TRY(apply(options.look, scene.look));
    LUCARNE_TRY(apply(options.light, scene));
    LUCARNE_TRY(gi::check_attribute(source, scene.look));
    return loaded;
}

std::string chosen_text(const SceneForScan& loaded) {
    if (!loaded.site) return {};
    std::string chosen;
    if (loaded.first_view) {
        const gi::SceneCamera& camera = loaded.scene.cameras[0];
        chosen = fmt::format("camera '{}' at {:.2f} {:.2f} {:.2f}", camera.name, camera.position.x,
                             camera.position.y, camera.position.z);
    }
    return fmt::format("{}: {}{}mood {}", site_name(loaded.site->kind), chosen, chosen.empty() ? "" : ", ",
                       mood_name(*loaded.mood));
}

Result<gi::SceneCamera> find_camera(const gi::Scene& scene, const std::string& name) {
    std::vector<std::string_view> names;
    for (const auto& camera : scene.cameras) {
        if (name.empty() || camera.name == name) return camera;
        names.emplace_back(camera.name);
    }
    return bad_arguments("--camera", fmt::format("the scene has no camera '{}'", name), advice(name, names));
}

std::string memory_text(const PipelineOptions& caps, const MemoryUse& used) {
    return fmt::format("memory {} of {}, device {} of {}", bytes_text(used.host), bytes_text(caps.memory),
                       bytes_text(used.device), bytes_text(caps.device_memory));
}

Result<std::unique_ptr<Pipeline>> open_pipeline(gi::Device& device,
                                                std::shared_ptr<const octree::NodeSource> source,
                                                const DrawingOptions& options, const Drawing& drawing,
                                                gi::Scene scene) {
    if (!all_have_normals(*source))
        log::warn(
            "the points have no normals: surfaces are lit as if they faced the camera; "
            "convert with --normals estimate for correct light");
    warn_of_extent(source->header());
    LUCARNE_ASSIGN(auto pipeline, Pipeline::open(device, std::move(source), drawing.caps));
    LUCARNE_TRY(pipeline->set_method({options.render.engine, drawing.preset.engine, drawing.preset.budgets}));
    LUCARNE_TRY(pipeline->set_scene(std::move(scene)));
    return pipeline;
}

}  // namespace lucarne::viewer
