#include "gi/post/backdrop.h"

#include <array>

#include "gi/post/bindings.h"

namespace lucarne::gi {

Result<void> draw_backdrop(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                           const Backdrop& backdrop, Buffer& picture) {
    if (backdrop.kind == Backdrop::Kind::scene) return {};
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/backdrop.comp"));
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    const auto set = [&](std::string_view uniform, const glm::dvec3& colour) {
        const glm::vec3 c(colour);
        program->set_block(uniform, std::array<float, 4>{c.x, c.y, c.z, 1.0f});
    };
    set("top", backdrop.top);
    set("bottom", backdrop.kind == Backdrop::Kind::gradient ? backdrop.bottom : backdrop.top);
    program->set("averaged", averaged ? 1u : 0u);
    program->set("width", gbuffer.width);
    program->set("height", gbuffer.height);
    program->dispatch(gbuffer.width * gbuffer.height);
    return {};
}

}  // namespace lucarne::gi
