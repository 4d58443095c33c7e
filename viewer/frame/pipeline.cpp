#include "viewer/frame/pipeline.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/gather/gather_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/light_options.h"
#include "gi/post/share_edges.h"
#include "gi/raster/blend.h"
#include "gi/raster/coverage.h"
#include "gi/raster/rims.h"
#include "gi/registry.h"
#include "gi/scene/views.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "octree/stream/motion.h"
#include "octree/tree/robust_bounds.h"
#include "viewer/frame/cut_choice.h"
#include "viewer/frame/device_cuts.h"
#include "viewer/frame/engine_bake.h"
#include "viewer/frame/presentation.h"
#include "viewer/frame/surfel_stream.h"

namespace lucarne::viewer {
namespace {

constexpr double kGapsPerPoint = 2;  // gaps that are filled: half their width, in diameters of points
constexpr double kAhead = 0.5;       // s of the camera's motion that are loaded ahead

/// Time in which a frame without `wait` takes nodes that have arrived, s, and as a share of the last frame's
/// time: a slow frame takes what has arrived during it, or a picture would need dozens of slow frames.
constexpr double kLeastLoadingTime = 0.002, kLoadingShare = 0.1;
/// Time for which the first picture of all waits for its nodes, s: a few of them make no picture.
constexpr double kFirstPatience = 0.1;

constexpr double kAlmost = 0.999;  // the share of what is finished, but not yet kept

/// Returns how points are shown without light. Colours that stand for values are shown as they are.
gi::Unlit unlit_of(const gi::Look& look) {
    gi::Unlit unlit = look.unlit;
    if (look.colour != gi::ColourBy::colour) unlit.brightness = 1;
    return unlit;
}

bool stopped(const FrameRequest& request) {
    return request.stop && *request.stop;
}

/// The engines that draw a frame.
struct DrawingEngines {
    gi::Engine* engine = nullptr;    ///< the picture's, or the one that stands in for it
    gi::Engine* compared = nullptr;  ///< the one that it is compared with, or null
    bool keeps_light = false;        ///< a slow engine draws with the light that it keeps
    bool operator==(const DrawingEngines&) const = default;
};
}  // namespace

struct Pipeline::State {
    State(gi::Device& on, const PipelineOptions& how)
        : device(on),
          options(how),
          times(on),
          surfels(on, {how.memory, how.device_memory, how.load_threads}, cuts),
          presentation(on) {}

    Result<void> take_source(std::shared_ptr<const octree::NodeSource> from);
    gi::EngineNeeds needs(const FrameRequest& request) const;
    void choose_cuts(const FrameRequest& request);
    Result<void> update_bake(const FrameRequest& request, bool is_shown);
    Result<void> take_bake(const FrameRequest& request);
    void look_ahead(const FrameRequest& request);
    Result<void> stream(const FrameRequest& request);
    Result<void> build_cuts(bool hold_light);
    Result<DrawingEngines> drawing_engines(const FrameRequest& request);
    Result<void> make_engines_anew();
    bool softens_edges(const FrameRequest& request) const;
    Result<void> draw(const FrameRequest& request);
    Result<void> draw_with(gi::Engine& by, const FrameRequest& request, gi::Buffer& target);
    Result<void> make_picture(const FrameRequest& request);
    FrameStats stats(double seconds) const;

    gi::Device& device;
    std::shared_ptr<const octree::NodeSource> source;
    std::array<glm::dvec3, 2> bounds;  ///< robust bounds of the source, without far outliers
    PipelineOptions options;
    gi::PassTimes times;

    std::string lost_node;  // why the first unreadable node of the source cannot be read

    CutChooser chooser;
    CutSet chosen;
    octree::Motion motion;
    std::vector<octree::Cut> ahead;  // view cuts for the camera's future positions
    DeviceCuts cuts;
    SurfelStream surfels;
    EngineBake bake;
    uint64_t bake_version = 0;  // of the last frame
    gi::BakeJob::Status baked;  // of this frame
    gi::LocalFrame local;

