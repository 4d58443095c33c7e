#include "viewer/frame/engine_bake.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/bake/bake_file.h"
#include "gi/scene/views.h"
#include "octree/stream/cut.h"

namespace lucarne::viewer {

std::filesystem::path kept_bake(const gi::EngineInfo& engine, const octree::NodeSource& source) {
    const auto identity = source.identity();
    if (!engine.precomputes || !identity) return {};
    std::error_code unknown;
    const auto written = std::filesystem::last_write_time(identity->file, unknown);
    if (unknown) return {};
    for (const auto& place :
         {gi::bake_place(identity->file, engine.name), gi::bake_beside(identity->file, engine.name)}) {
        if (place.empty() || !std::filesystem::exists(place, unknown)) continue;
        if (std::filesystem::last_write_time(place, unknown) < written) continue;
        const auto header = gi::read_bake_header(place);
        if (header && header->engine == engine.name && header->version == engine.precomputes->version &&
            header->share >= 1)
            return place;
    }
    return {};
}

EngineBake::Inputs EngineBake::inputs_of(const BakeSubject& subject) {
    const gi::Precomputes& how = *subject.engine.precomputes;
    const gi::Scene& scene = subject.scene;
    Inputs inputs{.engine = &subject.engine,
                  .source = subject.source,
                  .packing = subject.surfels.packing(),
                  .points = subject.points,
                  .open_holes = scene.look.open_holes};
    if (!scene.look.clip.casts) inputs.clip = scene.look.clip;
    if (how.lights) inputs.lights = scene.lights;
    if (how.materials) {
        inputs.materials = scene.materials;
        inputs.albedo_scale = scene.albedo.scale;
    }
    if (how.environment) inputs.environment = scene.environment;
    if (how.lighting_region) inputs.lighting_region = scene.lighting_region;
    for (const gi::OptionInfo* option : how.options) inputs.options.push_back(subject.settings.get(*option));
    return inputs;
}

void EngineBake::end() {
    if (!job_) return;
    job_.reset();
    published_({});
}

void EngineBake::update(const BakeSubject& subject) {
    if (!subject.engine.precomputes) return end();
    Inputs inputs = inputs_of(subject);
    const bool asked_again = std::exchange(again_, subject.again) != subject.again;
    if (job_ && inputs == inputs_ && !(asked_again && !job_->status().error)) return;
    job_.reset();    // keeps what it has done before the next one looks for it
    published_({});  // the last one's share is not that of the next one
    inputs_ = std::move(inputs);
    const glm::dvec3 middle = (subject.bounds[0] + subject.bounds[1]) / 2.0;
    const auto& source = *subject.source;
    frame_ = gi::local_frame(middle, source.header().metres_per_unit);
    gi::BakeOrder order{.engine = &subject.engine,
                        .source = subject.source,
                        .preparation = subject.surfels.preparation(),
                        .cut = octree::light_cut(source, middle, subject.points, {},
                                                 glm::distance(subject.bounds[0], subject.bounds[1])),
                        .fill_holes = !inputs_.open_holes,
                        .clip = inputs_.clip};
    order.input.cut.frame = frame_;
    for (const gi::SceneLight& light : subject.scene.lights)
        order.input.lights.push_back(gi::device_light(light, frame_));
    for (const gi::SceneMaterial& material : subject.scene.materials)
        order.input.materials.push_back(gi::device_material(material, subject.scene.albedo.scale));
    order.input.environment = subject.scene.environment;
    order.input.settings = subject.settings;
    if (const auto& region = subject.scene.lighting_region)
        order.input.lighting_region = {frame_.to_local(region->first), frame_.to_local(region->second)};
    order.input.is_shown = subject.is_shown;
    if (const auto identity = source.identity()) {
        order.input.source = identity->content;
        order.file = gi::bake_place(identity->file, subject.engine.name);
        const auto beside = gi::bake_beside(identity->file, subject.engine.name);
        if (beside != order.file) order.read_only = beside;
    }
    job_ = std::make_unique<gi::BakeJob>(std::move(order), published_);
}

Result<void> EngineBake::wait(const std::atomic<bool>* stop, Progress* progress) const {
    if (!job_) return {};
    job_->wait(stop, progress);
    return job_->status().error;
}

}  // namespace lucarne::viewer
