#include "viewer/pipeline.h"

#include <algorithm>
#include <chrono>
#include <span>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "gi/post/accumulate.h"
#include "gi/post/tone_map.h"
#include "gi/registry.h"
#include "io/core/log.h"
#include "io/core/parallel.h"
#include "octree/stream/cut.h"
#include "octree/stream/residency.h"
#include "viewer/views.h"

namespace lucarne::viewer {
namespace {

using octree::ResidencyEvent;

// A frame that does not wait takes nodes in for this share of the time that the last one took, and a step at
// least: it stays about as short, and slow frames do not keep a picture waiting for its nodes.
constexpr double kUploadShare = 0.25;
constexpr size_t kNodesAtOnce = 64;  // packed in parallel before they are uploaded
constexpr double kFocusCells = 32;   // the light cut's focus moves in steps of 1/32 of the root cube

uint64_t pages(uint64_t surfels) {
    constexpr uint64_t kPage = gi::SurfelPool::kPageSurfels;
    return (surfels + kPage - 1) / kPage;
}
uint64_t pool_bytes(uint64_t surfels) {
    return pages(surfels) * gi::SurfelPool::kPageSurfels * sizeof(gi::PackedSurfel);
}

bool same_view(const FrameRequest& a, const FrameRequest& b) {
    return a.camera.position == b.camera.position && a.camera.target == b.camera.target &&
           a.camera.up == b.camera.up && a.camera.vertical_fov == b.camera.vertical_fov &&
           a.size.width == b.size.width && a.size.height == b.size.height;
}

bool same_assignments(const std::vector<gi::SceneMaterial>& a, const std::vector<gi::SceneMaterial>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return x.classification == y.classification && x.scan == y.scan && x.box == y.box;
    });
}

/// What is chosen for a purpose, and what of it stands on the device.
struct DrawnCut {
    octree::Cut chosen;
    gi::DeviceCut drawn;

    Result<void> build(gi::Device& device, const gi::SurfelPool& pool, const octree::NodeSource& source,
                       const glm::dvec3& origin) {
        std::vector<gi::CutEntry> entries;
        entries.reserve(chosen.nodes.size());
        for (const auto& node : chosen.nodes) entries.push_back({node.node, node.count});
        return pool.make_cut(device, source, entries, origin, drawn);
    }
};

}  // namespace

struct Pipeline::State {
    State(gi::Device& on, std::shared_ptr<const octree::NodeSource> from, const PipelineOptions& how)
        : device(on), source(std::move(from)), options(how), times(on) {}

    void start_stream();
    void choose_cuts(const FrameRequest& request);
    Result<void> stream(bool wait);
    Result<bool> take_arrivals(bool wait);
    Result<bool> apply(std::span<const ResidencyEvent> events);
    Result<void> build_cuts();
    Result<void> draw(const FrameRequest& request);
    Result<void> finish(const FrameRequest& request);
    FrameStats stats(double seconds) const;

    gi::Device& device;
    std::shared_ptr<const octree::NodeSource> source;
    PipelineOptions options;
    gi::PassTimes times;

    std::unique_ptr<octree::Residency> residency;
    gi::SurfelPool pool;
    uint64_t bytes_loaded = 0;

    DrawnCut view, light_cut;
    std::vector<DrawnCut> light_views;
    LocalFrame local;
    bool cuts_stale = true;  // the device's cuts differ from what is chosen and resident

    std::unique_ptr<gi::Engine> engine;
    gi::EngineSettings settings;
    CutBudgets budgets;
    gi::Scene scene;
    bool changed =
        true;  // scene, settings, budgets or engine: cuts are chosen anew, the average starts again

    FrameRequest last;
    double last_seconds = 0;  // that the last frame took
    gi::CameraView camera{};
    gi::GBuffer gbuffer;
    gi::Buffer sample, mean, picture;  // radiance of this frame, of the average; RGBA8
    uint32_t accumulated = 0;          // frames in `mean`
    bool averaged = false;             // the last picture is `mean`
    double exposure_ev = 0;
};

/// Begins with nothing resident. What fits the stream's cap fits the pool, because a node costs its pages in
/// both.
void Pipeline::State::start_stream() {
    if (residency) residency.reset();
    for (uint32_t node = 0; node < source->nodes().size(); ++node)
        if (pool.holds(node)) pool.evict(node);
    octree::ResidencyOptions how;
    how.memory = pool_bytes(pool.capacity());
    how.threads = options.load_threads;
    how.cost = [](const octree::NodeInfo& node) { return pool_bytes(node.count); };
    residency = std::make_unique<octree::Residency>(*source, how);
    cuts_stale = true;
}

