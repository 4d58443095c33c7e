#include "gi/lighting/direct_light.h"

#include "gi/gl_frame.h"
#include "gi/lighting/bindings.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {
namespace {}  // namespace

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
