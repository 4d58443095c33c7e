#include "viewer/frame/pipeline.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>
#include <span>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/gl_frame.h"
#include "gi/lighting/light_options.h"
#include "gi/raster/blend.h"
#include "gi/registry.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/colouring.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "octree/stream/motion.h"
#include "octree/stream/residency.h"
#include "octree/tree/robust_bounds.h"
#include "viewer/frame/cut_choice.h"
#include "viewer/frame/device_cuts.h"
#include "viewer/frame/prepare.h"
#include "viewer/frame/presentation.h"
#include "viewer/frame/views.h"

namespace lucarne::viewer {
namespace {

using Stream = octree::Residency<PackedNode>;

// Time in which a frame without `wait` accepts arrived nodes, s: enough for about a hundred nodes, which the
// loading threads have packed.
constexpr double kLoadingTime = 0.002;
constexpr size_t kNodesAtOnce = 8;  // nodes accepted between two looks at the clock
constexpr double kAhead = 0.5;      // s of the camera's motion that are loaded ahead
// Share of the device's memory for surfels. The shadow maps hold the light cut's surfels a second time;
// pictures and maps take the rest.
constexpr double kPoolShare = 0.375;
constexpr double kFilledShare = 0.25;                  // of the pool: the most that synthetic surfels take
constexpr uint64_t kLeastTransit = uint64_t{1} << 20;  // enough for some nodes of usual size

uint64_t pages(uint64_t surfels) {
    constexpr uint64_t kPage = gi::SurfelPool::kPageSurfels;
    return (surfels + kPage - 1) / kPage;
}
bool stopped(const FrameRequest& request) {
    return request.stop && *request.stop;
}
uint64_t pool_bytes(uint64_t surfels) {
    return pages(surfels) * gi::SurfelPool::kPageSurfels * sizeof(gi::PackedSurfel);
}

}  // namespace

struct Pipeline::State {
    State(gi::Device& on, const PipelineOptions& how)
        : device(on), options(how), times(on), presentation(on) {}

    Result<void> take_source(std::shared_ptr<const octree::NodeSource> from);
    Result<void> colour_anew();
    void empty_pool();
    void start_stream();
    void choose_cuts(const FrameRequest& request);
    void look_ahead(const FrameRequest& request);
    Result<void> stream(const FrameRequest& request);
    Result<void> take_arrivals(bool wait);
    Result<void> apply(std::span<const Stream::Event> events);
    uint64_t pool_surfels() const;
    void take_fillings();
    Result<void> load_fillings();
    uint64_t filled_bytes() const;
    Result<void> build_cuts(bool hold_light);
    Result<gi::Engine*> drawing_engine(const FrameRequest& request);
    Result<void> draw(gi::Engine& drawing, const FrameRequest& request);
    Result<void> draw_with(gi::Engine& drawing, const FrameRequest& request, gi::Buffer& target);
    Result<void> make_picture(const FrameRequest& request);
    bool shrink_pool();
    FrameStats stats(double seconds) const;

    gi::Device& device;
    std::shared_ptr<const octree::NodeSource> source;
    std::array<glm::dvec3, 2> bounds;  ///< robust bounds of the source, without far outliers
    PipelineOptions options;
    gi::PassTimes times;

    std::shared_ptr<SurfelPreparation> preparation;
    std::unique_ptr<Stream> residency;
    bool repack = true;  // the surfels' part of scene or look (materials, colours) has changed
    gi::ShownValues values;
    std::optional<gi::BakedLight> baked;  ///< of the source, once it was needed
    gi::SurfelPool pool;
    /// The synthetic surfels of the source. They are always resident, or left out.
    std::vector<octree::Filling> fillings;
    uint64_t bytes_loaded = 0;
    std::string lost_node;  // why the first unreadable node of the source cannot be read

    CutChooser chooser;
    CutSet chosen;
    octree::Motion motion;
    std::vector<octree::Cut> ahead;  // view cuts for the camera's future positions
    DeviceCuts cuts;
    LocalFrame local;

