#include "gi/post/fill_gaps.h"

#include "gi/post/bindings.h"

namespace lucarne::gi {

Result<void> fill_gaps(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                       uint32_t reach, Buffer& picture) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/fill_gaps.comp"));
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    program->set("averaged", averaged ? 1u : 0u);
    program->set("reach", reach);
    program->set("width", gbuffer.width);
    program->set("height", gbuffer.height);
    program->dispatch(gbuffer.width * gbuffer.height);
    return {};
}

}  // namespace lucarne::gi