void Pipeline::State::choose_cuts(const FrameRequest& request) {
    const double unit = source->header().metres_per_unit;
    const octree::View eye = octree_view(request.camera, request.size);
    const LocalFrame frame = local_frame(request.camera.position, unit);
    view.chosen = octree::view_cut(*source, eye, budgets.view, budgets.pixel_spacing);
    light_views.resize(scene.lights.size());
    for (size_t i = 0; i < light_views.size(); ++i)
        light_views[i].chosen =
            light_view_cut(*source, scene.lights[i], settings.light_resolution, budgets.light_view);
    // The focus moves in steps, so that bounced light does not shimmer while the camera glides.
    const auto& root = source->header().root;
    const double step = root.size / kFocusCells;
    const glm::dvec3 focus = root.min + glm::floor((eye.position - root.min) / step + 0.5) * step;
    light_cut.chosen = octree::light_cut(*source, focus, budgets.light);
    local = frame;
    camera = camera_view(request.camera, request.size, local);
    cuts_stale = true;
}

/// Sends what the stream reports to the device. False when the pool's free pages lie too scattered for a
/// node.
Result<bool> Pipeline::State::apply(std::span<const ResidencyEvent> events) {
    const auto& header = source->header();
    for (size_t first = 0; first < events.size(); first += kNodesAtOnce) {
        const auto group = events.subspan(first, std::min(kNodesAtOnce, events.size() - first));
        std::vector<std::vector<gi::PackedSurfel>> packed(group.size());
        parallel_ranges(group.size(), 1, [&](size_t i, size_t) {
            if (group[i].data)
                packed[i] = gi::pack_surfels(header, source->nodes()[group[i].node], *group[i].data, scene);
        });
        for (size_t i = 0; i < group.size(); ++i) {
            cuts_stale = true;
            if (group[i].kind != ResidencyEvent::Kind::loaded) pool.evict(group[i].node);
            if (group[i].kind == ResidencyEvent::Kind::evicted) continue;
            bytes_loaded += source->nodes()[group[i].node].payload_bytes;
            LUCARNE_ASSIGN(const bool fits, pool.load(group[i].node, packed[i]));
            if (!fits) return false;
        }
    }
    return true;
}

/// What has arrived, all of it with `wait`. False as in apply().
Result<bool> Pipeline::State::take_arrivals(bool wait) {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
        const auto events = residency->poll(wait ? SIZE_MAX : kNodesAtOnce);
        LUCARNE_ASSIGN(const bool applied, apply(events));
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        if (!applied || wait || events.empty() || spent.count() > kUploadShare * last_seconds) return applied;
    }
}

/// Brings the pool closer to the chosen cuts, or with `wait` as close as the caps allow.
Result<void> Pipeline::State::stream(bool wait) {
    std::vector<const octree::Cut*> wanted = {&view.chosen, &light_cut.chosen};
    for (const auto& cut : light_views) wanted.push_back(&cut.chosen);
    // A second round only where the pool was too scattered: an emptied pool is filled from its start.
    for (int round = 0; round < 2; ++round) {
        residency->want(wanted);
        if (wait) residency->wait();
        LUCARNE_ASSIGN(const bool applied, take_arrivals(wait));
        if (applied) break;
        start_stream();
    }
    const auto error = residency->take_error();
    if (!error && wait) return error;
    if (!error) log::warn("{}; it is left out of the picture", error.error().line());
    return {};
}

Result<void> Pipeline::State::build_cuts() {
    LUCARNE_TRY(view.build(device, pool, *source, local.origin));
    LUCARNE_TRY(light_cut.build(device, pool, *source, local.origin));
    for (auto& cut : light_views) LUCARNE_TRY(cut.build(device, pool, *source, local.origin));
    cuts_stale = false;
    return {};
}

/// G-buffer and light.
Result<void> Pipeline::State::draw(const FrameRequest& request) {
    const size_t pixels = size_t{request.size.width} * request.size.height;
    LUCARNE_TRY(device.reserve(sample, pixels * sizeof(glm::vec4), "the picture's radiance"));
    times.begin("G-buffer");
    LUCARNE_TRY(gi::rasterize(device, view.drawn, camera, gbuffer));
    times.end();
    gi::FrameCuts cuts{&view.drawn, {}, &light_cut.drawn};
    std::vector<gi::Light> lights;
    for (size_t i = 0; i < light_views.size(); ++i) {
        cuts.light_views.push_back(&light_views[i].drawn);
        lights.push_back(device_light(scene.lights[i], local));
    }
    const auto& header = source->header();
    std::vector<gi::Material> materials;
    for (const auto& material : scene.materials) materials.push_back(device_material(material));
    gi::Frame frame{device,
                    pool,
                    cuts,
                    camera,
                    gbuffer,
                    lights,
                    materials,
                    glm::vec3(scene.background),
                    settings,
                    accumulated,
                    sample,
                    times,
                    scene.environment,
                    {local.to_local(header.min), local.to_local(header.max)},
                    request.progress};
    LUCARNE_TRY(engine->prepare(frame));
    return engine->render(frame);
}

