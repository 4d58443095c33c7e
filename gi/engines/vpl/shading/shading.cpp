#include "gi/engines/vpl/shading/shading.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/engines/vpl/options.h"
#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/shading/native/gather.h"
#include "gi/engines/vpl/shading/native/join.h"
#include "gi/engines/vpl/shading/native/merge.h"
#include "gi/gl_frame.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi::vpl {
namespace {

Defines defines(const Tiles& tiles) {
    return tiles.glossy ? Defines{{"LUCARNE_GLOSSY", "1"}} : Defines{};
}

void bind_pixels(const Frame& frame, const Program& program) {
    frame.gl.gbuffer.texels.bind_texels(kUnitGBuffer, TexelView::four_words);
    program.set("interleave", frame.settings[kInterleave]);
    set(program, "camera", frame.camera);
}

Result<void> join_natively(const Frame& frame, Tiles& target) {
    std::vector<uint32_t> isolated;
    {
        LUCARNE_ASSIGN(const MappedBuffer texels, frame.gl.gbuffer.texels.map());
        LUCARNE_ASSIGN(const MappedBuffer joints, target.joints.map());
        isolated = native::join(frame.camera, texels.as<const GBufferTexel>().data(),
                                frame.settings[kInterleave], joints.as<uint32_t>().data());
    }
    const auto count = static_cast<uint32_t>(isolated.size());
    const uint32_t groups = std::min((count + kIsolatedGroup - 1) / kIsolatedGroup, kMostIsolatedGroups);
    target.isolated.upload_all(std::vector<IsolatedHeader>{{{groups, 1, 1}, count}});
    target.isolated.upload(sizeof(IsolatedHeader), std::as_bytes(std::span(isolated)));
    return {};
}

Result<void> shade_natively(const Frame& frame, const Seeds& seeds, const AtlasLayout& layout,
                            const Buffer& atlas_buffer, const Tiles& target) {
    LUCARNE_ASSIGN(const MappedBuffer texels, frame.gl.gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer lights, seeds.lights.map());
    LUCARNE_ASSIGN(const MappedBuffer atlas, atlas_buffer.map());
    LUCARNE_ASSIGN(const MappedBuffer diffuse, target.diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer own_diffuse, target.own_diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer isolated, target.isolated.map());
    LUCARNE_ASSIGN(const MappedBuffer joints, target.joints.map());
    const native::GatherInput input{.camera = frame.camera,
                                    .texels = texels.as<const GBufferTexel>().data(),
                                    .lights = lights.as<const VplLight>().first(layout.maps),
                                    .atlas = atlas.as<const uint32_t>().data(),
                                    .side = layout.side,
                                    .splat_angle = layout.splat_angle};
    const native::GatherOutput output{.irradiance = diffuse.as<glm::vec4>().data(),
                                      .own_irradiance = own_diffuse.as<glm::vec4>().data(),
                                      .isolated = isolated_pixels(isolated),
                                      .joints = joints.as<const uint32_t>().data()};
    native::gather(input, frame.settings[kInterleave], output);
    return {};
}

Result<void> merge_natively(const Frame& frame, const Buffer& materials, const Tiles& tiles,
                            History* history) {
    std::optional<MappedHistory> frames;
    if (history) {
        LUCARNE_ASSIGN(MappedHistory mapped, history->map());
        frames.emplace(std::move(mapped));
    }
    LUCARNE_ASSIGN(const MappedBuffer texels, frame.gl.gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer mapped_materials, materials.map());
    LUCARNE_ASSIGN(const MappedBuffer joints, tiles.joints.map());
    LUCARNE_ASSIGN(const MappedBuffer diffuse, tiles.diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer own_diffuse, tiles.own_diffuse.map());
    LUCARNE_ASSIGN(const MappedBuffer radiance, frame.gl.radiance.map());
    const native::MergeInput input{.camera = frame.camera,
                                   .texels = texels.as<const GBufferTexel>().data(),
                                   .materials = mapped_materials.as<const Material>(),
                                   .joints = joints.as<const uint32_t>().data(),
                                   .irradiance = diffuse.as<const glm::vec4>().data(),
                                   .own_irradiance = own_diffuse.as<const glm::vec4>().data()};
    native::merge(input, frame.settings[kInterleave], frames ? &frames->view : nullptr,
                  radiance.as<glm::vec4>().data());
    return {};
}

}  // namespace

std::span<const uint32_t> isolated_pixels(const MappedBuffer& isolated) {
    return isolated.as<const uint32_t>().subspan(sizeof(IsolatedHeader) / sizeof(uint32_t),
                                                 isolated.as<const IsolatedHeader>().front().count);
}

