#include "gi/post/accumulate.h"

#include "gi/post/bindings.h"

namespace lucarne::gi {

Result<void> accumulate(Device& device, const Buffer& sample, uint32_t pixels, uint32_t count, Buffer& mean) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/accumulate.comp"));
    sample.bind(post::kBindRadiance);
    mean.bind(post::kBindMean);
    program->set("pixels", pixels);
    program->set("count", count);
    program->dispatch(pixels);
    return {};
}

}  // namespace lucarne::gi