/// Average and tone map.
Result<void> Pipeline::State::finish(const FrameRequest& request) {
    const uint32_t pixels = request.size.width * request.size.height;
    ++accumulated;
    averaged = request.accumulate;
    times.begin("tone map");
    if (averaged) {
        LUCARNE_TRY(device.reserve(mean, pixels * sizeof(glm::vec4), "the picture's average"));
        LUCARNE_TRY(gi::accumulate(device, sample, pixels, accumulated, mean));
    }
    const gi::Buffer& radiance = averaged ? mean : sample;
    exposure_ev = 0;
    if (scene.exposure_ev) {
        exposure_ev = *scene.exposure_ev;
    } else {
        LUCARNE_ASSIGN(exposure_ev, gi::automatic_exposure(device, radiance, pixels));
    }
    LUCARNE_TRY(gi::tone_map(device, radiance, pixels, scene.tone_map, exposure_ev, picture));
    times.end();
    return {};
}

FrameStats Pipeline::State::stats(double seconds) const {
    FrameStats result;
    result.passes = times.passes();
    result.seconds = seconds;
    result.view_points = view.drawn.surfels();
    result.light_points = light_cut.drawn.surfels();
    result.wanted_points = view.chosen.points + light_cut.chosen.points;
    for (const auto& cut : light_views) {
        result.light_view_points += cut.drawn.surfels();
        result.wanted_points += cut.chosen.points;
    }
    result.ready_points = result.view_points + result.light_points + result.light_view_points;
    result.bytes_loaded = bytes_loaded;
    result.nodes_pending = residency->stats().pending;
    result.accumulated = std::max(accumulated, 1u);
    result.engine = engine->stats();
    return result;
}

Pipeline::Pipeline() = default;
Pipeline::~Pipeline() = default;

Result<std::unique_ptr<Pipeline>> Pipeline::open(gi::Device& device,
                                                 std::shared_ptr<const octree::NodeSource> source,
                                                 const PipelineOptions& options) {
    std::unique_ptr<Pipeline> pipeline(new Pipeline);
    pipeline->state_ = std::make_unique<State>(device, std::move(source), options);
    State& state = *pipeline->state_;
    device.set_memory_cap(options.device_memory);
    // One buffer holds the pool: half of what is free is left to pictures, maps and cuts.
    const uint64_t most =
        std::min(device.info().max_buffer_bytes, options.device_memory / 2) / sizeof(gi::PackedSurfel);
    const auto capacity = static_cast<uint32_t>(std::min<uint64_t>(options.pool_surfels, most));
    LUCARNE_ASSIGN(state.pool, gi::SurfelPool::create(device, capacity));
    const auto& header = state.source->header();
    state.scene = gi::default_scene(header.min, header.max, header.metres_per_unit);
    const Preset preset = *find_preset(kDefaultPreset);
    state.settings = preset.engine;
    state.budgets = preset.budgets;
    state.start_stream();
    return pipeline;
}

const octree::NodeSource& Pipeline::source() const {
    return *state_->source;
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
const gi::CameraView& Pipeline::camera() const {
    return state_->camera;
}
glm::dvec3 Pipeline::local_origin() const {
    return state_->local.origin;
}
double Pipeline::exposure_ev() const {
    return state_->exposure_ev;
}
const gi::Buffer& Pipeline::picture() const {
    return state_->picture;
}
std::vector<std::vector<glm::vec4>> Pipeline::layers() const {
    return state_->engine->layers();
}
const gi::Buffer& Pipeline::radiance() const {
    return state_->averaged ? state_->mean : state_->sample;
}

Result<void> Pipeline::set_engine(std::string_view name) {
    LUCARNE_ASSIGN(state_->engine, gi::make_engine(name));
    state_->changed = true;
    return {};
}

void Pipeline::set_settings(const gi::EngineSettings& settings) {
    state_->settings = settings;
    state_->changed = true;
}

void Pipeline::set_budgets(const CutBudgets& budgets) {
    state_->budgets = budgets;
    state_->changed = true;
}

void Pipeline::set_scene(gi::Scene scene) {
    // Which material a point has is packed into its surfel.
    const bool repack = !same_assignments(scene.materials, state_->scene.materials);
    state_->scene = std::move(scene);
    state_->changed = true;
    if (repack) state_->start_stream();
}

Result<FrameStats> Pipeline::render(const FrameRequest& request) {
    State& state = *state_;
    const auto start = std::chrono::steady_clock::now();
    state.times.clear();
    if (!state.engine) LUCARNE_TRY(set_engine(kDefaultEngine));
    state.times.begin("cuts");
    if (state.changed || !same_view(request, state.last)) {
        state.choose_cuts(request);
        state.accumulated = 0;
    }
    state.times.end();
    state.times.begin("load");
    LUCARNE_TRY(state.stream(request.wait));
    state.times.end();
    if (state.cuts_stale) {
        state.times.begin("upload of cuts");
        LUCARNE_TRY(state.build_cuts());
        state.times.end();
        state.accumulated = 0;
    }
    if (!request.accumulate) state.accumulated = 0;
    LUCARNE_TRY(state.draw(request));
    LUCARNE_TRY(state.finish(request));
    state.last = request;
    state.changed = false;
    state.last_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return state.stats(state.last_seconds);
}

}  // namespace lucarne::viewer