    std::unique_ptr<gi::Engine> engine, other;  ///< the picture's engine; the compared one, or null
    std::unique_ptr<gi::Engine> stand_in;       ///< once it was needed (FrameRequest::stand_in)
    std::unique_ptr<gi::Engine> colours;        ///< likewise (FrameRequest::colours_only)
    DrawingEngines drawing;                     ///< of the last frame
    gi::EngineSettings settings;
    CutBudgets budgets;
    gi::Scene scene;
    uint64_t content = 1;  // gi::Frame::content
    bool fresh = false;    // the source is new, and nothing of it has been drawn yet
    bool first = true;     // nothing has been drawn yet
    // Scene, settings, budgets or engine have changed: cuts are chosen again, and the average starts again.
    bool changed = true;

    FrameRequest last;
    double last_seconds = 0;  // duration of the last frame
    double most_pixels = 0;   // FrameRequest::most_pixels of the last frame
    bool front_only = false;  // FrameRequest::front_only of the last frame
    gi::CameraView camera{};
    gi::GBuffer gbuffer;
    Presentation presentation;
};

Result<void> Pipeline::State::take_source(std::shared_ptr<const octree::NodeSource> from) {
    if (from != source) bake.end();  // its news would be taken for those of the other source
    LUCARNE_TRY(surfels.set_source(from, scene));
    source = std::move(from);
    bounds = octree::robust_bounds(*source);
    lost_node.clear();
    changed = fresh = true;
    ++content;
    return {};
}

/// Returns what the engines read that draw the frame, and the one that may stand in: its nodes must be there
/// then.
gi::EngineNeeds Pipeline::State::needs(const FrameRequest& request) const {
    gi::EngineNeeds all = engine->info().needs;
    if (other) all = all | other->info().needs;
    const gi::EngineInfo& info = engine->info();
    const bool slow = info.reports_progress || (info.precomputes && request.stand_in_early);
    if (!request.wait && slow) all = all | gi::stand_in_engine().needs;
    return all;
}

void Pipeline::State::choose_cuts(const FrameRequest& request) {
    const CutPurpose purpose{*source,         request.camera,
                             request.size,    needs(request),
                             scene.lights,    settings[gi::kLightResolution],
                             budgets,         glm::distance(bounds[0], bounds[1]),
                             &scene.look.clip};
    chosen = chooser.choose(purpose, surfels.room());
    const glm::dvec3 origin = local.origin;
    local = gi::local_frame(request.camera.position, source->header().metres_per_unit);
    if (local.origin != origin) {
        cuts.tear();
        ++content;  // engines keep places relative to the origin
    }
    camera = gi::camera_view(request.camera, request.size, local);
    cuts.changed();
}

Result<void> Pipeline::State::update_bake(const FrameRequest& request, bool is_shown) {
    const gi::EngineInfo* prepared = &engine->info();
    if (!prepared->precomputes && !request.prepares.empty()) {
        LUCARNE_ASSIGN(const auto entry, gi::find_engine(request.prepares));
        prepared = &entry->info;
    }
    const auto& rest = request.at_rest;
    bake.update({*prepared, source, bounds, surfels, scene, rest ? rest->settings : settings,
                 rest ? rest->budgets.light : budgets.light, is_shown, request.prepares_again});
    return {};
}

/// Takes what the engine has computed in advance so far; with `wait` all of it. Without `wait` a failure is a
/// warning, and the engine draws without it. So is one to keep it.
Result<void> Pipeline::State::take_bake(const FrameRequest& request) {
    LUCARNE_TRY(update_bake(request, !request.wait));
    if (!bake.running()) {
        baked = {};
        return {};
    }
    const bool is_drawn = engine->info().precomputes != nullptr;
    if (request.wait && is_drawn) LUCARNE_TRY(bake.wait(request.stop, nullptr));
    const bool failed_before = baked.ended && !baked.error, unkept_before = !baked.keeping;
    baked = bake.status();
    if (baked.ended && !baked.error && !failed_before)
        log::warn("{}; the picture is made without it", baked.error.error().line());
    if (!baked.keeping && !unkept_before)
        log::warn("{}; it will be computed again", baked.keeping.error().line());
    if (std::exchange(bake_version, baked.version) != baked.version && is_drawn) presentation.restart();
    return {};
}

/// Chooses cuts for what the camera will see if it continues its motion.
void Pipeline::State::look_ahead(const FrameRequest& request) {
    ahead.clear();
    if (request.wait || !request.moving || !options.prefetch) return motion.forget();
    motion.observe(gi::octree_view(request.camera, request.size));
    const double frames = std::clamp(kAhead / std::max(last_seconds, 1e-3), 2.0, 30.0);
    for (const double part : {0.5, 1.0})
        if (const auto view_there = motion.ahead(part * frames))
            ahead.push_back(octree::view_cut(*source, *view_there, budgets.view, budgets.pixel_spacing));
}

/// Loads nodes of the chosen cuts; with `wait` as many as the caps allow.
Result<void> Pipeline::State::stream(const FrameRequest& request) {
    std::vector<const octree::Cut*> later;
    for (const octree::Cut& cut : ahead) later.push_back(&cut);
    const double seconds = std::max(kLeastLoadingTime, kLoadingShare * last_seconds);
    LUCARNE_TRY(request.wait || request.complete || fresh
                    ? surfels.load_all(chosen.all())
                    : surfels.load(chosen.all(), later, seconds, first ? kFirstPatience : 0));
    const auto error = surfels.take_error();
    if (error) return {};
    if (request.wait) return error;
    if (lost_node.empty()) lost_node = error.error().line();
    log::warn("{}; it is left out of the picture", error.error().line());
    return {};
}

/// Builds the cuts that have changed; the picture's average starts again then.
Result<void> Pipeline::State::build_cuts(bool hold_light) {
    times.begin("upload of cuts");
    const CutInputs from{device, surfels.pool(), *source, surfels.fillings(), scene, local.origin};
    LUCARNE_ASSIGN(const bool built, cuts.build(chosen, from, hold_light));
    times.end();
    if (built) presentation.restart();
    return {};
}

/// Returns the engines that draw this frame.
Result<DrawingEngines> Pipeline::State::drawing_engines(const FrameRequest& request) {
    if (request.colours_only) {
        if (!colours) {
            LUCARNE_ASSIGN(colours, gi::make_engine(gi::engine_with(&gi::EngineInfo::unlit).name));
        }
        return DrawingEngines{colours.get()};
    }
    const bool quick = request.stand_in || (request.stand_in_early && surfels.stats().pending > 0);
    const bool unprepared =
        request.stand_in_early && !request.wait && engine->info().precomputes && !baked.bake && !baked.ended;
    const auto may_draw = [&](const gi::Engine& one) {
        return !(quick && one.info().reports_progress) && !(unprepared && &one == engine.get());
    };
    gi::Engine* const compared = other && may_draw(*other) ? other.get() : nullptr;
    if (may_draw(*engine)) return DrawingEngines{engine.get(), compared};
    if (engine->keeps_light(settings, content)) return DrawingEngines{engine.get(), compared, true};
    if (!stand_in) {
        LUCARNE_ASSIGN(stand_in, gi::make_engine(gi::stand_in_engine().name));
    }
    return DrawingEngines{stand_in.get(), compared};
}

/// Frees what engines and G-buffer hold for more points than there is room for.
Result<void> Pipeline::State::make_engines_anew() {
    drawing = {};
    gbuffer = {};
    for (std::unique_ptr<gi::Engine>* one : {&engine, &other, &stand_in, &colours}) {
        if (!*one) continue;
        LUCARNE_ASSIGN(*one, gi::make_engine((*one)->info().name));
    }
    return {};
}

/// Returns whether pixels at edges show parts of their neighbours: in single pictures and the first frame of
/// an average; the others are antialiased by their rays. Not in sketches of few points. Nor in averages of
/// engines with further pictures, which average all frames as they are.
bool Pipeline::State::softens_edges(const FrameRequest& request) const {
    const bool averages_alone = request.accumulate && !drawing.engine->info().layers.empty();
    return request.antialiased && presentation.accumulated() == 0 && request.most_pixels == 0 &&
           !averages_alone;
}

/// Draws the G-buffer and lights it.
Result<void> Pipeline::State::draw(const FrameRequest& request) {
    times.begin("G-buffer");
    const gi::PointSize size{
        static_cast<float>(scene.look.point_size), static_cast<float>(scene.look.point_pixels),
        static_cast<float>(request.most_pixels), scene.look.front_only || request.front_only};
    LUCARNE_TRY(gi::rasterize(device, cuts.view(), camera, gbuffer, size));
    times.end();
    if (!scene.look.single_discs) {
        times.begin("blending");
        LUCARNE_TRY(gi::blend(device, cuts.view(), camera, gbuffer, size));
        times.end();
    }
    times.begin("edges");
    LUCARNE_TRY(gi::turn_rims(device, camera, gbuffer));
    if (softens_edges(request)) LUCARNE_TRY(gi::find_coverage(device, cuts.view(), camera, gbuffer, size));
    times.end();
    LUCARNE_TRY(draw_with(*drawing.engine, request, presentation.sample(false)));
    return drawing.compared ? draw_with(*drawing.compared, request, presentation.sample(true))
                            : Result<void>();
}

Result<void> Pipeline::State::draw_with(gi::Engine& by, const FrameRequest& request, gi::Buffer& target) {
    std::vector<gi::Light> lights;
    for (const gi::SceneLight& light : scene.lights) lights.push_back(gi::device_light(light, local));
    const auto& header = source->header();
    std::vector<gi::Material> materials = gi::materials_of(scene);
    const bool keeps_light = &by == drawing.engine && drawing.keeps_light;
    // An engine that stands in is there to be quick, also where nothing moves.
    gi::EngineSettings by_settings = settings;
    if (&by == stand_in.get()) by_settings.set(gi::kShadows, gi::Shadows::maps);
    gi::GlFrame on_device{device, surfels.pool(), cuts.of_frame(), gbuffer, target};
    gi::Frame frame{.camera = camera,
                    .lights = lights,
                    .materials = materials,
                    .background = glm::vec3(scene.background),
                    .settings = by_settings,
                    .index = presentation.accumulated(),
                    .environment = scene.environment,
                    .bounds = {local.to_local(header.min), local.to_local(header.max)},
                    .origin = local.origin,
                    .moving = request.moving || keeps_light,
                    .content = content,
                    .light_budget = keeps_light && request.light_budget.whole() ? gi::StepBudget::paused()
                                                                                : request.light_budget,
                    .bake = &by == engine.get() && by.info().precomputes ? baked.bake.get() : nullptr,
                    .bake_offset = glm::vec3((bake.frame().origin - local.origin) * local.metres_per_unit),
                    .stop = request.stop,
                    .progress = request.progress,
                    .unlit = unlit_of(scene.look),
                    .gl = on_device,
                    .times = times};
    return by.draw(frame);
}

Result<void> Pipeline::State::make_picture(const FrameRequest& request) {
    times.begin("load");
    LUCARNE_TRY(stream(request));
    times.end();
    LUCARNE_TRY(take_bake(request));
    LUCARNE_ASSIGN(const DrawingEngines now, drawing_engines(request));
    if (std::exchange(drawing, now) != now) presentation.restart();
    LUCARNE_TRY(build_cuts(drawing.engine->reads_light_cuts() || drawing.keeps_light));
    const bool other_sizes = std::exchange(most_pixels, request.most_pixels) != request.most_pixels;
    const bool other_sides = std::exchange(front_only, request.front_only) != request.front_only;
    if (!request.accumulate || !presentation.averaged() || other_sizes || other_sides) presentation.restart();
    const bool shifted = request.accumulate && request.antialiased;
    gi::shift_rays(camera, shifted ? presentation.accumulated() : 0);
    const Presentation::Averaging averaging{request.accumulate, request.transparent, softens_edges(request),
                                            static_cast<uint32_t>(kGapsPerPoint * request.most_pixels)};
    LUCARNE_TRY(presentation.reserve(size_t{request.size.width} * request.size.height, scene, averaging,
                                     drawing.compared != nullptr));
    LUCARNE_TRY(draw(request));
    if (stopped(request)) return {};
    times.begin("tone map");
    presentation.follow_exposure(request.exposure_seconds);
    LUCARNE_TRY(presentation.finish(*drawing.engine, drawing.compared, scene, gbuffer, averaging));
    times.end();
    return {};
}

FrameStats Pipeline::State::stats(double seconds) const {
    FrameStats result;
    result.passes = times.passes();
    result.seconds = seconds;
    result.view_points = cuts.view().surfels();
    result.light_points = cuts.light_points();
    result.light_view_points = cuts.light_view_points();
    result.wanted_points = chosen.points();
    result.ready_points = cuts.ready_points();  // clipped nodes count as drawn
    result.bytes_loaded = surfels.bytes_loaded();
    const octree::ResidencyStats streamed = surfels.stats();
    if (const gi::EngineInfo* prepared = bake.engine()) {
        result.prepared = baked.ended ? baked.share : std::min(baked.share, kAlmost);
        result.prepared_for = prepared->name;
    }
    result.prepares_again = last.prepares_again;
    result.prepared_file = baked.file;
    if (!baked.error) result.not_prepared = baked.error.error().line();
    if (!baked.keeping) result.not_kept = baked.keeping.error().line();
    result.nodes_pending = streamed.pending;
    result.nodes_lost = streamed.lost;
    result.lost_node = lost_node;
    result.ahead_loads = streamed.ahead_loads;
    result.ahead_hits = streamed.ahead_hits;
    result.cut_share = chosen.share;
    result.memory.host = source->directory_bytes() + streamed.transit_peak;
    result.memory.device = device.memory_used();
    result.memory.resident = resident_memory();
    result.accumulated = std::max(presentation.accumulated(), 1u);
    result.engine = engine->stats();
    result.lit_by = drawing.engine->info().name;
    if (drawing.compared) result.compared_with = drawing.compared->info().name;
    return result;
}

Pipeline::Pipeline() = default;
Pipeline::~Pipeline() = default;

Result<std::unique_ptr<Pipeline>> Pipeline::open(gi::Device& device,
                                                 std::shared_ptr<const octree::NodeSource> source,
                                                 const PipelineOptions& options) {
    std::unique_ptr<Pipeline> pipeline(new Pipeline);
    pipeline->state_ = std::make_unique<State>(device, options);
    State& state = *pipeline->state_;
    device.set_memory_cap(options.device_memory);
    LUCARNE_TRY(state.take_source(std::move(source)));
    state.fresh = false;  // there is no earlier picture that an incomplete one would replace
    state.scene = gi::default_scene(state.bounds[0], state.bounds[1], state.source->header().metres_per_unit);
    const Preset preset = *find_preset(kDefaultPreset);
    state.settings = preset.engine;
    state.budgets = preset.budgets;
    return pipeline;
}

Result<void> Pipeline::set_source(std::shared_ptr<const octree::NodeSource> source) {
    return state_->take_source(std::move(source));
}
const octree::NodeSource& Pipeline::source() const {
    return *state_->source;
}
const PipelineOptions& Pipeline::options() const {
    return state_->options;
}
const gi::EngineInfo& Pipeline::engine() const {
    return state_->engine->info();
}
const gi::EngineSettings& Pipeline::settings() const {
    return state_->settings;
}
const CutBudgets& Pipeline::budgets() const {
    return state_->budgets;
}
const gi::Scene& Pipeline::scene() const {
    return state_->scene;
}
const gi::GBuffer& Pipeline::gbuffer() const {
    return state_->gbuffer;
}
std::shared_ptr<const gi::CutPoints> Pipeline::points() const {
    return state_->cuts.view().points();
}
const gi::CameraView& Pipeline::camera() const {
    return state_->camera;
}
glm::dvec3 Pipeline::local_origin() const {
    return state_->local.origin;
}
const gi::ShownValues& Pipeline::values() const {
    return state_->surfels.values();
}
double Pipeline::exposure_ev() const {
    return state_->presentation.exposure_ev();
}
const gi::Buffer& Pipeline::picture() const {
    return state_->presentation.picture();
}
std::vector<std::vector<glm::vec4>> Pipeline::layers() const {
    auto layers = state_->engine->layers();
    // Those of an average are antialiased by the rays of its frames.
    if (state_->presentation.soft_edges())
        for (auto& layer : layers) layer = gi::share_edges(layer, state_->gbuffer);
    return layers;
}
const gi::Buffer& Pipeline::radiance() const {
    return state_->presentation.radiance();
}
const gi::Buffer& Pipeline::surface_radiance() const {
    return state_->presentation.sample(false);
}
std::vector<glm::vec4> Pipeline::points_radiance() const {
    const Presentation& presentation = state_->presentation;
    const gi::GBuffer& gbuffer = state_->gbuffer;
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    auto radiance = presentation.points_radiance().download_all<glm::vec4>(pixels);
    if (presentation.knows_shares()) return radiance;
    const auto texels = gbuffer.texels.download_all<gi::GBufferTexel>(pixels);
    for (size_t i = 0; i < pixels; ++i) radiance[i].w = texels[i].depth > 0 ? 1.0f : 0.0f;
    return radiance;
}

Result<void> Pipeline::set_engine(std::string_view name) {
    LUCARNE_ASSIGN(state_->engine, gi::make_engine(name));
    state_->changed = true;
    return {};
}

void Pipeline::on_prepared(std::function<void(const gi::BakeJob::Status&)> published) {
    state_->bake.on_news(std::move(published));
}

Result<std::filesystem::path> Pipeline::prepare(Progress* progress) {
    State& state = *state_;
    if (!state.engine) LUCARNE_TRY(set_engine(gi::default_engine().name));
    LUCARNE_TRY(state.surfels.renew(state.scene));
    LUCARNE_TRY(state.update_bake({}, false));
    LUCARNE_TRY(state.bake.wait(nullptr, progress));
    const gi::BakeJob::Status done = state.bake.status();
    LUCARNE_TRY(done.keeping);
    return done.file;
}

Result<void> Pipeline::set_method(const Method& method) {
    if (!state_->engine || state_->engine->info().name != method.engine)
        LUCARNE_TRY(set_engine(method.engine));
    set_settings(method.settings);
    set_budgets(method.budgets);
    return {};
}

void Pipeline::set_settings(const gi::EngineSettings& settings) {
    state_->changed |= !(settings == state_->settings);
    state_->settings = settings;
}

void Pipeline::set_budgets(const CutBudgets& budgets) {
    state_->changed |= !(budgets == state_->budgets);
    state_->budgets = budgets;
}

Result<void> Pipeline::set_scene(gi::Scene scene) {
    std::erase_if(scene.lights, [](const gi::SceneLight& light) { return !gi::shines(light); });
    if (!scene.environment_on) scene.environment.reset();
    if (!scene.comparison) {
        state_->other.reset();
        state_->presentation.forget_comparison();
    } else if (!state_->other || state_->other->info().name != scene.comparison->engine) {
        LUCARNE_ASSIGN(state_->other, gi::make_engine(scene.comparison->engine));
        state_->changed = true;
    }
    // A point's material and colour are packed into its surfel.
    if (!std::ranges::equal(scene.materials, state_->scene.materials, {}, &gi::SceneMaterial::assignment,
                            &gi::SceneMaterial::assignment) ||
        !gi::same_colours(scene.look, state_->scene.look) ||
        scene.albedo.packed() != state_->scene.albedo.packed())
        state_->surfels.make_stale();
    if (scene.light_inputs() != state_->scene.light_inputs()) {
        state_->changed = true;
        ++state_->content;
    }
    if (!(scene.look.clip == state_->scene.look.clip) ||
        scene.look.open_holes != state_->scene.look.open_holes)
        state_->cuts.tear();
    state_->scene = std::move(scene);
    return {};
}

Result<FrameStats> Pipeline::render(const FrameRequest& request) {
    State& state = *state_;
    const auto start = std::chrono::steady_clock::now();
    state.times.clear();
    if (!state.engine) LUCARNE_TRY(set_engine(gi::default_engine().name));
    LUCARNE_TRY(state.surfels.renew(state.scene));
    state.times.begin("cuts");
    if (state.changed || request.camera != state.last.camera || request.size != state.last.size ||
        state.needs(request) != state.chosen.needs) {
        state.choose_cuts(request);
        state.presentation.restart();
    }
    state.look_ahead(request);
    state.times.end();
    for (auto made = state.make_picture(request); !made; made = state.make_picture(request)) {
        // Pictures and maps may need more memory than the pool leaves.
        if (!state.device.take_refusal() || !state.surfels.shrink(state.scene))
            return tl::make_unexpected(made.error());
        LUCARNE_TRY(state.make_engines_anew());
        state.choose_cuts(request);
    }
    LUCARNE_TRY(state.device.check());
    state.times.finish();
    const bool given_up = stopped(request);
    state.last = request;
    state.changed = state.fresh = state.first = false;
    state.last_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    FrameStats stats = state.stats(state.last_seconds);
    stats.given_up = given_up;
    return stats;
}

}  // namespace lucarne::viewer