    std::unique_ptr<gi::Engine> engine, other;  ///< the picture's engine; the compared one, or null
    std::unique_ptr<gi::Engine> stand_in;       ///< once it was needed (FrameRequest::stand_in)
    gi::EngineSettings settings;
    CutBudgets budgets;
    gi::Scene scene;
    bool fresh = false;  // the source is new, and nothing of it has been drawn yet
    // Scene, settings, budgets or engine have changed: cuts are chosen again, and the average starts again.
    bool changed = true;

    FrameRequest last;
    double last_seconds = 0;  // duration of the last frame
    double most_pixels = 0;   // FrameRequest::most_pixels of the last frame
    gi::CameraView camera{};
    gi::GBuffer gbuffer;
    Presentation presentation;
};

/// Returns the size of the pool: what the caps allow, but at most the whole cloud.
uint64_t Pipeline::State::pool_surfels() const {
    uint64_t whole = 0, largest = 0;
    for (const octree::NodeInfo& node : source->nodes()) {
        whole += pool_bytes(node.count);
        largest = std::max(largest, pool_bytes(node.count));
    }
    whole += filled_bytes();
    // Room for recoloured nodes that arrive before the old ones are freed.
    whole += (options.load_threads + 1) * largest;
    const auto share = static_cast<uint64_t>(kPoolShare * static_cast<double>(options.device_memory));
    const uint64_t bytes = std::min({whole, share, device.info().max_texel_bytes});
    return std::min<uint64_t>(bytes / sizeof(gi::PackedSurfel), UINT32_MAX);
}

void Pipeline::State::empty_pool() {
    residency.reset();
    if (!source) return;
    for (uint32_t node = 0; node < source->nodes().size(); ++node)
        if (pool.holds(node)) pool.evict(node);
    for (uint32_t node = gi::kFirstFilled; pool.holds(node); ++node) pool.evict(node);
}

/// Bytes of the pool that the synthetic surfels take.
uint64_t Pipeline::State::filled_bytes() const {
    uint64_t bytes = 0;
    for (const octree::Filling& filling : fillings)
        for (const octree::NodeInfo& node : filling.nodes) bytes += pool_bytes(node.count);
    return bytes;
}

/// Loads the source's synthetic surfels, for load_fillings(). Without them there are holes, but a picture.
void Pipeline::State::take_fillings() {
    fillings.clear();
    auto loaded = source->fillings();
    if (loaded)
        fillings = std::move(*loaded);
    else
        log::warn("{}; holes of the scan stay open", loaded.error().line());
}

/// Packs the synthetic surfels for the device.
Result<void> Pipeline::State::load_fillings() {
    uint32_t number = gi::kFirstFilled;
    for (const octree::Filling& filling : fillings)
        for (uint32_t node = 0; node < filling.nodes.size(); ++node) {
            LUCARNE_ASSIGN(const bool fits, pool.load(number++, preparation->pack(filling, node)));
            if (!fits) return failed("surfel pool", "the stream holds more nodes than fit");
        }
    cuts.tear();
    return {};
}

Result<void> Pipeline::State::take_source(std::shared_ptr<const octree::NodeSource> from) {
    if (const uint64_t bytes = from->directory_bytes(); options.memory < bytes + kLeastTransit)
        return bad_arguments("--memory",
                             fmt::format("{} are too little: the directory of the octree alone takes {}",
                                         bytes_text(options.memory), bytes_text(bytes)),
                             "allow more");
    empty_pool();
    source = std::move(from);
    lost_node.clear();
    baked.reset();
    bounds = octree::robust_bounds(*source);
    take_fillings();
    const uint64_t capacity = pool_surfels();
    if (capacity > pool.capacity()) {
        pool = {};
        LUCARNE_ASSIGN(pool, gi::SurfelPool::create(device, static_cast<uint32_t>(capacity)));
    }
    start_stream();
    changed = fresh = true;
    return {};
}

/// Starts the stream with nothing resident. What fits the stream's cap also fits the pool, because a node
/// costs the same pages in both.
void Pipeline::State::start_stream() {
    empty_pool();
    if (static_cast<double>(filled_bytes()) >
        kFilledShare * static_cast<double>(pool_bytes(pool.capacity()))) {
        log::warn("there is too little device memory to fill the holes of the scan");
        fillings.clear();
    }
    octree::ResidencyOptions how;
    how.memory = pool_bytes(pool.capacity()) - filled_bytes();
    how.transit = options.memory - source->directory_bytes();
    how.threads = options.load_threads;
    how.cost = [](const octree::NodeInfo& node) { return pool_bytes(node.count); };
    preparation = std::make_shared<SurfelPreparation>(source, scene);
    octree::Preparation<PackedNode> pack;
    pack.make = [packing = preparation](uint32_t node, octree::NodeData&& data) {
        return packing->pack(node, data);
    };
    pack.most_bytes = [](const octree::NodeInfo& node) {
        return uint64_t{node.count} * sizeof(gi::PackedSurfel);
    };
    repack = true;
    residency = std::make_unique<Stream>(*source, how, std::move(pack));
    cuts.tear();
}

/// Loads all resident nodes again for new materials or colours, which are packed into the surfels. Nodes are
/// replaced one by one while the old ones are drawn.
Result<void> Pipeline::State::colour_anew() {
    repack = false;
    values = gi::measured_values(*source, scene.look);
    gi::Scene shown = scene;
    shown.look.range = values.range;
    if (scene.albedo.flatten > 0 && !baked) {
        LUCARNE_ASSIGN(baked, gi::BakedLight::measured(*source));
    }
    preparation->set_scene(shown, baked ? &*baked : nullptr);
    LUCARNE_TRY(load_fillings());
    std::vector<uint32_t> all(source->nodes().size());
    std::iota(all.begin(), all.end(), 0u);
    residency->renew(all);
    return {};
}

void Pipeline::State::choose_cuts(const FrameRequest& request) {
    const CutPurpose purpose{*source,
                             request.camera,
                             request.size,
                             scene.lights,
                             settings[gi::kLightResolution],
                             budgets,
                             glm::distance(bounds[0], bounds[1]),
                             &scene.look.clip};
    chosen = chooser.choose(purpose, {pool_bytes(pool.capacity()) - filled_bytes(),
                                      [](const auto& node) { return pool_bytes(node.count); }});
    const glm::dvec3 origin = local.origin;
    local = local_frame(request.camera.position, source->header().metres_per_unit);
    if (local.origin != origin) cuts.tear();
    camera = camera_view(request.camera, request.size, local);
    cuts.changed();
}

/// Chooses cuts for what the camera will see if it continues its motion.
void Pipeline::State::look_ahead(const FrameRequest& request) {
    ahead.clear();
    if (request.wait || !request.moving || !options.prefetch) return motion.forget();
    motion.observe(octree_view(request.camera, request.size));
    const double frames = std::clamp(kAhead / std::max(last_seconds, 1e-3), 2.0, 30.0);
    for (const double part : {0.5, 1.0})
        if (const auto view_there = motion.ahead(part * frames))
            ahead.push_back(octree::view_cut(*source, *view_there, budgets.view, budgets.pixel_spacing));
}

/// Applies the stream's events to the device.
Result<void> Pipeline::State::apply(std::span<const Stream::Event> events) {
    for (const Stream::Event& event : events) {
        cuts.changed();
        if (event.kind != Stream::Kind::loaded) {
            pool.evict(event.node);
            cuts.node_gone(event.node);
        }
        if (event.kind == Stream::Kind::evicted) continue;
        bytes_loaded += source->nodes()[event.node].payload_bytes;
        LUCARNE_ASSIGN(const bool fits, pool.load(event.node, *event.data));
        if (!fits) return failed("surfel pool", "the stream holds more nodes than fit");
    }
    return {};
}

/// Accepts arrived nodes; with `wait` all of them.
Result<void> Pipeline::State::take_arrivals(bool wait) {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
        const auto events = residency->poll(kNodesAtOnce);
        LUCARNE_TRY(apply(events));
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        if (events.empty() || (!wait && spent.count() > kLoadingTime)) return {};
    }
}

