#include "gi/gbuffer/direct_light.h"

#include <array>

#include <fmt/format.h>

#include "gi/gbuffer/uniforms.h"
#include "io/core/log.h"

namespace lucarne::gi {
namespace {

enum Binding : uint32_t { kCameraTexels = 3, kLightTexels = 4, kMaterials = 5, kRadiance = 6 };

}  // namespace

Result<void> upload_materials(Device& device, const std::vector<Material>& materials, Buffer& target) {
    static const std::vector<Material> kWhite = {{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)}};
    const auto& used = materials.empty() ? kWhite : materials;
    // Shaders take the buffer's length for the number of materials.
    if (target.bytes() != used.size() * sizeof(Material)) {
        target = Buffer();
        LUCARNE_ASSIGN(target, device.buffer(used.size() * sizeof(Material), "materials"));
    }
    target.upload_all(used);
    return {};
}

Result<void> add_own_light(Frame& frame, const Buffer& materials, bool add) {
    LUCARNE_ASSIGN(const Program* program, frame.device.program("gi/gbuffer/own_light.comp"));
    frame.gbuffer.texels.bind(kCameraTexels);
    materials.bind(kMaterials);
    frame.radiance.bind(kRadiance);
    const uint32_t pixels = frame.gbuffer.width * frame.gbuffer.height;
    program->set("pixels", pixels);
    program->set("add", add ? 1u : 0u);
    program->set_block("background",
                       std::array<float, 3>{frame.background.x, frame.background.y, frame.background.z});
    program->dispatch(pixels);
    return {};
}

void warn_of_lights_left_out(const Frame& frame, std::string_view engine, std::string& said) {
    static constexpr const char* kNames[] = {"spot", "point light", "directional light", "rectangle", "disc"};
    std::string names;
    for (const Light& light : frame.lights)
        if (!casts_shadow_map(light))
            names += fmt::format("{}a {}", names.empty() ? "" : ", ", kNames[light.kind]);
    if (frame.environment) names += fmt::format("{}the environment", names.empty() ? "" : ", ");
    if (names != said && !names.empty())
        log::warn("{}: left out, since no shadow map can hold it: {}; --engine reference has it all", engine,
                  names);
    said = names;
}

Result<void> add_spot_light(Frame& frame, const Buffer& materials, const Light& spot, const GBuffer& seen) {
    LUCARNE_ASSIGN(const Program* program, frame.device.program("gi/gbuffer/spot_light.comp"));
    frame.gbuffer.texels.bind(kCameraTexels);
    seen.texels.bind(kLightTexels);
    materials.bind(kMaterials);
    frame.radiance.bind(kRadiance);
    set(*program, "camera", frame.camera);
    set(*program, "light_view", spot_view(spot, seen.width));
    set(*program, "spot", spot);
    program->dispatch(frame.gbuffer.width, frame.gbuffer.height);
    return {};
}

}  // namespace lucarne::gi
