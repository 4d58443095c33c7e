#include "gi/engines/vpl/sky/sky_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/options.h"
#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/sky/native/draw.h"
#include "gi/engines/vpl/sky/native/shade.h"
#include "gi/engines/vpl/sky/ordered.h"
#include "gi/gather/gather_sky.h"
#include "gi/host_frame.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/light_samples.h"
#include "gi/lighting/light_view.h"
#include "gi/raster/uniforms.h"
#include "io/core/random.h"

namespace lucarne::gi::vpl {
namespace {

/// Light views are this many times finer than maps, of which there are far more; their sums blur together.
constexpr uint32_t kCoarser = 4;
/// Texels of a map's side beyond the receivers: for its shift, and for points that are lifted.
constexpr float kMargin = 4;
constexpr float kMostStretch = 4;  ///< root of the largest ratio of a map's sides
/// Texels of the maps that are drawn together, 16 MiB; a multiple of 4 x 4 maps of any side.
constexpr uint32_t kMostTexels = 1u << 22;

/// Returns an environment of the even part of a sky.
std::shared_ptr<const Environment> even_part(const GatherSky& sky) {
    Environment even{.width = sky.width, .height = sky.height, .texels = sky.texels};
    even.rotation = sky.rotation;
    return std::make_shared<const Environment>(std::move(even));
}

glm::vec4 row(const glm::vec3& axis, float texel, const glm::vec3& middle, float at) {
    return glm::vec4(axis / texel, at - glm::dot(axis, middle) / texel);
}

float depth_range(const Bounds& scene) {
    return std::max(glm::length(scene.max - scene.min), 1e-3f);
}

}  // namespace

SkyMap sky_map(const Light& light, const Bounds& receivers, const Bounds& scene, uint32_t side,
               const glm::vec2& shift) {
    const glm::vec3 away(light.direction);
    const Outline seen = outline_along(receivers, away);
    const float stretch = std::clamp(std::sqrt(seen.half.x / seen.half.y), 1 / kMostStretch, kMostStretch);
    SkyMap map{};
    map.columns = static_cast<uint32_t>(static_cast<float>(side) * stretch);
    map.rows = static_cast<uint32_t>(static_cast<float>(side) / stretch);
    const glm::vec2 texels(map.columns, map.rows);
    const glm::vec2 texel = 2.0f * seen.half / glm::max(texels - kMargin, 1.0f);
    const glm::vec3 middle = (receivers.min + receivers.max) / 2.0f;
    const glm::vec2 at = texels / 2.0f + shift - 0.5f;
    map.across = row(seen.right, texel.x, middle, at.x);
    map.down = row(seen.up, texel.y, middle, at.y);
    map.away = glm::vec4(away, depth_range(scene) / 2 - glm::dot(away, (scene.min + scene.max) / 2.0f));
    map.irradiance = light.strength;
    const float reach = glm::dot(glm::abs(away), receivers.max - receivers.min) / 2;
    map.farthest = sky_place(map, middle).z + reach;
    return map;
}

void SkyLight::set_environment(const std::shared_ptr<const Environment>& environment) {
    if (environment == environment_) return;
    environment_ = environment;
    const GatherSky parts = gather_sky(environment);
    bright_ = SkyDirections(parts.bright);
    even_ = SkyDirections(parts.bright ? even_part(parts) : environment);
}

/// Finds the bounds of what the camera sees. Returns false if it sees nothing.
Result<bool> SkyLight::find_receivers(Frame& frame, Bounds& bounds) {
    if (frame.gl.device.native_passes()) {
        LUCARNE_ASSIGN(const MappedBuffer pixels, frame.gl.gbuffer.texels.map());
        return native::receiver_bounds(frame.camera, pixels.as<const GBufferTexel>().data(), bounds.min,
                                       bounds.max);
    }
    LUCARNE_ASSIGN(const Program* find, frame.gl.device.program("gi/engines/vpl/sky/bounds.comp"));
    LUCARNE_TRY(frame.gl.device.reserve(bounds_, 6 * sizeof(uint32_t), "bounds of the picture"));
    bounds_.upload_all(std::vector<uint32_t>{~0u, ~0u, ~0u, 0, 0, 0});
    frame.gl.gbuffer.texels.bind(kBindGBuffer);
    bounds_.bind(kBindBounds);
    set(*find, "camera", frame.camera);
    find->dispatch(frame.camera.width * frame.camera.height);
    const auto codes = bounds_.download_all<uint32_t>(6);
    for (int axis = 0; axis < 3; ++axis) {
        bounds.min[axis] = ordered_value(codes[static_cast<size_t>(axis)]);
        bounds.max[axis] = ordered_value(codes[static_cast<size_t>(axis) + 3]);
    }
    return codes[0] <= codes[3];
}

/// Draws the maps.
Result<void> SkyLight::draw(Frame& frame, const ShadowMaps& casters, const std::vector<SkyMap>& maps) {
    Device& device = frame.gl.device;
    const DeviceCut& cut = *frame.gl.cuts.light;
    const TimedPass pass(frame, "sky maps");
    LUCARNE_TRY(device.reserve(maps_, maps.size() * sizeof(SkyMap), "directions of the sky"));
    LUCARNE_TRY(device.reserve(texels_, maps.size() * side_ * side_ * sizeof(uint32_t), "maps of the sky"));
    maps_.upload_all(maps);
    texels_.clear(kNothing);
    if (cut.blocks() == 0) return {};
    if (device.native_passes()) {
        LUCARNE_ASSIGN(const MappedBuffer codes, casters.casters.map());
        LUCARNE_ASSIGN(const MappedBuffer bounds, casters.bounds.map());
        LUCARNE_ASSIGN(const MappedBuffer texels, texels_.map());
        native::draw_sky_maps({.casters = codes.as<const uint32_t>().data(),
                               .bounds = bounds.as<const float>().data(),
                               .blocks = cut.blocks(),
                               .cut_size = cut.size(),
                               .maps = maps,
                               .depth_step = depth_step_,
                               .texels = texels.as<uint32_t>().data()});
        return {};
    }
    LUCARNE_ASSIGN(const Program* draw, device.program("gi/engines/vpl/sky/draw.comp"));
    casters.casters.bind_texels(kUnitCasters, TexelView::four_words);
    maps_.bind(kBindLights);
    texels_.bind(kBindAtlas);
    draw->set("cut_size", cut.size());
    draw->set("depth_step", depth_step_);
    draw->dispatch(cut.blocks() * kBlockSurfels, static_cast<uint32_t>(maps.size()));
    return {};
}

/// Adds the light of the maps to the tiles.
Result<void> SkyLight::shade(Frame& frame, const Buffer& materials, const std::vector<SkyMap>& maps,
                             Tiles& tiles) {
    const TimedPass pass(frame, "sky light");
    if (!frame.gl.device.native_passes() || tiles.glossy) {
        maps_.bind(kBindLights);
        texels_.bind_texels(kUnitAtlas, TexelView::one_word);
        return run_shading(frame, materials, static_cast<uint32_t>(maps.size()), {{"LUCARNE_SKY", "1"}},
                           tiles, [&](const Program& program) { program.set("depth_step", depth_step_); });
    }
    LUCARNE_ASSIGN(const MappedBuffer pixels, frame.gl.gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer texels, texels_.map());
    LUCARNE_ASSIGN(const MappedBuffer diffuse, tiles.diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer own_diffuse, tiles.own_diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer isolated, tiles.isolated.map());
    LUCARNE_ASSIGN(const MappedBuffer joints, tiles.joints.map());
    const native::SkyShading input{.camera = frame.camera,
                                   .pixels = pixels.as<const GBufferTexel>().data(),
                                   .maps = maps,
                                   .texels = texels.as<const uint32_t>().data(),
                                   .depth_step = depth_step_};
    native::shade_sky(input, frame.settings[kInterleave],
                      {.irradiance = diffuse.as<glm::vec4>().data(),
                       .own_irradiance = own_diffuse.as<glm::vec4>().data(),
                       .isolated = isolated_pixels(isolated),
                       .joints = joints.as<const uint32_t>().data()});
    return {};
}

Result<void> SkyLight::add(Frame& frame, const Buffer& materials, std::span<const float> openings,
                           const ShadowMaps& casters, Tiles& tiles) {
    Bounds receivers;
    LUCARNE_ASSIGN(const bool any, find_receivers(frame, receivers));
    if (!any) return {};
    SkyDirections sky = even_;
    sky.favour(openings);
    side_ = frame.settings[kLightResolution] / kCoarser;
    depth_step_ = depth_range(frame.bounds) / kSkyDepthSteps;
    const uint64_t seed = frame.settings[kSeed];
    // The number beyond those of the lights of sharp_lights(): other directions than those of the light
    // views.
    const std::vector<Light> lights =
        sky_lights(sky, frame.settings[kSkyDirections], frame.index, seed, frame.lights.size() + 1);
    Random random(mix64(seed, frame.index), lights.size());
    const size_t together = kMostTexels / (size_t{side_} * side_);
    for (size_t first = 0; first < lights.size() && !frame.stopped(); first += together) {
        std::vector<SkyMap> maps;
        for (size_t i = first; i < std::min(first + together, lights.size()); ++i) {
            glm::vec2 shift;
            shift.x = static_cast<float>(random.uniform());
            shift.y = static_cast<float>(random.uniform());
            maps.push_back(sky_map(lights[i], receivers, frame.bounds, side_, shift));
            maps.back().first = static_cast<uint32_t>(i - first) * side_ * side_;
        }
        LUCARNE_TRY(draw(frame, casters, maps));
        LUCARNE_TRY(shade(frame, materials, maps, tiles));
    }
    return {};
}

}  // namespace lucarne::gi::vpl