/// Loads nodes of the chosen cuts; with `wait` as many as the caps allow.
Result<void> Pipeline::State::stream(const FrameRequest& request) {
    const bool wait = request.wait || fresh;
    std::vector<const octree::Cut*> later;
    for (const octree::Cut& cut : ahead) later.push_back(&cut);
    residency->want(chosen.all(), later);
    for (bool all = false; !all;) {
        all = !wait || residency->wait();
        LUCARNE_TRY(take_arrivals(wait));
    }
    const auto error = residency->take_error();
    if (error) return {};
    if (request.wait) return error;
    if (lost_node.empty()) lost_node = error.error().line();
    log::warn("{}; it is left out of the picture", error.error().line());
    return {};
}

/// Builds the cuts that have changed; the picture's average starts again then.
Result<void> Pipeline::State::build_cuts(bool hold_light) {
    times.begin("upload of cuts");
    const CutParts from{device, pool, *source, fillings, scene, local.origin};
    LUCARNE_ASSIGN(const bool built, cuts.build(chosen, from, hold_light));
    times.end();
    if (built) presentation.restart();
    return {};
}

/// Returns the engine that draws this frame.
Result<gi::Engine*> Pipeline::State::drawing_engine(const FrameRequest& request) {
    if (!request.stand_in || !engine->info().reports_progress) return engine.get();
    if (!stand_in) {
        LUCARNE_ASSIGN(stand_in, gi::make_engine(gi::default_engine().name));
    }
    return stand_in.get();
}

