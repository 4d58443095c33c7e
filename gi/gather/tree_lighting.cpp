#include "gi/gather/tree_lighting.h"

#include <string>
#include <utility>

#include "gi/gather/gather_options.h"
#include "gi/gather/traced_lights.h"
#include "gi/gather/vpl_exchange.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/light_options.h"
#include "gi/shared/lobe.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

constexpr size_t kSlotsATask = 65536;

/// Returns the view whose rays pass through the middles of its pixels: frames of an average have this in
/// common.
CameraView middle_view(CameraView view) {
    view.right.w = view.up.w = 0;
    return view;
}

}  // namespace

void TreeLighting::update(const Changes& changes) {
    scene_ = changes.scene;
    cuts_ = changes.light_cuts;
}

Result<void> TreeLighting::prepare(Frame& frame, std::string_view engine) {
    if (frame.gl.cuts.light_views.size() < frame.lights.size() || !frame.gl.cuts.light)
        return failed(std::string(engine), "the cuts of the light are missing");
    LUCARNE_ASSIGN(opencl_, frame.gl.device.opencl());
    LUCARNE_TRY(upload_sky(frame, background_));
    if (sky_of_ != scene_.environment) {
        sky_of_.reset();
        sky_ = gather_sky(frame.environment);
        bright_ = SkyDirections(sky_.bright);
        LUCARNE_TRY(gatherer_.set_sky(*opencl_, sky_));
        if (has_sky())
            openings_.set_sky(sky_);
        else
            drop_openings();
        sky_of_ = scene_.environment;
    }
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

void TreeLighting::begin(Frame& frame) {
    views_ = light_views(frame, bright_, frame.index);
    light_gbuffers_.begin(frame.gl.device, views_, views_.size());
    gatherer_.set_no_openings();
}

Result<void> TreeLighting::make_tree(Frame& frame) {
    if (tree_of_ == cuts_.light) return {};
    const TimedPass pass(frame, "surfel tree");
    tree_of_.reset();
    light_of_.reset();
    photons_.reset();
    bright_light_ = {};
    drop_openings();
    traced_.reset();
    LUCARNE_TRY(gatherer_.set_tree(*opencl_, nullptr));  // the old one needs no memory beside the new one
    LUCARNE_TRY(lit_.set_surfels(frame));
    LUCARNE_TRY(gatherer_.set_tree(*opencl_, lit_.kept_tree()));
    tree_of_ = cuts_.light;
    return {};
}

Result<void> TreeLighting::exchange(Frame& frame, Radiosity::Settings settings, LightPoints points,
                                    std::vector<SideLight>& light) {
    const bool by_rays = points != LightPoints::radiosity && settings.bounces > 0;
    const bool by_vpls = points == LightPoints::vpls;
    const ExchangeSettings rays{.sources = by_vpls ? frame.settings[kVpls] : frame.settings[kPhotons],
                                .bounces = settings.bounces,
                                .only_last = settings.only_last,
                                .seed = settings.seed};
    lobes_ = settings.bounces == 0 || !settings.only_last ? lit_.lobes() : SideLobes{};
    if (by_rays) settings.bounces = 0;
    {
        const TimedPass pass(frame, "radiosity");
        if (settings.bounces > 0 || settings.sky)
            LUCARNE_TRY(radiosity_.choose_places(*opencl_, lit_, gatherer_, frame.settings[kRadiosityLevel],
                                                 settings.seed, frame.stop));
        if (frame.stopped()) return {};
        LUCARNE_TRY(radiosity_.compute(*opencl_, lit_, gatherer_, settings, light, frame.stop));
    }
    if (frame.stopped() || !by_rays) return {};
    const TimedPass pass(frame, by_vpls ? "VPLs" : "photons");
    LUCARNE_TRY(trace_tree(frame));
    const std::vector<Material> materials = device_materials(frame.materials);
    SideLobes lobes = lit_.lobes_of_surfels();
    if (by_vpls) {
        add_light_of_vpls(*traced_, materials, rays, light, lobes, frame.stop);
    } else {
        if (!photons_) {
            photons_.emplace();
            photons_->set_surfels(lit_, *traced_, frame.stop);
            if (frame.stopped()) {
                photons_.reset();
                return {};
            }
        }
        photons_->trace(lit_, *traced_, materials, rays, light, lobes, frame.stop);
    }
    lobes_ = lit_.pulled(lobes);
    return {};
}

Result<void> TreeLighting::make_light(Frame& frame, const Radiosity::Settings& settings, LightPoints points) {
    Basis basis{scene_, cuts_, {}, settings.sky ? frame.index : 0};
    for (const LightView& view : views_) basis.lights.push_back(view.light);
    if (light_of_ == basis) {
        if (replaced_) LUCARNE_TRY(set_slots(slots_, lobes_));
        replaced_ = false;
        return {};
    }
    light_of_.reset();
    ++light_number_;
    own_slots_.clear();
    {
        const TimedPass pass(frame, "surfel light");
        LUCARNE_TRY(lit_.set_light(frame, views_, light_gbuffers_));
    }
    std::vector<SideLight> light;
    LUCARNE_TRY(exchange(frame, settings, points, light));
    if (frame.stopped()) return {};
    slots_ = shared(pull_light(lit_.tree(), light));
    LUCARNE_TRY(set_slots(slots_, lobes_));
    replaced_ = false;
    light_of_ = std::move(basis);
    return {};
}

Result<const BrightLight*> TreeLighting::find_bright(Frame& frame, std::span<const GatherPoint> pilots,
                                                     Gathered what, uint64_t seed) {
    LUCARNE_TRY(trace_tree(frame));
    gatherer_.set_no_bright();
    gatherer_.set_typical(0);
    std::vector<glm::vec4> found(pilots.size());
    if (pilots.empty()) return nullptr;
    LUCARNE_TRY(
        gatherer_.gather(*opencl_, what, pilots, frame.settings[kMicroBuffer], seed, found, frame.stop));
    if (frame.stopped()) return nullptr;
    float typical = 0;
    for (const glm::vec4& light : found)
        typical += mean_colour(glm::vec3(light)) / static_cast<float>(pilots.size());
    if (!(typical > 0)) return nullptr;
    gatherer_.set_typical(typical);
    const std::vector<SideLight>& slots = replaced_ ? own_slots_ : *slots_;
    bright_light_ = BrightLight::find(lit_, *traced_, slots, pilots, typical, seed, frame.stop);
    if (bright_light_.empty()) return nullptr;
    LUCARNE_TRY(gatherer_.set_bright(*opencl_, bright_light_.excess(), bright_light_.reach2()));
    bright_light_.drop_excess();
    return &bright_light_;
}

Result<const SkyOpenings*> TreeLighting::find_openings(Frame& frame, std::span<const GatherPoint> pilots,
                                                       uint64_t seed) {
    LUCARNE_TRY(trace_tree(frame));
    const std::pair view(middle_view(frame.camera), scene_.settings);
    if (openings_of_ == view) return &openings_;
    drop_openings();
    openings_ = SkyOpenings::find(*traced_->tracer, sky_, pilots, seed, frame.stop);
    if (!frame.stopped()) openings_of_ = view;
    return &openings_;
}

void TreeLighting::drop_openings() {
    openings_of_.reset();
    gatherer_.set_no_openings();
    openings_ = {};
}

Result<void> TreeLighting::trace_tree(Frame& frame) {
    LUCARNE_TRY(make_tree(frame));
    if (traced_) return {};
    LUCARNE_ASSIGN(traced_, TracedTree::create(frame, lit_));
    return {};
}

Result<void> TreeLighting::set_irradiance(std::span<const glm::vec3> irradiance, bool own) {
    if (own_slots_.empty()) own_slots_ = pull_light(lit_.tree(), lit_.own_light());
    if (const std::pair basis(cuts_.light, scene_.materials); reflecting_of_ != basis) {
        reflecting_of_.reset();
        std::vector<SideLight> reflectances;
        for (const glm::vec3& r : lit_.reflectances()) reflectances.push_back({r, r});
        reflecting_ = pull_light(lit_.tree(), reflectances);
        reflecting_of_ = basis;
    }
    std::vector<SideLight> slots(own_slots_.size());
    parallel_ranges(slots.size(), kSlotsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            if (own) slots[i] = own_slots_[i];
            slots[i].front += reflecting_[i].front * irradiance[2 * i];
            slots[i].back += reflecting_[i].back * irradiance[2 * i + 1];
        }
    });
    replaced_ = true;
    return set_slots(shared(std::move(slots)), own ? lit_.lobes() : SideLobes{});
}

Result<void> TreeLighting::set_slots(SharedLight slots, const SideLobes& lobes) {
    LUCARNE_TRY(gatherer_.set_light(*opencl_, std::move(slots)));
    return gatherer_.set_lobes(*opencl_, lobes);
}

Result<void> TreeLighting::add_direct(Frame& frame) {
    if (traces_shadows(frame)) LUCARNE_TRY(trace_tree(frame));
    if (frame.stopped()) return {};
    const TimedPass pass(frame, "direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, background_, true));
    if (traces_shadows(frame)) {
        add_traced_light(frame, *traced_->tracer, bright_);
        return {};
    }
    for (const LightView& view : views_) {
        LUCARNE_ASSIGN(const GBuffer* seen, light_gbuffers_.look(frame.gl.device, view));
        LUCARNE_TRY(add_light(frame, materials_, view, *seen));
    }
    return {};
}

}  // namespace lucarne::gi
