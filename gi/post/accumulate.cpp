#include "gi/post/accumulate.h"

#include "gi/post/bindings.h"

namespace lucarne::gi {

Result<void> accumulate(Device& device, const Buffer& sample, const GBuffer& gbuffer, uint32_t count,
                        bool points_only, Buffer& mean) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/accumulate.comp"));
    const uint32_t pixels = gbuffer.width * gbuffer.height;
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    sample.bind(post::kBindRadiance);
    mean.bind(post::kBindMean);
    program->set("pixels", pixels);
    program->set("count", count);
    program->set("points_only", points_only ? 1u : 0u);
    program->dispatch(pixels);
    return {};
}

}  // namespace lucarne::gi