/// Draws the G-buffer and lights it.
Result<void> Pipeline::State::draw(gi::Engine& drawing, const FrameRequest& request) {
    times.begin("G-buffer");
    const gi::PointSize size{static_cast<float>(scene.look.point_size),
                             static_cast<float>(scene.look.point_pixels),
                             static_cast<float>(request.most_pixels)};
    LUCARNE_TRY(gi::rasterize(device, cuts.view(), camera, gbuffer, size));
    times.end();
    if (!scene.look.single_discs) {
        times.begin("blending");
        LUCARNE_TRY(gi::blend(device, cuts.view(), camera, gbuffer, size));
        times.end();
    }
    LUCARNE_TRY(draw_with(drawing, request, presentation.sample(false)));
    return other ? draw_with(*other, request, presentation.sample(true)) : Result<void>();
}

Result<void> Pipeline::State::draw_with(gi::Engine& drawing, const FrameRequest& request,
                                        gi::Buffer& target) {
    const size_t pixels = size_t{request.size.width} * request.size.height;
    LUCARNE_TRY(device.reserve(target, pixels * sizeof(glm::vec4), "the picture's radiance"));
    std::vector<gi::Light> lights;
    for (const gi::SceneLight& light : scene.lights) lights.push_back(device_light(light, local));
    const auto& header = source->header();
    std::vector<gi::Material> materials;
    for (const auto& material : scene.materials)
        materials.push_back(device_material(material, scene.albedo.scale));
    gi::GlFrame on_device{device, pool, cuts.of_frame(), gbuffer, target};
    gi::Frame frame{.camera = camera,
                    .lights = lights,
                    .materials = materials,
                    .background = glm::vec3(scene.background),
                    .settings = settings,
                    .index = presentation.accumulated(),
                    .environment = scene.environment,
                    .bounds = {local.to_local(header.min), local.to_local(header.max)},
                    .moving = request.moving,
                    .light_seconds = request.light_seconds,
                    .stop = request.stop,
                    .progress = request.progress,
                    .unlit = scene.look.unlit,
                    .gl = on_device,
                    .times = times};
    return drawing.draw(frame);
}

Result<void> Pipeline::State::make_picture(const FrameRequest& request) {
    times.begin("load");
    LUCARNE_TRY(stream(request));
    times.end();
    LUCARNE_ASSIGN(gi::Engine* const drawing, drawing_engine(request));
    LUCARNE_TRY(build_cuts(drawing->reads_light_cuts()));
    const bool other_points = std::exchange(most_pixels, request.most_pixels) != request.most_pixels;
    if (!request.accumulate || !presentation.averaged() || other_points) presentation.restart();
    const bool shifted = request.accumulate && request.antialiased;
    shift_rays(camera, shifted ? presentation.accumulated() : 0);
    LUCARNE_TRY(draw(*drawing, request));
    if (stopped(request)) return {};
    times.begin("tone map");
    presentation.follow_exposure(request.exposure_seconds);
    LUCARNE_TRY(presentation.finish(*drawing, other.get(), scene, gbuffer,
                                    {request.accumulate, request.transparent}));
    times.end();
    return {};
}

