#include "gi/lighting/direct_light.h"

#include <algorithm>

#include "gi/gl_frame.h"
#include "gi/lighting/bindings.h"
#include "gi/lighting/native/light.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {
namespace {

Result<void> add_own_light_natively(const Frame& frame, const Buffer& materials, const Sky& sky, bool add) {
    LUCARNE_ASSIGN(const MappedBuffer texels, frame.gl.gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer held, materials.map());
    LUCARNE_ASSIGN(const MappedBuffer radiance, frame.gl.radiance.map());
    LUCARNE_ASSIGN(const MappedBuffer background, sky.texels.map());
    native::SkyPicture behind{background.as<const float>().data(), 1, 1, 0};
    if (const auto* environment = frame.environment.get()) {
        behind.width = environment->width;
        behind.height = environment->height;
        behind.rotation = environment->rotation;
    }
    native::add_own_light({frame.camera, texels.as<const GBufferTexel>().data(), held.as<const Material>(),
                           radiance.as<glm::vec4>().data()},
                          behind, add);
    return {};
}

Result<void> add_light_natively(const Frame& frame, const Buffer& materials, const LightView& from,
                                const GBuffer& seen) {
    LUCARNE_ASSIGN(const MappedBuffer texels, frame.gl.gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer shadows, seen.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer held, materials.map());
    LUCARNE_ASSIGN(const MappedBuffer radiance, frame.gl.radiance.map());
    native::add_light({frame.camera, texels.as<const GBufferTexel>().data(), held.as<const Material>(),
                       radiance.as<glm::vec4>().data()},
                      from.light, {from.view, shadows.as<const GBufferTexel>().data(), from.face});
    return {};
}

}  // namespace

bool glossy(const Frame& frame) {
    return std::ranges::any_of(frame.materials,
                               [](const Material& material) { return material.diffuse.w > 0; });
}

std::vector<Material> device_materials(std::vector<Material> materials) {
    if (materials.empty()) materials.push_back({glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)});
    materials.resize(LUCARNE_DEVICE_MATERIALS, materials.front());
    return materials;
}

Result<void> upload_materials(Device& device, const std::vector<Material>& materials, Buffer& target) {
    const auto held = device_materials(materials);
    LUCARNE_TRY(device.reserve(target, held.size() * sizeof(Material), "materials"));
    target.upload_all(held);
    return {};
}

Result<void> upload_sky(const Frame& frame, Sky& sky) {
    const std::vector<glm::vec3> plain = {frame.background};
    const auto& texels = frame.environment ? frame.environment->texels : plain;
    if (frame.environment && frame.environment == sky.directions.environment()) return {};
    if (sky.texels.bytes() != texels.size() * sizeof(glm::vec3)) {
        sky.texels = Buffer();
        LUCARNE_ASSIGN(sky.texels, frame.gl.device.buffer(texels.size() * sizeof(glm::vec3), "environment"));
    }
    sky.texels.upload_all(texels);
    if (frame.environment != sky.directions.environment()) sky.directions = SkyDirections(frame.environment);
    return {};
}

Result<void> add_own_light(Frame& frame, const Buffer& materials, const Sky& sky, bool add) {
    if (frame.gl.device.native_passes()) return add_own_light_natively(frame, materials, sky, add);
    const Defines defines = add ? Defines{{"LUCARNE_ADD", "1"}} : Defines{};
    LUCARNE_ASSIGN(const Program* program, frame.gl.device.program("gi/lighting/own_light.comp", defines));
    frame.gl.gbuffer.texels.bind(lighting::kBindCameraTexels);
    materials.bind(lighting::kBindLightingMaterials);
    frame.gl.radiance.bind(lighting::kBindLitRadiance);
    sky.texels.bind(lighting::kBindSky);
    const uint32_t pixels = frame.gl.gbuffer.width * frame.gl.gbuffer.height;
    set(*program, "camera", frame.camera);
    program->set("sky_width", frame.environment ? frame.environment->width : 1u);
    program->set("sky_height", frame.environment ? frame.environment->height : 1u);
    program->set("sky_rotation", frame.environment ? frame.environment->rotation : 0.0f);
    program->dispatch(pixels);
    return {};
}

Result<void> add_light(Frame& frame, const Buffer& materials, const LightView& from, const GBuffer& seen) {
    if (frame.gl.device.native_passes() && !glossy(frame))
        return add_light_natively(frame, materials, from, seen);
    LUCARNE_ASSIGN(const Program* program, frame.gl.device.program("gi/lighting/light.comp"));
    frame.gl.gbuffer.texels.bind(lighting::kBindCameraTexels);
    seen.texels.bind(lighting::kBindLightTexels);
    materials.bind(lighting::kBindLightingMaterials);
    frame.gl.radiance.bind(lighting::kBindLitRadiance);
    set(*program, "camera", frame.camera);
    set(*program, "light_view", from.view);
    set(*program, "light", from.light);
    program->set("face", from.face);
    program->dispatch(frame.gl.gbuffer.width, frame.gl.gbuffer.height);
    return {};
}

}  // namespace lucarne::gi