Result<void> join_tiles(Frame& frame, bool glossy, Tiles& target) {
    LUCARNE_ASSIGN(const Program* join, frame.gl.device.program("gi/engines/vpl/shading/join.comp"));
    const size_t pixels = size_t{frame.gl.gbuffer.width} * frame.gl.gbuffer.height;
    const size_t bytes = pixels * 4 * sizeof(float), one = 4 * sizeof(float);
    target.glossy = glossy;
    LUCARNE_TRY(frame.gl.device.reserve(target.diffuse, bytes, "indirect irradiance"));
    LUCARNE_TRY(frame.gl.device.reserve(target.own_diffuse, bytes, "indirect irradiance"));
    LUCARNE_TRY(frame.gl.device.reserve(target.specular, glossy ? bytes : one, "indirect specular light"));
    LUCARNE_TRY(
        frame.gl.device.reserve(target.own_specular, glossy ? bytes : one, "indirect specular light"));
    LUCARNE_TRY(frame.gl.device.reserve(target.joints, pixels * 2 * sizeof(uint32_t), "tiles"));
    LUCARNE_TRY(frame.gl.device.reserve(target.isolated, sizeof(IsolatedHeader) + pixels * sizeof(uint32_t),
                                        "tiles"));
    for (Buffer* light : {&target.diffuse, &target.specular, &target.own_diffuse, &target.own_specular})
        light->clear(0);
    if (frame.gl.device.native_passes()) return join_natively(frame, target);
    target.isolated.upload_all(std::vector<IsolatedHeader>{{{0, 1, 1}, 0}});
    target.joints.bind(kBindJoints);
    target.isolated.bind(kBindIsolated);
    bind_pixels(frame, *join);
    join->dispatch(frame.gl.gbuffer.width, frame.gl.gbuffer.height);
    return {};
}

Result<void> shade_tiles(Frame& frame, const Buffer& materials, const Seeds& seeds, const AtlasLayout& layout,
                         const Buffer& atlas, Tiles& target) {
    if (frame.gl.device.native_passes() && !target.glossy)
        return shade_natively(frame, seeds, layout, atlas, target);
    seeds.lights.bind_texels(kUnitLights, TexelView::four_words);
    atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    return run_shading(frame, materials, layout.maps, {}, target, [&](const Program& program) {
        set_layout(program, layout);
        program.set("footprint_variance", footprint_variance(frame.index));
    });
}

Result<void> run_shading(Frame& frame, const Buffer& materials, uint32_t lights, const Defines& more,
                         const Tiles& target, const std::function<void(const Program&)>& prepare) {
    Defines how = defines(target);
    how.insert(how.end(), more.begin(), more.end());
    LUCARNE_ASSIGN(const Program* shade, frame.gl.device.program("gi/engines/vpl/shading/shade.comp", how));
    LUCARNE_ASSIGN(const Program* shade_isolated,
                   frame.gl.device.program("gi/engines/vpl/shading/shade_isolated.comp", how));
    materials.bind(kBindMaterials);
    for (const Program* program : {shade, shade_isolated}) {
        bind_pixels(frame, *program);
        program->set("light_count", lights);
        prepare(*program);
    }
    const uint32_t n = frame.settings[kInterleave];
    target.diffuse.bind(kBindDiffuse);
    target.specular.bind(kBindSpecular);
    shade->dispatch((frame.gl.gbuffer.width + n - 1) / n, (frame.gl.gbuffer.height + n - 1) / n, n * n);
    if (n == 1) return {};
    target.joints.bind(kBindJoints);
    target.isolated.bind(kBindIsolated);
    target.own_diffuse.bind(kBindDiffuse);
    target.own_specular.bind(kBindSpecular);
    shade_isolated->dispatch_indirect(target.isolated, offsetof(IsolatedHeader, groups));
    return {};
}

Result<void> merge_tiles(Frame& frame, const Buffer& materials, const Tiles& tiles, History* history) {
    if (frame.gl.device.native_passes() && !tiles.glossy) {
        LUCARNE_TRY(merge_natively(frame, materials, tiles, history));
        if (history) history->end(frame);
        return {};
    }
    Defines how = defines(tiles);
    if (history) how.emplace_back("LUCARNE_HISTORY", "1");
    LUCARNE_ASSIGN(const Program* merge, frame.gl.device.program("gi/engines/vpl/shading/merge.comp", how));
    materials.bind(kBindMaterials);
    tiles.joints.bind(kBindJoints);
    tiles.diffuse.bind_texels(kUnitDiffuse, TexelView::four_floats);
    tiles.specular.bind_texels(kUnitSpecular, TexelView::four_floats);
    tiles.own_diffuse.bind_texels(kUnitOwnDiffuse, TexelView::four_floats);
    tiles.own_specular.bind_texels(kUnitOwnSpecular, TexelView::four_floats);
    frame.gl.radiance.bind(kBindRadiance);
    bind_pixels(frame, *merge);
    if (history) history->bind(frame, *merge);
    merge->dispatch(frame.gl.gbuffer.width, frame.gl.gbuffer.height);
    if (history) history->end(frame);
    return {};
}

}  // namespace lucarne::gi::vpl