/// Frees a quarter of the pool. Returns false if little of it is left.
bool Pipeline::State::shrink_pool() {
    const uint64_t capacity = uint64_t{pool.capacity()} * 3 / 4;
    if (capacity < pool_surfels() / 16 + gi::SurfelPool::kPageSurfels) return false;
    pool = {};
    auto smaller = gi::SurfelPool::create(device, static_cast<uint32_t>(capacity));
    if (!smaller) return false;
    pool = std::move(*smaller);
    start_stream();
    return true;
}

FrameStats Pipeline::State::stats(double seconds) const {
    FrameStats result;
    result.passes = times.passes();
    result.seconds = seconds;
    result.view_points = cuts.view().surfels();
    result.light_points = cuts.of_frame().light->surfels();
    result.light_view_points = cuts.light_view_points();
    result.wanted_points = chosen.points();
    result.ready_points = cuts.ready_points();  // clipped nodes count as drawn
    result.bytes_loaded = bytes_loaded;
    const octree::ResidencyStats streamed = residency->stats();
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
    return state_->values;
}
double Pipeline::exposure_ev() const {
    return state_->presentation.exposure_ev();
}
const gi::Buffer& Pipeline::picture() const {
    return state_->presentation.picture();
}
std::vector<std::vector<glm::vec4>> Pipeline::layers() const {
    return state_->engine->layers();
}
const gi::Buffer& Pipeline::radiance() const {
    return state_->presentation.radiance();
}
std::vector<glm::vec4> Pipeline::points_radiance() const {
    const Presentation& presentation = state_->presentation;
    const gi::GBuffer& gbuffer = state_->gbuffer;
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    auto radiance = presentation.points_radiance().download_all<glm::vec4>(pixels);
    if (presentation.averaged()) return radiance;
    const auto texels = gbuffer.texels.download_all<gi::GBufferTexel>(pixels);
    for (size_t i = 0; i < pixels; ++i) radiance[i].w = texels[i].depth > 0 ? 1.0f : 0.0f;
    return radiance;
}

Result<void> Pipeline::set_engine(std::string_view name) {
    LUCARNE_ASSIGN(state_->engine, gi::make_engine(name));
    state_->changed = true;
    return {};
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
    state_->repack |= !std::ranges::equal(scene.materials, state_->scene.materials, {},
                                          &gi::SceneMaterial::assignment, &gi::SceneMaterial::assignment) ||
                      !gi::same_colours(scene.look, state_->scene.look) ||
                      scene.albedo.flatten != state_->scene.albedo.flatten ||
                      scene.albedo.balance != state_->scene.albedo.balance;
    state_->changed |= scene.light_inputs() != state_->scene.light_inputs();
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
    if (state.repack) LUCARNE_TRY(state.colour_anew());
    state.times.begin("cuts");
    if (state.changed || request.camera != state.last.camera || request.size != state.last.size) {
        state.choose_cuts(request);
        state.presentation.restart();
    }
    state.look_ahead(request);
    state.times.end();
    for (auto made = state.make_picture(request); !made; made = state.make_picture(request)) {
        // Pictures and maps may need more memory than the pool leaves.
        if (!state.device.take_refusal() || !state.shrink_pool()) return tl::make_unexpected(made.error());
        state.choose_cuts(request);
    }
    LUCARNE_TRY(state.device.check());
    state.times.finish();
    const bool given_up = stopped(request);
    state.last = request;
    state.changed = state.fresh = false;
    state.last_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    FrameStats stats = state.stats(state.last_seconds);
    stats.given_up = given_up;
    return stats;
}

}  // namespace lucarne::viewer
